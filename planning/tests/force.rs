//! Forces between wheels and ground: the convex programme against enumeration, and the size of its space of solutions.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::soil::Soil;
use bekker::wheel::Wheel;
use bekker_planning::force::{Assumptions, Equilibrium, ForceError, Lateral, Load, Programme, Shear, ShearError};
use bekker_planning::map::{ElevationMap, GroundShape, Interpolation, Surface, generated};
use bekker_planning::pose::{Placing, Pose};
use bekker_planning::robot::{Frames, Robot, fsrl, sample_return};
use nalgebra::{DMatrix, DVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Shares of the weight: what the programme keeps its equations and limits to.
const KEPT: f64 = 1e-6;

/// Boxes of tractions that the enumeration looks at for a pose.
const BOXES: usize = 20_000;

/// The enumeration leaves the largest thrust open within this share of the weight on average: its resolution.
const RESOLUTION: f64 = 0.1;

fn plane(gx: f64, gy: f64) -> Surface {
    let map = ElevationMap::from_formula(81, 81, 0.05, [-2.0, -2.0], |x, y| gx * x + gy * y).unwrap();
    Surface::new(map, Interpolation::Smooth)
}

fn programme(robot: &Robot, ground: &Surface, shear: Shear, assumptions: Assumptions) -> Programme {
    let placing = Placing::new(robot, ground, &[]).unwrap();
    let pose = placing.pose([0.0, 0.0], 0.0, None).unwrap();
    Programme::new(&placing, &pose, &Load::default(), &shear, assumptions).unwrap()
}

#[test]
fn analytic_level_ground_gives_the_friction_limit_and_the_drive_limit() {
    let (ground, robot) = (plane(0.0, 0.0), fsrl());
    let weight = robot.total_mass() * 9.81;
    let thrust = |friction: f64| {
        let programme = programme(&robot, &ground, Shear::firm(friction), Assumptions::default());
        programme.largest_thrust().unwrap().unwrap().thrust
    };
    assert!((thrust(0.3) - 0.3 * weight).abs() < 1e-4 * weight);
    // Six drives of 0.706 N m at 6.4 cm: at a high friction the motors are the limit, unless a wheel lifts before.
    let drives = 6.0 * 0.706 / 0.064;
    assert!(thrust(2.0) <= drives + 1e-4 * weight);
}

#[test]
fn analytic_wheel_loads_on_level_ground_are_those_of_section_4_4_2() {
    let (ground, robot) = (plane(0.0, 0.0), fsrl());
    let programme = programme(&robot, &ground, Shear::firm(0.0), Assumptions::default());
    let forces = programme.largest_thrust().unwrap().unwrap();
    let weight = robot.total_mass() * 9.81;
    // Rear, middle, front of a side: 49, 35, 16 % (arms stated to four digits).
    for (load, share) in forces.normal.iter().zip([0.49, 0.35, 0.16, 0.49, 0.35, 0.16]) {
        assert!((load / weight - 0.5 * share).abs() < 0.002, "{:?}", forces.normal);
    }
}

#[test]
fn analytic_a_slope_is_climbed_up_to_the_friction_angle() {
    let robot = fsrl();
    for (slope, climbs) in [(0.38, true), (0.42, false)] {
        let programme = programme(&robot, &plane(slope, 0.0), Shear::firm(0.4), Assumptions::default());
        assert_eq!(programme.gives(0.0).unwrap(), climbs, "slope {slope}");
        // Down the same slope it can brake, or slides.
        let down = self::programme(&robot, &plane(-slope, 0.0), Shear::firm(0.4), Assumptions::default());
        assert_eq!(down.gives(0.0).unwrap(), climbs, "slope {slope}, downhill");
    }
}

#[test]
fn analytic_a_cross_slope_takes_traction_away() {
    let robot = fsrl();
    let thrust = |slope: f64| {
        let programme = programme(&robot, &plane(0.0, slope), Shear::firm(0.5), Assumptions::default());
        programme.largest_thrust().unwrap().map(|forces| forces.thrust / (robot.total_mass() * 9.81))
    };
    let (level, across) = (thrust(0.0).unwrap(), thrust(0.3).unwrap());
    // All wheels share the side force by their loads at best: sqrt(mu^2 cos^2 - sin^2).
    let (sin, cos) = 0.3_f64.atan().sin_cos();
    assert!(across < level && across <= (0.25 * cos * cos - sin * sin).sqrt() + KEPT, "{level} {across}");
    assert!(thrust(0.6).is_none_or(|thrust| thrust <= 0.0), "beyond the friction angle it slides sideways");
}

/// One equation for each unknown beside the tractions: what follows from a choice of tractions. Own code, from the contacts.
struct Enumeration {
    /// (N of all wheels, shift, turn, thrust) = constant + matrix T.
    constant: DVector<f64>,
    matrix: DMatrix<f64>,
    ahead: Vec<f64>,
    drive: f64,
    friction: f64,
    adhesion: f64,
}

impl Enumeration {
    fn new(placing: &Placing, pose: &Pose, shear: &Shear) -> Option<Self> {
        let robot = placing.robot();
        let weight = robot.total_mass() * 9.81;
        let frames = Frames::new(robot, &pose.attitude, placing.active());
        let travel = frames.direction(None, Vector3::x());
        let n = pose.contacts.len();
        let passive = robot.passive();
        let unknowns = n + 3;
        let mut left = DMatrix::zeros(6 + passive, unknowns);
        let mut right = DMatrix::zeros(6 + passive, n);
        let ahead: Vec<f64> = pose.contacts.iter().map(|c| (c.point - pose.centre_of_mass).dot(&travel)).collect();
        for (k, contact) in pose.contacts.iter().enumerate() {
            let motions = frames.motion(robot.wheels[k].link, contact.point);
            let column = |force: Vector3<f64>| {
                let moment = (contact.point - pose.centre_of_mass).cross(&force);
                let work = motions[3..].iter().map(|motion| motion.dot(&force));
                DVector::from_iterator(6 + passive, force.iter().chain(moment.iter()).copied().chain(work))
            };
            left.set_column(k, &column(contact.normal));
            let lateral = column(contact.left);
            let (shift, turn) = (left.column(n) + &lateral, left.column(n + 1) + &lateral * ahead[k]);
            left.set_column(n, &shift);
            left.set_column(n + 1, &turn);
            right.set_column(k, &-column(contact.forward));
        }
        (0..3).for_each(|axis| left[(axis, n + 2)] = -travel[axis]);
        let mut weights = DVector::zeros(6 + passive);
        weights[2] = 1.0;
        for coordinate in 0..passive {
            let lifted = robot.links.iter().enumerate().map(|(k, link)| {
                let at = frames.point(Some(k), link.centre_of_mass);
                link.mass * 9.81 / weight * frames.motion(Some(k), at)[3 + coordinate].z
            });
            weights[6 + coordinate] = lifted.sum();
        }
        let lu = left.lu();
        let drive = robot.wheel_torque / robot.wheel_radius / weight;
        let (friction, adhesion) = (shear.friction, shear.adhesion / weight);
        Some(Self { constant: lu.solve(&weights)?, matrix: lu.solve(&right)?, ahead, drive, friction, adhesion })
    }

    /// Largest excess over a limit, and the thrust.
    fn at(&self, tractions: &[f64]) -> (f64, f64) {
        let n = tractions.len();
        let rest = &self.constant + &self.matrix * DVector::from_column_slice(tractions);
        let excess = (0..n).map(|k| {
            let lateral = rest[n] + rest[n + 1] * self.ahead[k];
            (-rest[k]).max(tractions[k].hypot(lateral) - self.adhesion - self.friction * rest[k])
        });
        (excess.fold(f64::NEG_INFINITY, f64::max), rest[n + 2])
    }

    /// How much thrust and excess can change within a box of tractions of these half widths.
    fn change(&self, half: &[f64]) -> (f64, f64) {
        let n = half.len();
        let of = |row: &dyn Fn(usize) -> f64| (0..n).map(|j| row(j).abs() * half[j]).sum::<f64>();
        let excess = (0..n).map(|k| {
            let normal = of(&|j| self.matrix[(k, j)]);
            let lateral = of(&|j| self.matrix[(n, j)] + self.matrix[(n + 1, j)] * self.ahead[k]);
            normal.max(half[k] + lateral + self.friction * normal)
        });
        (excess.fold(0.0, f64::max), of(&|j| self.matrix[(n + 2, j)]))
    }

    /// A lower and an upper bound of the largest thrust: a grid of boxes of tractions that is refined where the upper bound is
    /// highest. The lower bound is that of a middle that keeps all limits; a box is dropped only where no point of it can keep
    /// them. Without a lower bound: negative infinity; without any box left: both.
    fn largest_thrust(&self, wheels: usize) -> (f64, f64) {
        let mut low = f64::NEG_INFINITY;
        let mut boxes: Vec<(f64, Vec<f64>, Vec<f64>)> =
            vec![(f64::INFINITY, vec![0.0; wheels], vec![self.drive; wheels])];
        for _ in 0..BOXES {
            // A few boxes from the top are enough to keep the order: the vector is sorted by the bound.
            let Some((bound, middle, half)) = boxes.pop() else { return (low, low) };
            if bound <= low {
                return (low, low);
            }
            let longest = (0..wheels).max_by(|&a, &b| half[a].total_cmp(&half[b])).unwrap();
            for side in [-0.5, 0.5] {
                let (mut middle, mut half) = (middle.clone(), half.clone());
                middle[longest] += side * half[longest];
                half[longest] *= 0.5;
                let ((excess, thrust), (by, more)) = (self.at(&middle), self.change(&half));
                if excess <= 0.0 {
                    low = low.max(thrust);
                }
                let bound = (thrust + more).min(bound);
                if excess <= by && bound > low {
                    let place = boxes.partition_point(|(other, ..)| *other < bound);
                    boxes.insert(place, (bound, middle, half));
                }
            }
        }
        (low, boxes.last().map_or(low, |(bound, ..)| *bound))
    }
}

#[test]
fn agreement_programme_and_enumeration_on_200_random_poses() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (mut feasible, mut infeasible, mut thin, mut refuted, mut poses) = (0, 0, 0, 0, 0);
    let mut open = Vec::new();
    let shape = GroundShape { nodes: 121, cell: 0.04, feature: 0.2, roughness: 0.08, swell: 0.15 };
    for seed in 0.. {
        if poses == 200 {
            break;
        }
        // Three of four with four wheels: the enumeration of six tractions takes 25 times as long.
        let robot = if seed % 4 == 0 { fsrl() } else { sample_return() };
        let ground = Surface::new(generated(&shape, seed).unwrap(), Interpolation::Smooth);
        let placing = Placing::new(&robot, &ground, &[]).unwrap();
        let place = [random.random_range(1.2..3.6), random.random_range(1.2..3.6)];
        let Ok(pose) = placing.pose(place, random.random_range(-PI..PI), None) else { continue };
        let shear =
            Shear { adhesion: random.random_range(0.0..3.0), friction: random.random_range(0.2..0.7), resistance: 0.0 };
        let Some(enumeration) = Enumeration::new(&placing, &pose, &shear) else { continue };
        poses += 1;
        let programme = Programme::new(&placing, &pose, &Load::default(), &shear, Assumptions::default()).unwrap();
        let weight = robot.total_mass() * 9.81;
        let ours = programme.largest_thrust().unwrap();
        // What the programme calls feasible is: the enumeration's own equations and limits hold at its tractions.
        if let Some(forces) = &ours {
            let tractions: Vec<f64> = forces.traction.iter().map(|t| t / weight).collect();
            let (excess, thrust) = enumeration.at(&tractions);
            assert!(excess < KEPT, "pose {poses}: infeasible called feasible, by {excess}");
            assert!((thrust - forces.thrust / weight).abs() < KEPT, "pose {poses}: {thrust}");
            assert!(tractions.iter().all(|t| t.abs() < enumeration.drive + KEPT));
        }
        let (low, high) = enumeration.largest_thrust(robot.wheels.len());
        match ours.map(|forces| forces.thrust / weight) {
            Some(ours) => {
                assert!(low - KEPT <= ours && ours <= high + KEPT, "pose {poses}: {ours} is not within {low}..{high}");
                feasible += 1;
                // Too thin a region for the boxes has an upper bound only.
                if low.is_finite() { open.push(high - low) } else { thin += 1 }
            }
            None => {
                assert!(low == f64::NEG_INFINITY, "pose {poses}: feasible called infeasible");
                infeasible += 1;
                refuted += usize::from(high == f64::NEG_INFINITY);
            }
        }
    }
    let open_mean = open.iter().sum::<f64>() / open.len() as f64;
    println!(
        "{feasible} feasible ({thin} too thin), {infeasible} infeasible ({refuted} by both); open {open_mean:.4} W"
    );
    assert!(infeasible >= 10 && feasible >= 100 && refuted >= 5, "both kinds of pose are tried");
    // Regions that the boxes leave without a lower bound: the programme's own forces have been checked above for these too.
    assert!(thin <= 20 && open_mean < RESOLUTION);
}

