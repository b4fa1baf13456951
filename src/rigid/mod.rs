//! The plant of rigid bodies: chassis, links and wheels as bodies and joints of rapier2d in f64, on the same soil, with
//! the same motors, effects and signals as the joint-coordinate plant ([`crate::simulation`]), and with real contacts
//! on rocks, ledges and the belly.

mod bodies;
mod contacts;
mod loads;
mod plant;
mod rapier;
mod shapes;
mod world;

pub use plant::RigidBodies;
