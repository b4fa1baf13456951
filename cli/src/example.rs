//! The experiment that travels with the program, so that the demo and the workbench have it wherever that is installed.

/// Files of `examples/sand_wheel`: their names in the folder and their texts.
pub const FILES: &[(&str, &str)] = &include!(concat!(env!("OUT_DIR"), "/sand_wheel.rs"));