#[test]
fn agreement_volume_of_the_solution_space_with_counting() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let (robot, ground) = (sample_return(), plane(0.1, 0.05));
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([0.0, 0.0], 0.3, None).unwrap();
    let shear = Shear::firm(0.5);
    let weight = robot.total_mass() * 9.81;
    let programme = Programme::new(&placing, &pose, &Load::default(), &shear, Assumptions::default()).unwrap();
    let space = programme.solution_space(0.05 * weight, 8, 1).unwrap();
    // Counting in the box of tractions: the volume there, times the stretch from tractions at one thrust to all variables.
    let enumeration = Enumeration::new(&placing, &pose, &shear).unwrap();
    let thrust = enumeration.matrix.row(6).transpose();
    // Tractions T2..T4 are free, T1 follows from the thrust.
    let count = 400_000;
    let mut inside = 0;
    for _ in 0..count {
        let mut tractions: Vec<f64> =
            (0..4).map(|_| random.random_range(-enumeration.drive..enumeration.drive)).collect();
        let others: f64 = (1..4).map(|k| thrust[k] * tractions[k]).sum();
        tractions[0] = (0.05 - enumeration.constant[6] - others) / thrust[0];
        let within = tractions[0].abs() <= enumeration.drive && enumeration.at(&tractions).0 <= 0.0;
        inside += usize::from(within);
    }
    // All variables (N, T, L, thrust, shift, turn) as they move with T2..T4.
    let mut motion = DMatrix::zeros(3 * 4 + 3, 3);
    for k in 1..4 {
        let mut tractions = DVector::zeros(4);
        (tractions[k], tractions[0]) = (1.0, -thrust[k] / thrust[0]);
        let rest = &enumeration.matrix * &tractions;
        for wheel in 0..4 {
            motion[(wheel, k - 1)] = rest[wheel];
            motion[(4 + wheel, k - 1)] = tractions[wheel];
            motion[(8 + wheel, k - 1)] = rest[4] + rest[5] * enumeration.ahead[wheel];
        }
        (motion[(13, k - 1)], motion[(14, k - 1)]) = (rest[4], rest[5]);
    }
    let stretch = (motion.transpose() * &motion).determinant().sqrt();
    let share = inside as f64 / f64::from(count);
    let counted = share * (2.0 * enumeration.drive).powi(3) * stretch;
    assert_eq!(space.dimension, 3);
    let error = space.volume / counted - 1.0;
    println!("volume {} +- {:.1} %, counted {counted}", space.volume, 100.0 * space.relative_error);
    // Four standard errors of the walks, and 1 % for the counting.
    assert!(error.abs() < 4.0 * space.relative_error + 0.01, "{error}");
    assert_eq!(space, programme.solution_space(0.05 * weight, 8, 1).unwrap());
}

