//! Claim: after the first commands, a command of a controller allocates nothing of its own; Clarabel
//! allocates once a solution (it resets its timers), and nothing else.

mod control_support;
#[path = "support/counting.rs"]
mod counting;

use bekker::control::{Controller, Rtc, VelocityControl, VelocityController};
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
