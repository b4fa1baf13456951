//! The oracle of chapter 4's tables, the best slips pose by pose: it agrees with a drive and with a search over slips.

use super::wheel_speeds::{by_speeds, ditch, firm, started};
use bekker::contact::Surface;
use bekker::control::rtc::{Distribution, SoilBelief};
use bekker::model::{ControlKind, Model, nominal};
use bekker::modeldescription::Lookup;
use bekker::signals::Measurement;
use bekker::soil::Soil;
use bekker::terrain::Terrain;
use nalgebra::{Matrix3, Vector3};
use std::cell::RefCell;

/// Difference of the largest pull and that of a search over slips, of the weight: the last limit on a change of force (0.8 % of that at
/// the best slip) and the grid of the search.
const PULL: f64 = 0.01;
/// The same on level sand, of the weight, where slips hardly move in the last rounds: the steps of the search.
const LEVEL_PULL: f64 = 0.003;
/// Steepness of the walls of [`lugs_in_digging_sand`], degrees: the largest pull in the hardest pose is near zero.
const STEEP: f64 = 23.0;

#[test]
fn agreement_the_oracle_with_a_drive_on_level_ground() {
    // Steady driving on level ground: no slips need less than those of the oracle, and those of the controller hardly more.
    let model = by_speeds(firm());
    let mut run = started(&model, 0.2);
    run.advance(5000).unwrap();
    let signals = run.signals();
    let mut oracle = model.oracle().unwrap();
    let mut pose = Measurement::of(2, 0);
    pose.pitch = signals.body.pitch;
    let bound = oracle.at(&pose, signals.body.velocity, |_| model.rover.soil).unwrap();
    let most = oracle.largest_pull(&pose, signals.body.velocity, |_| model.rover.soil).unwrap();
    assert!(bound.balanced && most > 0.1 * 98.1, "{bound:?}, {most} N");
    let over = signals.body.electrical_power / bound.electrical_power - 1.0;
    assert!((-1e-3..5e-3).contains(&over), "{} W, bound {} W", signals.body.electrical_power, bound.electrical_power);
    // Nothing climbs a wall.
    pose.pitch = 1.0;
    pose.wheels.iter_mut().for_each(|wheel| wheel.contact_angle = 1.0);
    let wall = oracle.at(&pose, 0.2, |_| model.rover.soil).unwrap();
    let most = oracle.largest_pull(&pose, 0.2, |_| model.rover.soil).unwrap();
    assert!(!wall.balanced && most < 0.0 && wall.electrical_power.is_infinite(), "{wall:?}, {most} N");
}

/// The FSRL rover with lugs before a ditch whose sand gives way to slip.
fn lugs_in_digging_sand() -> Model {
    let mut model = ditch(STEEP, 0.01);
    model.set("slip_sinkage.n1", 0.4).unwrap();
    model
}

/// Largest horizontal force that any slips of the three wheels give the rover at a pose, N, by a search over a grid of slips that is
/// refined about its best point. The loads follow from weight and moments, which are as many equations as wheels. The geometry is that
/// of the controller's balance. Nothing accelerates here, while the oracle counts the inertia of the bogie under the pull that is left:
/// near zero pull both are the same.
fn largest_pull_by_search(model: &Model, pose: &Measurement, soil: impl Fn(usize) -> Soil) -> f64 {
    let rover = nominal(&model.rover);
    let (radius, limit) = (rover.wheel.radius, rover.torque_limit().unwrap());
    let mut balance = Distribution::new(&rover);
    let angles = pose.wheels.iter().map(|wheel| wheel.contact_angle);
    balance.place(&rover, pose.pitch, pose.links.iter().map(|link| link.angle), angles);
    balance.demand(&rover, 0.0);
    let lugs = &model.rover.effects.grousers;
    let surface = Surface::smooth(0.0).with_lugs(&rover.wheel, lugs.height, lugs.share);
    let digging = model.rover.effects.slip_sinkage.n1;
    let belief = |k: usize| SoilBelief { digging, surface, ..SoilBelief::new(rover.wheel, soil(k)) };
    let pull = |slips: [f64; 3]| -> Option<f64> {
        let mut loads = [rover.weight() / 3.0; 3];
        for _ in 0..200 {
            let states: Vec<_> = (0..3).map(|k| belief(k).at(loads[k], slips[k])).collect();
            // Rows 1 to 3 are vertical force, moment and the moment about the bogie's joint.
            let axle = |row: usize, k: usize| balance.axle_coefficient(row, k);
            let turning = |row: usize, k: usize| balance.rim_coefficients(row, k)[0] - axle(row, k);
            let soil_force =
                |row: usize, k: usize| axle(row, k) * states[k].pull + turning(row, k) * states[k].torque / radius;
            let of_load = Matrix3::from_fn(|row, k| balance.rim_coefficients(row + 1, k)[1]);
            let wanted = Vector3::from_fn(|row, _| {
                balance.wanted(row + 1) - (0..3).map(|k| soil_force(row + 1, k)).sum::<f64>()
            });
            let next = of_load.try_inverse()? * wanted;
            let change = (0..3).map(|k| (next[k] - loads[k]).abs()).fold(0.0, f64::max);
            // Half a step: pull and torque grow with the load.
            loads = std::array::from_fn(|k| (0.5 * (loads[k] + next[k])).max(1e-3));
            if change < 1e-6 * rover.weight() {
                let fits = states.iter().all(|state| state.torque.abs() <= limit * (1.0 + 1e-6) && state.carried);
                let force = |k: usize| axle(0, k) * states[k].pull + balance.rim_coefficients(0, k)[1] * loads[k];
                return (fits && next.min() > 0.0).then(|| (0..3).map(force).sum());
            }
        }
        None
    };
    let (mut best, mut centre, mut step) = (f64::NEG_INFINITY, [0.3; 3], 0.1);
    let mut slips: Vec<[f64; 3]> =
        (0..125).map(|n| [n % 5, n / 5 % 5, n / 25].map(|k| -0.2 + 0.3 * f64::from(k))).collect();
    for _ in 0..20 {
        let before = best;
        for slip in slips.iter().map(|slip| slip.map(|i| i.clamp(-0.5, 0.99))) {
            if let Some(force) = pull(slip).filter(|&force| force > best) {
                (best, centre) = (force, slip);
            }
        }
        if best <= before {
            step *= 0.5;
        }
        let around = |n: i32| [n % 3, n / 3 % 3, n / 9].map(|k| f64::from(k - 1) * step);
        slips = (0..27).map(|n| std::array::from_fn(|k| centre[k] + around(n)[k])).collect();
    }
    best
}