#[test]
fn property_the_space_shrinks_with_friction_and_is_empty_where_nothing_holds() {
    let robot = fsrl();
    let volume = |friction: f64| {
        let programme = programme(&robot, &plane(0.2, 0.0), Shear::firm(friction), Assumptions::default());
        programme.solution_space(0.5, 3, 1).unwrap()
    };
    let (high, low, none) = (volume(0.8), volume(0.4), volume(0.1));
    assert!(high.volume > low.volume && low.volume > 0.0 && none.volume == 0.0, "{high:?} {low:?} {none:?}");
    assert!(high.inradius > low.inradius && none.inradius <= 0.0);
}

#[test]
fn property_fewer_equations_allow_more() {
    let (robot, ground) = (fsrl(), plane(0.15, 0.1));
    let thrust = |equilibrium, lateral| {
        let programme = programme(&robot, &ground, Shear::firm(0.45), Assumptions { lateral, equilibrium });
        programme.largest_thrust().unwrap().unwrap().thrust
    };
    let jointed = thrust(Equilibrium::Jointed, Lateral::Compliant);
    assert!(thrust(Equilibrium::Rigid, Lateral::Compliant) >= jointed - 1e-6);
    assert!(thrust(Equilibrium::Jointed, Lateral::Free) >= jointed - 1e-6);
}

