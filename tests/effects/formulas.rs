//! Effects of soil and wheel against their formulas, worked out here once more.

use bekker::contact::{Surface, rolling_on};
use bekker::diagnosis::{Rig, SteadyPoint, steady_point};
use bekker::effects::{Effect, Effects, Local, Place};
use bekker::rover::Rover;
use bekker::signals::Command;
use bekker::simulation::{Simulation, Status};
use bekker::soil::Soil;
use bekker::terrain::{Profile, Slope, Terrain};
use bekker::wheel::Wheel;

/// Two ways to the same steady point, each solved to 1e-12 of the load.
const SAME: f64 = 1e-9;
/// The quadrature along the rim: 1e-6 of the normal force, as stated at `rolling`.
const QUADRATURE: f64 = 1e-6;
/// Gains read off a figure to 1 N of 15 N in both curves; the soil of the figure is not fitted, and its slip-sinkage is
/// left out.
const READ_OFF: f64 = 0.2;
/// A drive has come to its steady state to this share after 6 s.
const STEADY: f64 = 1e-4;

/// Dry sand of Wong under a small wheel.
fn rig() -> Rig {
    let mut rig = Rig::of(&Rover::two_wheeled());
    rig.wheel = Wheel { radius: 0.1, width: 0.12, ..Wheel::default() };
    rig.soil = Soil {
        cohesion: 1040.0,
        friction_angle: 28.0_f64.to_radians(),
        k_c: 990.0,
        k_phi: 1_528_430.0,
        exponent: 1.1,
        shear_modulus: 0.016,
        ..Soil::default()
    };
    rig
}

