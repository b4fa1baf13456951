//! The core's own drive, for `test_agreement.py`: `core_drive MODEL.toml COMMANDS STEPS`. Every line of COMMANDS holds
//! the inputs of STEPS inner steps as bits in hexadecimal; out come time and signals in the same form, then the status.

use bekker::model::{Model, Run};
use bekker::modeldescription::Parameters;
use bekker::simulation::Status;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [model, commands, steps] = arguments.as_slice() else {
        return Err("expected MODEL.toml COMMANDS STEPS".into());
    };
    let steps: u64 = steps.parse()?;
    let mut run = Model::read(Path::new(model))?.start()?;
    print(&run);
    for line in std::fs::read_to_string(commands)?.lines() {
        let bits = line.split(' ').map(|word| u64::from_str_radix(word, 16).map(f64::from_bits));
        run.inputs_mut().set_all(&bits.collect::<Result<Vec<f64>, _>>()?)?;
        let status = run.advance(steps)?;
        print(&run);
        if let Status::Ended(event) = status {
            println!("{event}");
            break;
        }
    }
    Ok(())
}

fn print(run: &Run) {
    let mut line = format!("{:016x}", run.time().to_bits());
    run.signals().values(&mut |value| line += &format!(" {:016x}", value.to_bits()));
    println!("{line}");
}
