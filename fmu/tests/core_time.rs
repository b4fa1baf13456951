//! Any communication step: whole inner steps are the core's, points between are interpolated.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod core_support;

use bekker::model::{Model as RoverModel, Run};
use bekker::modeldescription::Parameters;
use bekker_fmu::Kind;
use bekker_fmu::model::{FmuModel, Outcome};
use core_support::{get, loaded, reference, set};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Inner step of the presets, s.
const STEP: f64 = 0.002;
/// Rounding of one interpolation, relative to the values.
const ROUNDING: f64 = 1e-14;

fn signals(run: &Run) -> Vec<f64> {
    let mut all = Vec::new();
    run.signals().values(&mut |value| all.push(value));
    all
}

/// The FMU's signals, which come first among its outputs.
fn shown(fmu: &dyn FmuModel, count: usize) -> Vec<f64> {
    let first = reference(fmu, "x");
    (first..first + count).map(|reference| fmu.get(reference)).collect()
}

#[test]
fn agreement_at_whole_steps_to_the_last_bit_whatever_lies_between() {
    let model = RoverModel::preset("two_wheeled").unwrap();
    let mut dice = ChaCha8Rng::seed_from_u64(4);
    let mut fmu = loaded(&model, Kind::RoverWithController);
    fmu.start().unwrap();
    let mut run = model.start().unwrap();
    // Of the core: how many steps it has made with the inputs that it has.
    let (mut time, mut made) = (0.0_f64, 0_u64);
    let (mut on, mut off) = (0, 0);
    for _ in 0..300 {
        let torques = [dice.random_range(0.2..1.2), dice.random_range(0.2..1.2)];
        set(&mut *fmu, "wheel[1].torque_command", torques[0]);
        set(&mut *fmu, "wheel[2].torque_command", torques[1]);
        run.inputs_mut().set_all(&torques).unwrap();
        let whole = dice.random();
        let next = (time / STEP).floor() + f64::from(dice.random_range(1_u32..5));
        time = if whole { next * STEP } else { (next + dice.random_range(0.1..0.9)) * STEP };
        assert_eq!(fmu.advance_to(time).unwrap(), Outcome::Running);
        let end = if whole { next as u64 } else { next as u64 + 1 };
        if whole {
            run.advance(end - made).unwrap();
            assert_eq!(shown(&*fmu, signals(&run).len()), signals(&run), "at {time} s");
            on += 1;
        } else {
            run.advance(end - 1 - made.min(end - 1)).unwrap();
            if made < end {
                let before = signals(&run);
                run.advance(1).unwrap();
                let share = time / STEP - next;
                for ((shown, before), after) in shown(&*fmu, before.len()).iter().zip(&before).zip(signals(&run)) {
                    let expected = before + share * (after - before);
                    // The share is a difference of numbers of some 1e3 steps.
                    let room = 1e3 * ROUNDING * (after - before).abs() + ROUNDING * expected.abs();
                    assert!((shown - expected).abs() <= room, "{shown}, {expected} at {time} s");
                }
                off += 1;
            }
        }
        made = end;
        assert!((fmu.elapsed() - time).abs() < 1e-12, "{} at {time}", fmu.elapsed());
    }
    assert!(on > 50 && off > 50, "{on} points on whole steps, {off} between");
}

#[test]
fn property_points_within_one_step_move_along_a_line() {
    let model = RoverModel::preset("gentle_rtc").unwrap();
    let mut fmu = loaded(&model, Kind::RoverWithController);
    fmu.start().unwrap();
    fmu.advance_to(100.0 * STEP).unwrap();
    let at = |fmu: &dyn FmuModel| get(fmu, "x");
    let start = at(&*fmu);
    let mut copy = fmu.duplicate();
    copy.advance_to(101.0 * STEP).unwrap();
    let end = at(&*copy);
    for share in [0.25, 0.5, 0.5, 0.75] {
        fmu.advance_to((100.0 + share) * STEP).unwrap();
        assert!((at(&*fmu) - (start + share * (end - start))).abs() < 1e-12 * end.abs().max(1.0));
    }
    assert!(fmu.advance_to((100.0 + 0.5) * STEP).unwrap_err().0.contains("before"));
    fmu.advance_to(101.0 * STEP).unwrap();
    assert_eq!(at(&*fmu), end);
    assert!(fmu.advance_to(99.0 * STEP).is_err());
    assert!(fmu.advance_to(f64::NAN).is_err());
    assert!(fmu.advance_to(1e12).is_err());
}

#[test]
fn property_an_end_between_points_is_told_at_the_point_after_it() {
    // A short flat ground, off which the front wheel drives.
    let text =
        "preset = \"two_wheeled_speed\"\n[terrain]\nx = [-2.0, -1.0, 0.0, 0.5, 0.8]\nz = [0.0, 0.0, 0.0, 0.0, 0.0]\n";
    let model = RoverModel::from_toml(text, None).unwrap();
    let mut run = model.start().unwrap();
    run.inputs_mut().set_all(&[3.0, 3.0]).unwrap();
    run.advance(100_000).unwrap();
    let ended = run.time();
    assert!(ended > 0.1 && ended < 10.0, "the core's run ended at {ended} s");
    let mut fmu = loaded(&model, Kind::RoverWithController);
    set(&mut *fmu, "wheel[1].speed_command", 3.0);
    set(&mut *fmu, "wheel[2].speed_command", 3.0);
    fmu.start().unwrap();
    let mut time = 0.0;
    let outcome = loop {
        time += 0.0007;
        let outcome = fmu.advance_to(time).unwrap();
        if outcome != Outcome::Running {
            break outcome;
        }
        assert_eq!(get(&*fmu, "event"), 0.0);
    };
    assert!(matches!(outcome, Outcome::Ended { .. }));
    assert!(get(&*fmu, "event") > 0.0);
    assert_eq!(fmu.elapsed(), ended);
    assert!(time >= ended && time - ended < STEP + 0.0007, "told at {time} s, ended at {ended} s");
    // And it stays ended.
    assert!(matches!(fmu.advance_to(time + 1.0).unwrap(), Outcome::Ended { .. }));
    assert_eq!(fmu.elapsed(), ended);
}
