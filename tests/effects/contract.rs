//! What every effect of the library promises: neutral to the last bit, finite within its bounds, continuous in its
//! parameters, and seen where its facts say and only there. Driven by the library's own table.

use crate::support::{DRIVES, Drive, Record, Settings, carriage, drive, free_parameters, parameters_of, switched_on};
use bekker::diagnosis::{Rig, SteadyError, steady_point};
use bekker::effects::{EFFECTS, Effects, Facts, Needs};
use bekker::model::RunError;
use bekker::modeldescription::{Parameters, Role};
use bekker::rover::Rover;
use bekker::scalar::Dual;
use bekker::simulation::StepError;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Share of a signal's size from which an effect counts as seen: far above rounding (1e-12) and the integrator's own
/// branches (1e-7).
const SEEN: f64 = 1e-4;
/// Step along the way from neutral (0) to switched on (1) at which continuity is judged.
const STEP: f64 = 2e-3;
/// Change of all signals over such a step, relative to their sizes, over the step. An effect switched on changes its
/// signals by about their size; where a rover nearly gets stuck, by several times that.
const STEEPEST: f64 = 20.0;
/// Half the step makes half the change; a square root would make 0.71 of it, a jump all of it.
const HALVING: f64 = 0.62;
/// The same for an effect that starts like a square root: theta_2 = -acos(1 - lambda z/r) over lambda at 0.
const HALVING_OF_A_ROOT: f64 = 0.75;
/// Changes below this are rounding and quadrature (1e-6 of a force), of which halving says nothing.
const FLOOR: f64 = 2e-6;
/// Half the distance of a difference, as a share of a parameter's range, and the error of its curvature.
const SHIFT: f64 = 1e-4;
const DIFFERENCE: f64 = 1e-5;
/// Both points of a difference are solved to this share of the load.
const ROUNDING: f64 = 1e-11;
/// Draws for each effect, and for all effects at once.
const DRAWS: usize = 4;
const DRAWS_OF_ALL: usize = 20;

use Drive::{Imposed, Linked, Torque};

/// What the library says of an effect.
fn facts(id: &str) -> Facts {
    Effects::<f64>::default().facts_of(id).unwrap_or_else(|| panic!("the library does not know {id}"))
}

/// Drives in which an effect is judged, and the signals of each in which it has to show; none: it changes nothing, to the
/// last bit.
fn drives_of(id: &str) -> Vec<(Drive, &'static [&'static str])> {
    let facts = facts(id);
    let seen = facts.seen_on_rover;
    match facts.needs {
        Needs::Nothing => vec![(Imposed, seen)],
        Needs::CommandedTorque => vec![(Imposed, &[]), (Torque, seen)],
        Needs::Joints => vec![(Imposed, &[]), (Linked, seen)],
    }
}

fn neutral(id: &str) -> Settings {
    parameters_of(id).into_iter().map(|variable| (variable.name, variable.default)).collect()
}

/// From neutral (0) to switched on (1); what is not free stays switched on.
fn on_the_way(id: &str, share: f64) -> Settings {
    let free: Vec<String> = free_parameters().into_iter().map(|variable| variable.name).collect();
    let ends = neutral(id).into_iter().zip(switched_on(id));
    let value = |name: &String, from: f64, to: f64| if free.contains(name) { from + share * (to - from) } else { to };
    ends.map(|((name, from), (_, to))| (name.clone(), value(&name, from, to))).collect()
}

#[test]
fn property_neutral_changes_nothing_bit_for_bit() {
    let none = Settings::new();
    let steady = carriage(&none).unwrap();
    let drives = DRIVES.map(|kind| drive(kind, &none).unwrap());
    for (kind, record) in DRIVES.iter().zip(&drives) {
        assert_eq!(record.event, None, "the baseline drives through, {kind:?}: {:?}", record.signal("x"));
    }
    for (id, _) in EFFECTS {
        // Whatever is not free of an effect counts only where the effect is at work; nor does the place of a patch.
        let aside = |name: &str, role: Role| {
            role != Role::Effect || name.starts_with("soft_patch.") && !name.ends_with("softening")
        };
        let mut settings = neutral(id);
        for (variable, (_, value)) in parameters_of(id).iter().zip(&mut settings) {
            if aside(&variable.name, variable.role) {
                *value = 0.3 * variable.min + 0.7 * variable.max;
            }
        }
        assert_eq!(carriage(&settings).unwrap().bits(), steady.bits(), "{id} on a carriage");
        for (kind, base) in DRIVES.into_iter().zip(&drives) {
            assert_eq!(drive(kind, &settings).unwrap().bits(), base.bits(), "{id}, {kind:?}");
        }
    }
}

#[test]
fn property_the_shape_of_a_flexible_wheel_without_compliance_changes_nothing_bit_for_bit() {
    let shape = [("arm_share", 0.7), ("arc_by_sinkage", 0.2), ("arc_by_load", 12.0)];
    let shaped: Settings = shape.iter().map(|(name, value)| (format!("flexible_wheel.{name}"), *value)).collect();
    let none = Settings::new();
    assert_eq!(carriage(&shaped).unwrap().bits(), carriage(&none).unwrap().bits());
    for kind in DRIVES {
        assert_eq!(drive(kind, &shaped).unwrap().bits(), drive(kind, &none).unwrap().bits(), "{kind:?}");
    }
}

/// Draws the free parameters of `ids` anywhere within their bounds, the corners included.
fn draw(rng: &mut ChaCha8Rng, ids: &[&str]) -> Settings {
    let mut settings = Settings::new();
    for id in ids {
        for variable in parameters_of(id).into_iter().filter(|variable| variable.role == Role::Effect) {
            let share = rng.random_range(-0.2..1.2_f64).clamp(0.0, 1.0);
            settings.push((variable.name, variable.min + share * (variable.max - variable.min)));
        }
        if *id == "moisture" {
            settings.push(("moisture.content".to_owned(), 0.3));
        }
    }
    settings
}

