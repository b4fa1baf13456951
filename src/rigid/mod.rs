//! The plant of rigid bodies: chassis, links and wheels are bodies and joints of rapier2d in f64, on the same soil,
//! with the same motors, effects, signals and commands as the joint-coordinate plant ([`crate::simulation`]), and with
//! real contacts on rocks, ledges and the belly. `simulation.plant = "rigid_bodies"` selects it.
//!
//! **Soil.** The terrain is no collider for wheels: they sink into it, and [`crate::contact`] gives the forces, through
//! the same evaluation as in joint coordinates. These forces are stiff, so each step first solves the two linearly
//! implicit stages of the other plant from the present motion, with the rigid contacts' forces of the last step as
//! given, and the bodies get the mean forces of that step (`loads.rs`). Rapier then moves them: it alone computes the
//! forces of joints and rigid contacts. Where a rigid contact holds a wheel, soil and contact agree after a few steps; the fixed point is exact.
//!
//! **Bodies.** One multibody (reduced coordinates): its joints do not drift, and the weight of a chassis on a light wheel
//! on a rock is no hard problem for it, as it is for joints by impulses. A wheel's spin is its body's; speeds are imposed
//! by a motor on the axle, within 2e-5 of the command while the wheel slides on a rock, without error on soil.
//!
//! **Contacts.** A wheel is a disc of its true radius against obstacles, with Coulomb friction that acts on its spin. The
//! chassis is a box between the outer wheel centres from the belly up to the centre of mass, a link a bar from its joint
//! to each of its axles; both touch obstacles and the ground, which is as hard as rock for them. A hanging belly ends
//! a run as [`Stuck`](crate::simulation::Event::Stuck), not as a belly contact.
//!
//! **Signals.** With a rigid contact on a wheel, `contact_angle` is the direction of the sum of its normal forces (soil
//! and rigid), `normal_force` and `drawbar_pull` are the components of its whole force along and across that; the rigid
//! part is the mean over the last step. `slip` and `sinkage` stay those against the soil. Friction and impacts of rigid
//! contacts count as `other_loss`.
//!
//! **Accuracy.** Order 1 in the step (rapier's), where the other plant has order 2. On soil alone both approach each
//! other as the step falls; after three seconds at 2 ms the ways differ by at most 6e-4 of the way, for 2 to 8 wheels
//! and the rocker-bogie, on waves and slopes, under torques and speeds (`tests/rigid_agreement.rs`).
//!
//! **Limits.** No derivatives, so no diagnosis. Rapier allocates in its steps for a multibody. The soil under a rim counts
//! where an obstacle stands in it, too. Joints have no stops. One body's contacts are judged at the step's mean velocity,
//! so that impacts leave up to 2 % of the drives' work unexplained in the energies.

mod account;
mod bodies;
mod build;
mod contacts;
mod loads;
mod plant;
mod rapier;
mod shapes;
mod world;

pub use plant::RigidBodies;
