//! Runs stepped together, beside the same runs alone.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::batch::{Batch, BatchError};
use bekker::model::{Model, Run, RunError};
use bekker::modeldescription::{Lookup, Parameters};
use bekker::simulation::{Event, Status};

const STEPS: u64 = 10;

/// Runs over different soils, the last of which gets stuck.
fn runs(count: usize) -> Vec<Run> {
    let mut model = Model::preset("two_wheeled").unwrap();
    let run = |k: usize| {
        let share = k as f64 / count as f64;
        model.set("soil.cohesion", 2000.0 - 1900.0 * share).unwrap();
        model.set("soil.friction_angle", 0.6 - 0.3 * share).unwrap();
        model.start().unwrap()
    };
    (0..count).map(run).collect()
}

fn torques(count: usize, turn: u64) -> Vec<f64> {
    (0..2 * count).map(|k| 1.0 + ((k as u64 * 7 + turn * 3) % 11) as f64 * 0.1).collect()
}

fn signals(run: &Run) -> Vec<f64> {
    let mut row = Vec::new();
    run.signals().values(&mut |value| row.push(value));
    row
}

/// Steps a batch of `count` runs; signals after every step, and the statuses at the end.
fn stepped(count: usize, threads: usize, turns: u64) -> (Vec<Vec<f64>>, Vec<Status>) {
    let mut batch = Batch::new(runs(count), threads).unwrap();
    let mut out = vec![0.0; count * batch.signal_count()];
    let record = (0..turns).map(|turn| {
        batch.step(&torques(count, turn), STEPS, None).unwrap();
        batch.signals(&mut out);
        out.clone()
    });
    (record.collect(), batch.statuses().to_vec())
}

#[test]
fn property_any_number_of_threads_gives_the_bits_of_single_runs() {
    const COUNT: usize = 7;
    const TURNS: u64 = 150;
    let mut alone = runs(COUNT);
    let (record, statuses) = stepped(COUNT, 1, TURNS);
    for (turn, row) in (0..TURNS).zip(&record) {
        let torques = torques(COUNT, turn);
        let mut expected = Vec::new();
        for (run, inputs) in alone.iter_mut().zip(torques.chunks(2)) {
            run.inputs_mut().set_all(inputs).unwrap();
            run.advance(STEPS).unwrap();
            expected.extend(signals(run));
        }
        assert_eq!(*row, expected, "turn {turn}");
    }
    assert!(statuses.contains(&Status::Ended(Event::Stuck)) && statuses.contains(&Status::Running), "{statuses:?}");
    for threads in [2, 3, 4, COUNT, 4 * COUNT] {
        assert_eq!(stepped(COUNT, threads, TURNS), (record.clone(), statuses.clone()), "{threads} threads");
    }
}

#[test]
fn property_runs_that_are_not_active_stay_as_they_are() {
    let mut batch = Batch::new(runs(3), 2).unwrap();
    let before = batch.run(1);
    batch.step(&torques(3, 0), STEPS, Some(&[true, false, true])).unwrap();
    assert_eq!((batch.time(0), batch.time(1)), (0.02, 0.0));
    assert_eq!(signals(&batch.run(1)), signals(&before));
    // Nothing is asked of inputs that are not used.
    batch.step(&[1.0, 1.0, f64::NAN, f64::NAN, 1.0, 1.0], STEPS, Some(&[true, false, true])).unwrap();
}

#[test]
fn property_a_run_taken_out_goes_on_to_the_same_bits_and_can_be_put_back() {
    let mut batch = Batch::new(runs(3), 1).unwrap();
    batch.step(&torques(3, 0), STEPS, None).unwrap();
    let taken: Vec<Run> = (0..3).map(|k| batch.run(k)).collect();
    let after = |batch: &mut Batch| {
        (1..50).for_each(|turn| batch.step(&torques(3, turn), STEPS, None).unwrap());
        (0..3).map(|k| signals(&batch.run(k))).collect::<Vec<_>>()
    };
    let first = after(&mut batch);
    for (k, run) in taken.into_iter().enumerate() {
        batch.replace(k, run).unwrap();
    }
    assert_eq!(after(&mut batch), first);
}

#[test]
fn property_refused_inputs_move_nothing() {
    let mut batch = Batch::new(runs(2), 1).unwrap();
    let refused = batch.step(&[1.0, 1.0, 1.0, f64::NAN], STEPS, None).unwrap_err();
    assert!(matches!(&refused, BatchError::Input { index: 1, source: RunError::Parameter(_) }), "{refused}");
    assert!(refused.to_string().contains("wheel[2].torque_command"), "{refused}");
    let refused = batch.step(&[1.0; 3], STEPS, None).unwrap_err();
    assert_eq!(refused, BatchError::InputLength { got: 3, expected: 4 });
    let refused = batch.step(&[1.0; 4], STEPS, Some(&[true])).unwrap_err();
    assert_eq!(refused, BatchError::ActiveLength { got: 1, expected: 2 });
    assert_eq!((batch.time(0), batch.time(1)), (0.0, 0.0));
}