/// The pose of the FSRL rover at rest, placed at `x` m, and where its chassis reference point then is, m.
fn at_rest(model: &Model, x: f64) -> (Measurement, f64) {
    let mut there = model.clone();
    (there.start.x0, there.control.kind) = (x, ControlKind::Torque);
    let run = there.start().unwrap();
    let signals = run.signals();
    let mut pose = Measurement::of(3, 1);
    pose.pitch = signals.body.pitch;
    pose.wheels.iter_mut().zip(&signals.wheels).for_each(|(seen, wheel)| seen.contact_angle = wheel.contact_angle);
    pose.links.iter_mut().zip(&signals.links).for_each(|(seen, link)| seen.angle = link.angle);
    (pose, signals.body.x)
}

#[test]
fn agreement_the_largest_pull_on_level_sand_with_a_search_over_all_slips() {
    // A fifth of the weight is left. The front wheel carries little, and pulls most at nearly full slip.
    let mut model = lugs_in_digging_sand();
    model.rover.terrain = Terrain::default();
    model.rover.soil.cohesion = 180.0;
    let ours = model.largest_pull(&mut model.oracle().unwrap(), 0.0, 0.06).unwrap();
    let (pose, _) = at_rest(&model, 0.0);
    let theirs = largest_pull_by_search(&model, &pose, |_| model.rover.soil);
    let weight = nominal(&model.rover).weight();
    assert!((ours - theirs).abs() <= LEVEL_PULL * weight && ours > 0.15 * weight, "{ours} and {theirs} N");
    // Backwards, the rover's mirror image need not pull as much, but it pulls.
    let back = model.largest_pull(&mut model.oracle().unwrap(), 0.0, -0.06).unwrap();
    assert!((0.1 * weight..0.3 * weight).contains(&back), "{back} N");
}

#[test]
fn agreement_the_largest_pull_with_a_search_over_all_slips() {
    // Where the rear wheel begins to climb the far wall hardly any pull is left. Without a limit on the change of forces the rounds
    // of the linearised soil alternate there between two solutions that the soil does not give.
    let model = lugs_in_digging_sand();
    let mut oracle = model.oracle().unwrap();
    let mut hardest = f64::INFINITY;
    for x in [0.995, 1.0, 1.005, 1.01, 1.05] {
        let (pose, at) = at_rest(&model, x);
        // The oracle asks for the soil under each wheel, rear to front.
        let soils = RefCell::new(Vec::new());
        let ground = |along: f64| {
            let soil = model.rover.terrain.soil(&model.rover.soil, at + along);
            soils.borrow_mut().push(soil);
            soil
        };
        let attainable = oracle.at(&pose, 0.06, ground).unwrap();
        let ours = oracle.largest_pull(&pose, 0.06, ground).unwrap();
        assert_eq!(model.largest_pull(&mut oracle, x, 0.06).unwrap(), ours, "x = {x} m");
        let theirs = largest_pull_by_search(&model, &pose, |k| soils.borrow()[k]);
        let weight = nominal(&model.rover).weight();
        assert!((ours - theirs).abs() <= PULL * weight, "x = {x} m: {ours} and {theirs} N");
        if ours.abs() > PULL * weight {
            assert_eq!(attainable.balanced, ours > 0.0, "x = {x} m: {attainable:?}, {ours} N");
        }
        hardest = hardest.min(ours);
    }
    assert!(hardest.abs() < 1.0, "one of the poses is to be within 3 % of the weight of the limit: {hardest} N");
}
