//! `bekker`: simulate rovers on soft soil, compare them with measurements, find the missing effect, package them as FMUs.

mod calibrate;
mod carriage;
mod check;
mod compare;
mod demo;
mod diagnose;
mod diagnosis_text;
mod example;
mod experiment;
mod experiments;
mod fmu;
mod ground;
mod import;
mod interrupt;
mod model;
mod output;
mod parameters;
mod plan;
mod pose;
mod progress;
mod reproduce;
mod saving;
mod separate;
mod simulate;
mod soil_from;
mod studio;
mod windows;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Rough-terrain rovers on deformable soil: simulate, compare with measurements, package as FMU.
#[derive(Parser)]
#[command(
    name = "bekker",
    version,
    about,
    before_help = "New here? `bekker studio` opens a page in the browser with a measured wheel whose model lacks one effect.",
    after_help = "Exit codes: 0 done, 1 the work failed or a value was refused, 2 the call could not be read, 130 interrupted twice, or before there was anything to tell."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Drive a rover, or load a wheel on a carriage, and write the signals as CSV.
    Simulate(simulate::Simulate),
    /// Run a model on the inputs of an experiment and see where it fails.
    Compare(compare::Compare),
    /// Find out which physical effect is missing from the model.
    Diagnose(diagnose::Diagnose),
    /// Fit a model's free parameters to an experiment.
    Calibrate(calibrate::Calibrate),
    /// See what an experiment, made or planned, can tell apart.
    Separate(separate::Separate),
    /// Open the workbench: a page in the browser on which a diagnosis is done by looking.
    Studio(studio::Studio),
    /// Plan an experiment: a run list to be recorded, and what it will be able to tell apart.
    Experiment(experiment::Experiment),
    /// Propose an experiment folder for CSV files: which column is which signal, in which unit.
    Import(import::Import),
    /// Drive scripted tests and compare what comes with what they expect: in the core, an FMU, the environment.
    Check(check::Check),
    /// Write a model as an FMU for other simulation tools.
    Fmu(fmu::Fmu),
    /// List the vocabulary: every parameter, input and signal of a model.
    Parameters(parameters::Parameters),
    /// Plan a path of a rover over an elevation map on which it stands, holds and can drive at every point.
    Plan(plan::Plan),
    /// Place a rover on an elevation map: pose, stability, thrust.
    Pose(pose::Pose),
    /// Compute the thesis's results and write them beside the published ones.
    Reproduce(reproduce::Reproduce),
    /// Chapter 4's rover under both controllers, an FMU, and the diagnosis of a wheel experiment.
    Demo(demo::Demo),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Simulate(command) => command.run(),
        Command::Compare(command) => command.run(),
        Command::Diagnose(command) => command.run(),
        Command::Calibrate(command) => command.run(),
        Command::Separate(command) => command.run(),
        Command::Studio(command) => command.run(),
        Command::Experiment(command) => command.run(),
        Command::Import(command) => command.run(),
        // Its exit codes are its own.
        Command::Check(command) => return command.run(),
        Command::Fmu(command) => command.run(),
        Command::Parameters(command) => command.run(),
        Command::Plan(command) => command.run(),
        Command::Pose(command) => command.run(),
        Command::Reproduce(command) => command.run(),
        Command::Demo(command) => command.run(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("bekker: {}", message(&error));
            ExitCode::FAILURE
        }
    }
}

/// The error and its causes; a cause that the text before it already holds is not said again.
fn message(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

/// A reader that has seen enough (`bekker parameters | head`) is no failure.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause.downcast_ref::<std::io::Error>().is_some_and(|io| io.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