#[test]
fn property_refused_inputs_leave_every_run_with_the_inputs_that_it_had() {
    let mut batch = Batch::new(runs(2), 1).unwrap();
    batch.hold(&[1.0, 1.1, 1.2, 1.3], None).unwrap();
    batch.hold(&[2.0, 2.0, 2.0, f64::NAN], None).unwrap_err();
    batch.hold(&[2.0; 4], Some(&[true])).unwrap_err();
    let held = |batch: &Batch| {
        let mut held = Vec::new();
        (0..2).for_each(|k| batch.run(k).inputs().values(&mut |value| held.push(value)));
        held
    };
    assert_eq!(held(&batch), [1.0, 1.1, 1.2, 1.3]);
    let mut alone = runs(1).remove(0);
    alone.inputs_mut().set_all(&[1.0, f64::INFINITY]).unwrap_err();
    assert_eq!(alone.inputs(), runs(1)[0].inputs());
}

/// The short cut of [`bekker::model::Inputs::set_all`] took velocities up to the bound of torques, 1e4.
#[test]
fn regress_values_in_order_have_the_bounds_that_names_have() {
    for (preset, bound) in [("gentle_velocity", 10.0), ("two_wheeled", 1e4), ("two_wheeled_speed", 1e4)] {
        let mut run = Model::preset(preset).unwrap().start().unwrap();
        let names: Vec<String> = run.inputs_mut().list().into_iter().map(|(variable, _)| variable.name).collect();
        for (value, taken) in [(bound, true), (-bound, true), (1.001 * bound, false), (f64::NAN, false)] {
            assert_eq!(run.inputs_mut().set(&names[0], value).is_ok(), taken, "{preset}, {value}");
            let refused = run.inputs_mut().set_all(&vec![value; names.len()]);
            assert_eq!(refused.is_ok(), taken, "{preset}, {value}: {refused:?}");
        }
    }
}

#[test]
fn property_holding_and_advancing_is_a_step() {
    let (mut halves, mut whole) = (Batch::new(runs(3), 2).unwrap(), Batch::new(runs(3), 2).unwrap());
    // Before the first call of `hold` no run is selected.
    halves.advance(STEPS).unwrap();
    assert_eq!(halves.time(0), 0.0);
    for turn in 0..20 {
        let marks = [true, turn % 3 > 0, true];
        halves.hold(&torques(3, turn), Some(&marks)).unwrap();
        halves.advance(STEPS).unwrap();
        whole.step(&torques(3, turn), STEPS, Some(&marks)).unwrap();
    }
    let [mut first, mut second] = [(); 2].map(|()| vec![0.0; 3 * whole.signal_count()]);
    halves.signals(&mut first);
    whole.signals(&mut second);
    assert_eq!(first, second);
}

#[test]
fn property_runs_of_other_structure_are_refused() {
    let other = || Model::preset("rocker_bogie").unwrap().start().unwrap();
    let speeds = || Model::preset("two_wheeled_speed").unwrap().start().unwrap();
    let mut both = runs(1);
    both.push(other());
    assert_eq!(Batch::new(both, 1).unwrap_err(), BatchError::Structure { index: 1 });
    let mut batch = Batch::new(runs(2), 1).unwrap();
    assert_eq!(batch.replace(1, speeds()).unwrap_err(), BatchError::Structure { index: 1 });
    assert_eq!(Batch::new(Vec::new(), 1).unwrap_err(), BatchError::Empty);
    assert_eq!(Batch::new(runs(1), 0).unwrap_err(), BatchError::NoThreads);
}

#[test]
fn property_a_run_that_fails_shows_its_error_and_the_others_go_on() {
    // A force that has no value from 0.1 m on, for the run that has this effect.
    let effect = r#"
        [[effect]]
        id = "cliff"
        target = "body.force_x"
        expression = "share * sqrt(0.1 - share * travelled)"
        parameters = { share = { neutral = 0.0, min = 0.0, max = 1.0, unit = "1" } }
    "#;
    let mut model = Model::preset("two_wheeled").unwrap();
    model.add_effects(effect).unwrap();
    let good = model.start().unwrap();
    model.set("cliff.share", 1.0).unwrap();
    let mut batch = Batch::new(vec![good.clone(), model.start().unwrap(), good], 2).unwrap();
    (0..100).for_each(|_| batch.step(&[1.5; 6], STEPS, None).unwrap());
    let error = batch.error(1).map(ToString::to_string).unwrap_or_default();
    assert!(error.contains("cliff"), "{error}");
    assert!(batch.error(0).is_none() && batch.error(2).is_none());
    assert_eq!(batch.statuses(), [Status::Running; 3]);
    assert!(batch.time(1) < 2.0 && batch.time(0) == 2.0 && batch.time(2) == 2.0);
}