#[test]
fn agreement_strength_under_a_wheel_follows_the_cores_soil() {
    let (wheel, soil) = (Wheel::default(), Soil::default());
    let shear = Shear::of(&soil, &wheel, 50.0).unwrap();
    // Strength is counted on as far as half the wheel's slip builds it up.
    let whole = soil.friction_angle.tan();
    assert!(shear.friction < whole && shear.friction > 0.3 * whole, "{shear:?}");
    let stiff = Shear::of(&Soil { shear_modulus: 0.001, ..soil }, &wheel, 50.0).unwrap();
    assert!(stiff.friction > 0.85 * whole && stiff.friction <= whole, "{stiff:?}");
    // A patch of b times a few centimetres under 1 kPa: 2 to 15 N.
    assert!((2.0..15.0).contains(&shear.adhesion) && (0.01..0.5).contains(&shear.resistance), "{shear:?}");
    let soft = Soil { k_phi: 200_000.0, ..soil };
    assert!(Shear::of(&soft, &wheel, 50.0).unwrap().resistance > shear.resistance);
    let bog = Soil { k_phi: 1000.0, ..soil };
    assert!(matches!(Shear::of(&bog, &wheel, 500.0), Err(ShearError::Sinks { .. })));
}

#[test]
fn property_wrong_numbers_are_named() {
    let (robot, ground) = (fsrl(), plane(0.0, 0.0));
    let placing = Placing::new(&robot, &ground, &[]).unwrap();
    let pose = placing.pose([0.0, 0.0], 0.0, None).unwrap();
    let load = Load { gravity: f64::NAN, ..Load::default() };
    let refused = Programme::new(&placing, &pose, &load, &Shear::firm(0.5), Assumptions::default()).unwrap_err();
    assert!(matches!(refused, ForceError::Number { name: "gravity", .. }));
    let refused = Programme::new(&placing, &pose, &Load::default(), &Shear::firm(-0.5), Assumptions::default());
    assert!(refused.unwrap_err().to_string().starts_with("friction is -0.5"));
}