fn with(change: impl Fn(&mut Effects)) -> Rig {
    let mut rig = rig();
    change(&mut rig.effects);
    rig
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

fn assert_same(a: &SteadyPoint, b: &SteadyPoint) {
    for (a, b) in [(a.drawbar_pull, b.drawbar_pull), (a.torque, b.torque), (a.sinkage, b.sinkage)] {
        assert!(close(a, b, SAME), "{a} and {b}");
    }
}

/// A wheel at rest at `x` on ground of slope `angle`.
fn place(x: f64, angle: f64) -> Place {
    Place {
        wheel: 0,
        x: Some(x),
        passes: 0.0,
        contact_angle: angle,
        slip: 0.0,
        dug_slip: 0.0,
        sinkage: 0.01,
        normal_velocity: 0.0,
        velocity: 0.0,
    }
}

#[test]
fn analytic_bulldozing_is_the_passive_pressure_on_a_blade() {
    for (slip, speed) in [(0.1, 0.5), (0.6, 0.5), (-0.3, 0.5), (0.3, -0.5)] {
        let plain = steady_point(&rig(), 40.0, slip, speed).unwrap();
        let pushed = steady_point(&with(|effects| effects.bulldozing.share = 1.3), 40.0, slip, speed).unwrap();
        let (z, soil) = (plain.sinkage, rig().soil);
        let root = (std::f64::consts::FRAC_PI_4 + 0.5 * soil.friction_angle).tan();
        let pressure = 0.5 * 16e3 * z * z * root * root + 2.0 * soil.cohesion * z * root;
        // The share of the motion that is travel, its sign rounded over a tenth.
        let ratio = if slip >= 0.0 { 1.0 - slip } else { 1.0 / (1.0 + slip) };
        let travel = speed.signum() * ratio / ratio.hypot(1.0);
        let expected = 1.3 * 0.12 * pressure * travel / (travel.powi(4) + 1e-4).powf(0.25);
        assert!(close(plain.drawbar_pull - pushed.drawbar_pull, expected, SAME), "slip {slip}: {expected} N");
        assert!((0.3..10.0).contains(&expected.abs()), "newtons: {expected}");
        assert!(close(plain.torque, pushed.torque, SAME) && close(plain.sinkage, pushed.sinkage, SAME));
    }
}

#[test]
fn analytic_rate_scales_the_moduli_by_a_power_of_the_speed_of_penetration() {
    const M: f64 = 0.15;
    for speed in [0.2, 2.0] {
        let point = steady_point(&with(|effects| effects.rate.exponent = M), 40.0, 0.3, speed).unwrap();
        // V tan(theta_1/2), with the slowest speed of 1 mm/s, over 1 cm/s.
        let half_angle = 0.5 * (1.0 - point.sinkage / 0.1_f64).acos();
        let penetration = (0.1 * speed * 0.7 * half_angle.tan()).hypot(0.001);
        let factor = (penetration / 0.01).powf(M);
        let mut scaled = rig();
        scaled.soil.k_c *= factor;
        scaled.soil.k_phi *= factor;
        assert_same(&point, &steady_point(&scaled, 40.0, 0.3, speed).unwrap());
    }
}

#[test]
fn analytic_flexible_wheel_stands_on_the_arc_of_a_larger_circle() {
    const C: f64 = 1e-4;
    let point = steady_point(&with(|effects| effects.flexible_wheel.compliance = C), 50.0, 0.2, 1.0).unwrap();
    let (wheel, soil, z) = (rig().wheel, rig().soil, point.sinkage);
    let arc = (z + C * 50.0) / z;
    let surface = Surface { arc, ..Surface::default() };
    let forces = rolling_on(&wheel, &soil, &surface, z, 0.1 * 0.8, 1.0);
    assert!(close(forces.normal, 50.0, SAME), "{forces:?}");
    assert!(close(forces.drawbar, point.drawbar_pull, SAME) && close(forces.torque, point.torque, SAME));
    let rigid = steady_point(&rig(), 50.0, 0.2, 1.0).unwrap();
    assert!(z < rigid.sinkage && point.drawbar_pull > rigid.drawbar_pull);
}

#[test]
fn analytic_the_arc_of_a_flexible_wheel_grows_with_the_load_alone_or_with_the_sinkage_too() {
    const C: f64 = 1e-4;
    for (by_sinkage, by_load) in [(0.0, 0.0), (0.0, 10.0), (0.5, 6.0), (0.2, 20.0)] {
        let flexible = with(|effects| {
            effects.flexible_wheel.compliance = C;
            effects.flexible_wheel.arc_by_sinkage = by_sinkage;
            effects.flexible_wheel.arc_by_load = by_load;
            effects.flexible_wheel.arm_share = 1.0;
        });
        let point = steady_point(&flexible, 50.0, 0.2, 1.0).unwrap();
        let (wheel, soil, z) = (rig().wheel, rig().soil, point.sinkage);
        let arc = 1.0 + C * 50.0 * (by_sinkage / z + by_load / 0.1);
        let surface = Surface { arc, arm: arc, ..Surface::default() };
        let forces = rolling_on(&wheel, &soil, &surface, z, 0.1 * 0.8, 1.0);
        assert!(close(forces.normal, 50.0, SAME), "{forces:?}");
        assert!(close(forces.drawbar, point.drawbar_pull, SAME) && close(forces.torque, point.torque, SAME));
    }
}

#[test]
fn analytic_slip_sinkage_divides_the_depth_by_the_factors_of_lyasko_and_reece() {
    for (growth, carried, n1, slip) in [
        (1.0, 0.0, 0.0, 0.3),
        (0.4, 0.0, 0.5, 0.6),
        (2.0, 0.0, 0.0, -0.2),
        (0.0, 0.004, 0.0, 0.5),
        (0.3, 0.003, 0.2, 0.4),
    ] {
        let digging = with(|effects| {
            effects.slip_sinkage.growth = growth;
            effects.slip_sinkage.carried = carried;
            effects.slip_sinkage.n1 = n1;
        });
        let point = steady_point(&digging, 40.0, slip, 1.0).unwrap();
        let size = f64::abs(slip);
        let moved = carried * size / (1.0 - size);
        let static_share = (point.sinkage - moved) / point.sinkage;
        let factor = (1.0 + growth * ((1.0 + size) / (1.0 - 0.5 * size) - 1.0)) / static_share;
        // p = k (z/f)^n is that of a soil of the moduli k f^-n.
        let mut scaled = rig();
        scaled.soil.exponent += n1 * size;
        let modulus = factor.powf(-scaled.soil.exponent);
        scaled.soil.k_c *= modulus;
        scaled.soil.k_phi *= modulus;
        assert_same(&point, &steady_point(&scaled, 40.0, slip, 1.0).unwrap());
        assert!(point.sinkage > steady_point(&rig(), 40.0, slip, 1.0).unwrap().sinkage);
    }
}

/// The integrals (2.7)-(2.9) on a rim with all that a surface changes, by many midpoints.
fn by_midpoints(soil: &Soil, surface: &Surface, z: f64, velocity: f64, spin: f64) -> [f64; 3] {
    const POINTS: usize = 400_000;
    let (rigid, width) = (0.1, 0.12);
    let r = rigid * surface.arc;
    let r_s = r * surface.shear_radius;
    let theta_1 = (1.0 - z / r).acos();
    let theta_2 = -(1.0 - surface.exit_ratio * z / r).acos();
    let theta_s = ((r - z) / r_s).acos();
    let ratio = velocity / (rigid * spin);
    let slip = if ratio <= 1.0 { 1.0 - ratio } else { 1.0 - 1.0 / ratio };
    let theta_m = (soil.c1 + soil.c2 * slip) * theta_1;
    let step = (theta_1 - theta_2) / POINTS as f64;
    let mut sums = [0.0; 3];
    for k in 0..POINTS {
        let theta = theta_2 + (k as f64 + 0.5) * step;
        let mapped = if theta >= theta_m {
            theta
        } else {
            theta_1 - (theta - theta_2) / (theta_m - theta_2) * (theta_1 - theta_m)
        };
        let sigma = (soil.k_c / width + soil.k_phi) * (r * (mapped.cos() - theta_1.cos())).powf(soil.exponent);
        let strength =
            surface.cohesion_gain * soil.cohesion + sigma * surface.friction_gain * soil.friction_angle.tan();
        let j = r_s * (theta_s - theta) - r * ratio * (theta_s.sin() - theta.sin());
        let built_up = 1.0 - (-j.abs() / soil.shear_modulus).exp();
        let share = match (surface.rounding, surface.grip) {
            (0.0, grip) => built_up.min(grip),
            (w, grip) => built_up * (1.0 + (built_up / grip).powf(1.0 / w) - built_up.powf(1.0 / w)).powf(-w),
        };
        let tau = j.signum() * strength * share;
        sums[0] += width * step * (r * sigma * theta.cos() + r_s * tau * theta.sin());
        sums[1] += width * step * (r_s * tau * theta.cos() - r * sigma * theta.sin());
        sums[2] += width * step * rigid * r_s * surface.shear_radius * tau;
    }
    sums
}

#[test]
fn analytic_lugs_grip_and_arc_enter_the_integrals_as_written() {
    let soil = rig().soil;
    let lugs = Surface { shear_radius: 1.08, cohesion_gain: 1.15, friction_gain: 1.07, ..Surface::default() };
    let smooth_rim = Surface { grip: 0.6, exit_ratio: 0.3, ..Surface::default() };
    let all = Surface { arc: 1.3, grip: 0.75, exit_ratio: 0.2, ..lugs };
    let rounded = [0.01, 0.05, 1.0 / 6.0, 0.5, 1.0].map(|rounding| Surface { rounding, ..smooth_rim });
    let sharp = [Surface { exit_ratio: 0.3, ..Surface::default() }, lugs, smooth_rim, all];
    for surface in sharp.into_iter().chain(rounded) {
        for shear_modulus in [0.003, 0.016] {
            let soil = Soil { shear_modulus, ..soil };
            for ratio in [0.1, 0.5, 0.95, 1.02, 1.08, 1.2, 1.6] {
                let forces = rolling_on(&rig().wheel, &soil, &surface, 0.012, 0.1 * ratio, 1.0);
                let [normal, drawbar, torque] = by_midpoints(&soil, &surface, 0.012, 0.1 * ratio, 1.0);
                let errors = [forces.normal - normal, forces.drawbar - drawbar, 10.0 * (forces.torque - torque)];
                let most = errors.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
                assert!(most < QUADRATURE * normal, "K {shear_modulus}, V/(r omega) {ratio}, {surface:?}: {errors:?}");
            }
        }
    }
}

#[test]
fn analytic_a_leading_normal_force_is_a_moment_of_the_load_alone() {
    let (wheel, soil) = (rig().wheel, rig().soil);
    for ((lead, lead_by_root), (velocity, spin)) in [
        ((0.004, 0.0), (0.08, 1.0)),
        ((0.004, 0.0), (0.1, 1.0)),
        ((0.0, 6e-4), (0.13, 1.0)),
        ((0.002, 3e-4), (-0.08, -1.0)),
        ((0.002, 3e-4), (0.0, 1.0)),
    ] {
        let plain = rolling_on(&wheel, &soil, &Surface::default(), 0.01, velocity, spin);
        let surface = Surface { lead, lead_by_root, ..Surface::default() };
        let leading = rolling_on(&wheel, &soil, &surface, 0.01, velocity, spin);
        let lead = lead + lead_by_root * plain.normal.sqrt();
        // The share of the motion that is the rim's, smoothed over three hundredths.
        let turn = 0.1 * spin / (0.1 * spin).hypot(velocity);
        let expected = lead * plain.normal * turn / turn.hypot(0.03);
        assert!(close(leading.torque - plain.torque, expected, SAME), "{velocity}: {expected} N m");
        assert!((leading.normal, leading.drawbar) == (plain.normal, plain.drawbar));
        assert!(close(expected.abs(), lead * plain.normal, 2e-3), "all of it");
    }
}

#[test]
fn analytic_rolling_resistance_grows_with_the_load_and_with_its_power_of_three_halves() {
    let (coefficient, growth, radius) = (0.03, 0.05, 0.1);
    let resists = with(|effects| {
        effects.rolling_resistance.coefficient = coefficient;
        effects.rolling_resistance.growth = growth;
    });
    for load in [20.0, 50.0, 120.0] {
        let slip = 0.2;
        let [plain, own] = [&rig(), &resists].map(|rig| steady_point(rig, load, slip, 1.0).unwrap());
        // The share of the motion that is the rim's, smoothed over three hundredths.
        let turn = 1.0 / f64::hypot(1.0, 1.0 - slip);
        let moment = radius * load * (coefficient + growth * (load / 50.0).sqrt()) * turn / turn.hypot(0.03);
        assert!(close(own.torque - plain.torque, moment, SAME), "{load} N: {moment} N m");
        assert!((own.drawbar_pull, own.sinkage) == (plain.drawbar_pull, plain.sinkage));
    }
}

#[test]
fn analytic_a_rim_that_slides_loses_its_share_of_the_shear() {
    let (rig, slick) = (rig(), Surface { grip: 0.7, ..Surface::default() });
    let locked = |surface: &Surface| rolling_on(&rig.wheel, &rig.soil, surface, 0.01, 0.1, 0.0).torque;
    assert!(close(locked(&slick), 0.7 * locked(&Surface::default()), SAME));
    // The torque meets its plateau at high slip, where a rough rim's still grows.
    let torque = |loss: f64, slip: f64| {
        let rig = with(|effects| effects.rim_adhesion.loss = loss);
        let forces =
            |surface: &Surface| rolling_on(&rig.wheel, &rig.soil, surface, 0.01, 0.1 * (1.0 - slip), 1.0).torque;
        forces(&Surface { grip: 1.0 - loss, ..Surface::default() })
    };
    let growth = |loss: f64| torque(loss, 0.9) / torque(loss, 0.6) - 1.0;
    assert!(growth(0.5) < 0.5 * growth(0.0), "{} and {}", growth(0.5), growth(0.0));
}

#[test]
fn published_lugs_pull_more_in_the_direction_and_size_of_ding() {
    // HIT-LSS1 and a wheel of r = 0.157 m, b = 0.165 m at 80 N (Ding et al. 2011, figure 9): lugs of 10 mm raise the
    // drawbar pull from 15.0 N to 23.0 N at a slip of 0.4 and to 24.5 N at 0.6, the torque from 5.0 to 6.3 N m and from
    // 5.3 to 7.2 N m.
    let mut rig = rig();
    rig.wheel = Wheel { radius: 0.157, width: 0.165, ..Wheel::default() };
    rig.soil = Soil {
        cohesion: 250.0,
        friction_angle: 31.9_f64.to_radians(),
        k_c: 15_600.0,
        k_phi: 2_407_400.0,
        exponent: 1.1,
        shear_modulus: 0.0114,
        ..Soil::default()
    };
    let pull = |rig: &Rig| steady_point(rig, 80.0, 0.5, 0.5).unwrap();
    let smooth = pull(&rig);
    rig.effects.grousers.height = 0.01;
    let lugged = pull(&rig);
    let gain = lugged.drawbar_pull / smooth.drawbar_pull - 1.0;
    let torque_gain = lugged.torque / smooth.torque - 1.0;
    assert!((gain - 0.58).abs() < READ_OFF, "drawbar pull grows by {gain}");
    assert!((torque_gain - 0.31).abs() < READ_OFF, "torque grows by {torque_gain}");
}

#[test]
fn analytic_moisture_is_cohesion() {
    let wet = with(|effects| {
        effects.moisture.content = 0.12;
        effects.moisture.cohesion_slope = 9000.0;
    });
    let mut cohesive = rig();
    cohesive.soil.cohesion += 9000.0 * 0.12;
    assert_same(&steady_point(&wet, 40.0, 0.3, 0.5).unwrap(), &steady_point(&cohesive, 40.0, 0.3, 0.5).unwrap());
}

#[test]
fn analytic_a_soft_patch_has_half_its_softening_at_its_half_width() {
    let mut effects = Effects::<f64>::default();
    effects.soft_patch.softening = 0.6;
    effects.soft_patch.centre = 2.0;
    effects.soft_patch.half_width = 0.4;
    for (x, left) in [(2.0, 0.4), (1.6, 0.7), (2.4, 0.7), (0.0, 1.0 - 0.6 / 626.0)] {
        let mut local = Local::new(Wheel::default(), Soil::default());
        effects.soft_patch.contact(&place(x, 0.0), &mut local);
        assert!(close(local.soil.k_phi, left * 850e3, SAME), "at {x}: {}", local.soil.k_phi);
    }
}

fn driven(rover: Rover, seconds: f64) -> Simulation {
    let mut simulation = Simulation::new(rover, 0.0, 0.002).unwrap();
    let steps = (seconds / 0.002_f64).round() as u64;
    assert_eq!(simulation.advance(&Command::speed(vec![2.5; 2]), steps).unwrap(), Status::Running);
    simulation
}

#[test]
fn analytic_strength_on_a_slope_is_that_of_a_smaller_friction_angle() {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    let slope = 8.0_f64.to_radians();
    rover.terrain = Terrain::new(Profile::Slope(Slope { slope }));
    let mut weaker = rover.clone();
    rover.effects.slope_strength.beta = 0.2;
    weaker.soil.friction_angle -= 0.2 * (slope.hypot(0.02) - 0.02);
    let loss = (Soil::<f64>::default().friction_angle - weaker.soil.friction_angle).to_degrees();
    assert!((1.0..1.6).contains(&loss), "a fifth of 8 degrees, less the rounding: {loss}");
    let (a, b) = (driven(rover, 4.0), driven(weaker, 4.0));
    let (a, b) = (a.signals(), b.signals());
    assert!(close(a.body.x, b.body.x, SAME) && close(a.wheels[0].torque, b.wheels[0].torque, SAME));
}

#[test]
fn analytic_the_rear_wheel_drives_on_what_the_front_wheel_has_compacted() {
    const GROWTH: f64 = 0.4;
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    rover.effects.multi_pass.growth = GROWTH;
    let mut fresh = Rig::of(&rover);
    fresh.effects = Effects::default();
    let mut passed = fresh.clone();
    passed.soil.k_c *= 1.0 + GROWTH;
    passed.soil.k_phi *= 1.0 + GROWTH;
    passed.soil.cohesion *= 1.0 + GROWTH;
    let check = |simulation: &Simulation, expected: [&Rig; 2]| {
        for (wheel, rig) in simulation.signals().wheels.iter().zip(expected) {
            let point = steady_point(rig, wheel.normal_force, wheel.slip, wheel.speed).unwrap();
            assert!(close(wheel.sinkage, point.sinkage, STEADY), "{wheel:?} and {point:?}");
            assert!(close(wheel.torque, point.torque, STEADY), "{wheel:?} and {point:?}");
        }
    };
    let mut simulation = driven(rover, 6.0);
    check(&simulation, [&passed, &fresh]);
    // Back over both tracks: each wheel's own and the other's.
    simulation.advance(&Command::speed(vec![-2.5; 2]), 1000).unwrap();
    let mut twice = fresh;
    twice.soil.k_c *= 1.0 + 2.0 * GROWTH;
    twice.soil.k_phi *= 1.0 + 2.0 * GROWTH;
    twice.soil.cohesion *= 1.0 + 2.0 * GROWTH;
    let tracks: Vec<_> = simulation.state().wheels.iter().map(|wheel| wheel.track).collect();
    let front_x = simulation.signals().body.x + 0.35;
    let alone = front_x > tracks[0].high;
    check(&simulation, [&twice, if alone { &passed } else { &twice }]);
}

#[test]
fn property_a_rover_parks_against_the_soil_ahead() {
    let mut rover = Rover::two_wheeled();
    rover.terrain = Terrain::new(Profile::Slope(Slope { slope: 0.17 }));
    rover.effects.bulldozing.share = 3.0;
    let mut parked = Simulation::new(rover, 0.0, 0.002).unwrap();
    let x = parked.signals().body.x;
    parked.advance(&Command::speed(vec![0.0; 2]), 10_000).unwrap();
    let moved = (parked.signals().body.x - x).abs();
    assert!(moved < 1e-3, "moved {moved} m in 20 s");
}
