//! Reads the description of an FMU with `fmi-schema`, loads and steps it with `fmi`, and prints what came out.
//!
//! `bekker-fmu-judge FMU STEP COUNT SETS GETS`: the communication step (s), how many of them, and value references separated by
//! commas, of inputs and parameters to set before the start (`REFERENCE=VALUE`) and of outputs to read at the end. The lines it
//! prints: `unknowns N` and `dependent N`, the outputs and those of them with dependencies that the schema has read; `kept A B
//! NAME`, how many elements or attributes of a kind are left after reading and writing the description with the schema's
//! types (A of B), or `refused REASON`; and `values`, with the bits of the outputs as hexadecimal numbers.

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::{CoSimulation as CoSimulation2, Common as Common2};
use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::{CoSimulation, Common, Fmi3Model, GetSet};
use fmi::import;
use fmi::schema::fmi3::ModelStructure;
use fmi::schema::traits::FmiModelDescription;
use fmi::schema::{MajorVersion, fmi2, fmi3};
use fmi::traits::FmiImport;
use std::error::Error;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// What a drive is.
struct Drive {
    step: f64,
    count: u32,
    sets: Vec<(u32, f64)>,
    gets: Vec<u32>,
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [fmu, step, count, sets, gets] = arguments.as_slice() else {
        return Err("expected FMU STEP COUNT SETS GETS".into());
    };
    let set = |text: &str| -> Outcome<(u32, f64)> {
        let (reference, value) = text.split_once('=').ok_or("expected REFERENCE=VALUE")?;
        Ok((reference.parse()?, value.parse()?))
    };
    let parts = |text: &str| text.split(',').filter(|part| !part.is_empty()).map(str::to_owned).collect::<Vec<_>>();
    let drive = Drive {
        step: step.parse()?,
        count: count.parse()?,
        sets: parts(sets).iter().map(|text| set(text)).collect::<Outcome<_>>()?,
        gets: parts(gets).iter().map(|text| Ok(text.parse()?)).collect::<Outcome<_>>()?,
    };
    let values = match import::peek_descr_path(fmu)?.major_version()? {
        MajorVersion::FMI2 => second(fmu, &drive)?,
        MajorVersion::FMI3 => third(fmu, &drive)?,
        other => return Err(format!("FMI {other:?}: expected 2.0 or 3.0").into()),
    };
    let words: Vec<String> = values.iter().map(|value| format!("{:016x}", value.to_bits())).collect();
    println!("values {}", words.join(" "));
    Ok(())
}

/// FMI 2.0.
fn second(fmu: &str, drive: &Drive) -> Outcome<Vec<f64>> {
    let import: Fmi2Import = import::from_path(fmu)?;
    let unknowns = &import.model_description().model_structure.outputs.unknowns;
    let dependent = unknowns.iter().filter(|unknown| !unknown.dependencies.is_empty()).count();
    println!("unknowns {}\ndependent {dependent}", unknowns.len());
    let text = std::fs::read_to_string(import.archive_path().join("modelDescription.xml"))?;
    kept(&text, fmi2::Fmi2ModelDescription::deserialize(&text)?.serialize());
    let mut instance = import.instantiate_cs("judged", false, false)?;
    let (references, values): (Vec<u32>, Vec<f64>) = drive.sets.iter().copied().unzip();
    instance.setup_experiment(None, 0.0, None)?;
    instance.set_real(&references, &values)?;
    Common2::enter_initialization_mode(&mut instance)?;
    Common2::exit_initialization_mode(&mut instance)?;
    for step in 0..drive.count {
        instance.do_step(f64::from(step) * drive.step, drive.step, true)?;
    }
    let mut read = vec![0.0; drive.gets.len()];
    instance.get_real(&drive.gets, &mut read)?;
    Ok(read)
}

/// FMI 3.0.
fn third(fmu: &str, drive: &Drive) -> Outcome<Vec<f64>> {
    let import: Fmi3Import = import::from_path(fmu)?;
    let structure: &ModelStructure = &import.model_description().model_structure;
    let dependent =
        structure.outputs().filter(|unknown| unknown.dependencies.as_ref().is_some_and(|known| !known.0.is_empty()));
    println!("unknowns {}\ndependent {}", structure.outputs().count(), dependent.count());
    let text = std::fs::read_to_string(import.archive_path().join("modelDescription.xml"))?;
    kept(&text, fmi3::Fmi3ModelDescription::deserialize(&text)?.serialize());
    let mut instance = import.instantiate_cs("judged", false, false, false, false, &[])?;
    let (references, values): (Vec<u32>, Vec<f64>) = drive.sets.iter().copied().unzip();
    instance.set_float64(&references, &values)?;
    instance.enter_initialization_mode(None, 0.0, None)?;
    instance.exit_initialization_mode()?;
    for step in 0..drive.count {
        let (mut event, mut end, mut early, mut reached) = (false, false, false, 0.0);
        let now = f64::from(step) * drive.step;
        instance.do_step(now, drive.step, true, &mut event, &mut end, &mut early, &mut reached)?;
    }
    let mut read = vec![0.0; drive.gets.len()];
    instance.get_float64(&drive.gets, &mut read)?;
    Ok(read)
}

/// Elements and attributes that a modeller misses where they are lost.
const COUNTED: [(&str, &str); 6] = [
    ("units", "<Unit "),
    ("base units", "<BaseUnit"),
    ("lower bounds", " min="),
    ("variables' units", " unit="),
    ("items of enumerations", "<Item "),
    ("dependencies", " dependencies="),
];

/// How much of a description is left after the schema's types have read and written it.
fn kept(before: &str, after: Result<String, impl std::fmt::Display>) {
    match after {
        Ok(after) => {
            for (name, text) in COUNTED {
                println!("kept {} {} {name}", after.matches(text).count(), before.matches(text).count());
            }
        }
        Err(error) => println!("refused {error}"),
    }
}
