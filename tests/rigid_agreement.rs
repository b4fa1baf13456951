use bekker::rigid::RigidBodies;
use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::Simulation;
use bekker::terrain::{Profile, Slope, Terrain, Waves};

fn waves(amplitude: f64, wavelength: f64) -> Terrain {
    Terrain::new(Profile::Waves(Waves { amplitude, wavelength, start: 0.4 }))
}

#[test]
fn spike() {
    let mut hard = Rover::two_wheeled();
    hard.soil.shear_modulus = 0.01;
    let mut six = Rover::rigid(&[-0.5, -0.3, -0.1, 0.1, 0.3, 0.5]);
    six.soil.shear_modulus = 0.01;
    let slope = |a: f64| Terrain::new(Profile::Slope(Slope { slope: a.to_radians() }));
    let cases = [
        ("flat", hard.clone(), Terrain::default(), Command::torque(vec![1.5; 2]), 3.0),
        ("two torque", hard.clone(), waves(0.03, 2.0), Command::torque(vec![1.5; 2]), 3.0),
        ("two speed", hard.clone(), waves(0.03, 2.0), Command::speed(vec![2.5; 2]), 3.0),
        ("slope", hard.clone(), slope(8.0), Command::speed(vec![2.5; 2]), 3.0),
        ("six torque", six.clone(), waves(0.02, 2.0), Command::torque(vec![0.6; 6]), 3.0),
        ("six speed", six, waves(0.02, 2.0), Command::speed(vec![2.0; 6]), 3.0),
        ("rb torque", Rover::rocker_bogie(), waves(0.01, 0.7), Command::torque(vec![0.38; 3]), 3.0),
        ("rb speed", Rover::rocker_bogie(), waves(0.01, 0.7), Command::speed(vec![1.5; 3]), 3.0),
    ];
    for (name, mut rover, terrain, command, duration) in cases {
        rover.terrain = terrain;
        for h in [0.004, 0.002, 0.001, 0.0005] {
            let steps = (duration / h) as u64;
            let mut a = Simulation::new(rover.clone(), 0.0, h).unwrap();
            let sa = a.advance(&command, steps).unwrap();
            let mut b = RigidBodies::new(rover.clone(), 0.0, h, &[], 0.5).unwrap();
            let start = b.signals().body.mechanical_energy;
            let t = std::time::Instant::now();
            let sb = b.advance(&command, steps).unwrap();
            let t = t.elapsed().as_secs_f64() / steps as f64 * 1e6;
            let (p, q) = (a.signals(), b.signals());
            let s = &q.body;
            let left = s.drive_work - s.soil_loss - s.other_loss - (s.mechanical_energy - start);
            println!("{name} h={h}: x {:.6} dx {:.2e} dz {:.2e} dpitch {:.2e} dv {:.2e} N {:.2} dN {:.2e} T dT {:.2e} {sa:?} {sb:?} left {:.1e} of {:.2} {t:.1} us",
                p.body.x, q.body.x - p.body.x, q.body.z - p.body.z, q.body.pitch - p.body.pitch, q.body.velocity - p.body.velocity,
                p.wheels[0].normal_force, q.wheels[0].normal_force - p.wheels[0].normal_force,
                q.wheels[0].torque - p.wheels[0].torque, left, s.drive_work);
        }
    }
}
