//! Claim: after the first commands, a command of a controller allocates nothing of its own; Clarabel
//! allocates once a solution (it resets its timers), and nothing else.

mod control_support;
#[path = "support/counting.rs"]
mod counting;

use bekker::control::{
    Controller, EqualTorque, EqualTorqueController, Rtc, RtcOptions, SlipControl, SlipController, Solver,
    VelocityControl, VelocityController,
};
use bekker::model::Model;
use bekker::signals::{Command, Measurement, Reference};
use control_support::Case;
/// Allocations of one command after ten others.
fn allocations(controller: &mut dyn Controller, measured: &Measurement, goal: &Reference) -> usize {
    let mut command = Command::torque(vec![0.0; measured.wheels.len()]);
    for _ in 0..10 {
        controller.command(measured, goal, &mut command).expect("finite readings");
    }
    counting::allocations(|| controller.command(measured, goal, &mut command).expect("finite readings"))
}

#[test]
fn property_commands_allocate_nothing_of_their_own() {
    for wheels in [2, 6] {
        for seed in 0..40 {
            let mut case = Case::random(seed, wheels);
            let (measured, goal) = (case.measurement(), case.reference());
            let mut velocity = VelocityController::new(&case.nominal, VelocityControl::default()).expect("valid");
            assert_eq!(allocations(&mut velocity, &measured, &goal), 0);
            for switch_angle in [1.6, 0.0] {
                case.parameters.switch_angle = switch_angle;
                let mut rtc = Rtc::new(case.nominal.clone(), case.parameters).expect("valid");
                let count = allocations(&mut rtc, &measured, &goal);
                let outcome = rtc.outcome().expect("commanded");
                // Minimum power, then the linear programs and the cheapest of the best, or up to two for the nearest.
                let solutions = if outcome.feasible { 1 + outcome.steps + usize::from(outcome.steps > 0) } else { 3 };
                assert!(count <= solutions, "{count} allocations, {solutions} solutions in {case:?}");
            }
        }
    }
}

#[test]
fn property_the_active_set_and_the_baselines_allocate_nothing() {
    for seed in 0..60 {
        let wheels = 3 + seed as usize % 6;
        let mut case = if seed % 3 == 0 { Case::tipping(seed, wheels) } else { Case::jointed(seed, wheels) };
        let (measured, goal) = (case.measurement(), case.reference());
        let mut equal = EqualTorqueController::new(&case.nominal, EqualTorque::default()).expect("valid");
        assert_eq!(allocations(&mut equal, &measured, &goal), 0);
        case.parameters.switch_angle = if seed % 2 == 0 { 1.6 } else { 0.0 };
        case.parameters.speed_kp = 0.5;
        let options = RtcOptions { solver: Solver::ActiveSet, ..RtcOptions::default() };
        let mut rtc = Rtc::with_options(case.nominal.clone(), case.parameters, options).expect("valid");
        assert_eq!(allocations(&mut rtc, &measured, &goal), 0, "{case:?}");
        let (parameters, gains) = (SlipControl::default(), VelocityControl::default());
        let mut slip = SlipController::new(case.nominal.clone(), parameters, gains).expect("valid");
        let mut command = Command::torque(vec![0.0; wheels]);
        let mut step = || {
            slip.reveal((0..wheels).map(|_| 0.1));
            slip.command(&measured, &goal, &mut command).expect("finite readings");
        };
        step();
        assert_eq!(counting::allocations(step), 0);
    }
}

#[test]
fn property_a_closed_loop_allocates_nothing() {
    for preset in ["gentle_rtc", "rocker_bogie_velocity"] {
        for kind in ["rtc", "slip", "equal_torque", "velocity_tuned"] {
            let text = format!("preset = '{preset}'\n[control]\nkind = '{kind}'\nsolver = 'active_set'\n");
            let mut run = Model::from_toml(&text, None).expect("a model").start().expect("a start");
            run.advance(100).expect("a drive");
            assert_eq!(counting::allocations(|| assert!(run.advance(100).is_ok())), 0, "{preset} by {kind}");
        }
    }
}

#[test]
fn property_estimators_in_the_loop_allocate_nothing() {
    for preset in ["gentle_rtc", "rocker_bogie_velocity"] {
        let text = format!(
            "preset = '{preset}'\n[control]\nkind = 'rtc'\nsolver = 'active_set'\nsoil = 'estimator'\n\
             contact_angles = 'estimator'\n"
        );
        let mut run = Model::from_toml(&text, None).expect("a model").start().expect("a start");
        run.advance(200).expect("a drive");
        assert_eq!(counting::allocations(|| assert!(run.advance(500).is_ok())), 0, "{preset}");
    }
}