/// Signals stay finite, or the run says why it ends: a wheel at its axle, a rover that finds no rest.
fn assert_finite(settings: &Settings) {
    match carriage(settings) {
        Ok(record) => assert!(record.all_finite(), "{settings:?}: {record:?}"),
        Err(SteadyError::SunkToAxle { carried, .. }) => assert!(carried.is_finite(), "{settings:?}: {carried}"),
        Err(other) => panic!("{settings:?}: {other}"),
    }
    for kind in DRIVES {
        match drive(kind, settings) {
            Ok(record) => assert!(record.all_finite(), "{kind:?}, {settings:?}"),
            Err(RunError::Step(StepError::Settle(_))) => {}
            Err(other) => panic!("{kind:?}, {settings:?}: {other}"),
        }
    }
}

#[test]
fn property_each_effect_is_finite_within_its_bounds() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for (id, _) in EFFECTS {
        (0..DRAWS).for_each(|_| assert_finite(&draw(&mut rng, &[id])));
    }
}

#[test]
fn property_all_effects_at_once_are_finite_within_their_bounds() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let ids: Vec<&str> = EFFECTS.iter().map(|(id, _)| *id).collect();
    (0..DRAWS_OF_ALL).for_each(|_| assert_finite(&draw(&mut rng, &ids)));
}

/// Fails where the record jumps or is steep at `share` of the way.
fn assert_continuous(what: &str, share: f64, halving: f64, record: &dyn Fn(f64) -> Record) {
    let (here, on) = (record(share), record(1.0));
    let [whole, half] = [STEP, 0.5 * STEP].map(|step| here.largest_change(&record(share + step), &on));
    assert!(whole < STEEPEST * STEP, "{what} at {share}: a step of {STEP} changes the signals by {whole}");
    assert!(
        half < halving * whole + FLOOR,
        "{what} at {share}: half a step changes them by {half}, a whole by {whole}"
    );
}

#[test]
fn property_signals_are_continuous_in_the_parameters() {
    for (id, _) in EFFECTS {
        for share in [0.0, 0.4, 0.9] {
            let root = *id == "exit_angle" && share == 0.0;
            let halving = if root { HALVING_OF_A_ROOT } else { HALVING };
            assert_continuous(&format!("{id} on a carriage"), share, halving, &|share| {
                carriage(&on_the_way(id, share)).unwrap()
            });
            for (kind, _) in drives_of(id) {
                let what = format!("{id}, {kind:?}");
                assert_continuous(&what, share, halving, &|share| drive(kind, &on_the_way(id, share)).unwrap());
            }
        }
    }
}

/// Drawbar pull, torque and sinkage of a wheel with an effect switched on, and their derivatives in one parameter.
fn with_derivatives(id: &str, name: &str, shift: f64) -> [Dual<1>; 3] {
    let mut rover = Rover::two_wheeled();
    rover.soil.shear_modulus = 0.01;
    let mut rig = Rig::of(&rover).map(&Dual::<1>::from);
    let on = switched_on(id);
    rig.visit("", &mut |variable, place| {
        if let Some((_, value)) = on.iter().find(|(own, _)| *own == variable.name) {
            *place = Dual::from(*value);
        }
        if variable.name == name {
            *place = (*place + shift * (variable.max - variable.min)).derivative(0);
        }
    });
    let point = steady_point(&rig, 30.0, 0.4, 1.0).unwrap();
    [point.drawbar_pull, point.torque, point.sinkage]
}

#[test]
fn agreement_derivatives_at_a_steady_point_are_those_of_differences() {
    for variable in free_parameters() {
        let name = &variable.name;
        let id = name.split('.').next().unwrap_or_default();
        let exact = with_derivatives(id, name, 0.0);
        let [above, below] = [SHIFT, -SHIFT].map(|shift| with_derivatives(id, name, shift));
        for k in 0..3 {
            let slope = exact[k].eps.0.map_or(0.0, |all| all[0]);
            let difference = (above[k].re - below[k].re) / (2.0 * SHIFT * (variable.max - variable.min));
            let rounding = ROUNDING * exact[k].re.abs() / (SHIFT * (variable.max - variable.min));
            let error = (slope - difference).abs();
            assert!(error < DIFFERENCE * slope.abs() + rounding, "{name}, signal {k}: {slope} and {difference}");
        }
    }
}

fn assert_seen(what: &str, base: &Record, on: &Record, signals: &[&str]) {
    if signals.is_empty() {
        assert_eq!(base.bits(), on.bits(), "{what}: nothing is to be seen");
    }
    for signal in signals {
        let change = base.change(on, signal);
        assert!(change > SEEN, "{what}: {signal} changes by {change} of its size");
    }
}

#[test]
fn property_effects_show_where_they_should_and_nowhere_else() {
    let none = Settings::new();
    let steady = carriage(&none).unwrap();
    for (id, _) in EFFECTS {
        let (facts, on) = (facts(id), switched_on(id));
        assert!(!facts.seen_on_rover.is_empty(), "{id}: its facts say nowhere that it shows");
        assert_seen(&format!("{id} on a carriage"), &steady, &carriage(&on).unwrap(), facts.seen_on_carriage);
        for (kind, signals) in drives_of(id) {
            let (base, on) = (drive(kind, &none).unwrap(), drive(kind, &on).unwrap());
            assert_seen(&format!("{id}, {kind:?}"), &base, &on, signals);
        }
    }
}
