//! d
use bekker::rigid::RigidBodies;
use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::Simulation;
use bekker::terrain::{Profile, Slope, Terrain};
#[test]
fn spike() {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    rover.terrain = Terrain::new(Profile::Slope(Slope { slope: 8f64.to_radians() }));
    let h = 0.001;
    for v in [0.0, 2.5] {
    let command = Command::speed(vec![v; 2]);
    let mut a = Simulation::new(rover.clone(), 0.0, h).unwrap();
    let mut b = RigidBodies::new(rover.clone(), 0.0, h, &[], 0.5).unwrap();
    for k in 0..120 {
        a.advance(&command, 1).unwrap();
        b.advance(&command, 1).unwrap();
        if k < 6 || k % 10 == 0 {
        println!("{k} {:?}\n   {:?}\n  {:?}\n  {:?}", a.state().position, b.state().position, a.state().rate, b.state().rate);
        println!("   {:?} {:?}", a.state().wheels[0].hold, b.state().wheels[0].hold);
        }
    }
    }
}
