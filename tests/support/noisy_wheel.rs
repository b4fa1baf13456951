//! A wheel on a carriage with noise, as a folder.

use bekker::diagnosis::{Rig, steady_point};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt::Write;
use std::path::Path;

/// Noise of each signal, as a share of its largest value.
const NOISE: f64 = 0.01;

const SLIPS: [f64; 8] = [0.02, 0.08, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65];

pub fn model() -> Model {
    Model::preset("two_wheeled").unwrap()
}

/// A wheel of this width (m) on the default soil, `stiffer` by a factor, with `n1` of slip-sinkage, measured three times under two loads.
pub fn wheel_on(folder: &str, name: &str, width: f64, n1: f64, settings: &str, stiffer: f64) -> Experiment {
    wheel_with(folder, name, width, settings, &[("slip_sinkage.n1", 0.0, n1), ("soil.k_phi", stiffer, 0.0)])
}

/// A wheel of this width (m), measured three times under two loads. `changes` has names of parameters, each with a factor on the model's value and
/// what is added to the product.
pub fn wheel_with(folder: &str, name: &str, width: f64, settings: &str, changes: &[(&str, f64, f64)]) -> Experiment {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME")).join(folder).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64((width * 1e4) as u64);
    let mut rig = Rig::of(&model().rover);
    rig.wheel.width = width;
    for (parameter, times, more) in changes {
        let value = rig.get(parameter).unwrap();
        rig.set(parameter, times * value + more).unwrap();
    }
    let mut toml =
        format!("name = \"{name}\"\nkind = \"single_wheel\"\n[parameters]\n\"wheel.width\" = {width}\n{settings}\n");
    for load in [25.0, 50.0] {
        for repeat in ["a", "b", "c"] {
            let mut csv = "load,slip,wheel_speed,drawbar_pull,torque,sinkage\n".to_owned();
            for slip in SLIPS {
                let point = steady_point(&rig, load, slip, 0.5).unwrap();
                let mut noisy = |value: f64, size: f64| {
                    let draw: f64 = StandardNormal.sample(&mut rng);
                    value + NOISE * size * draw
                };
                let (pull, torque, sinkage) =
                    (noisy(point.drawbar_pull, 20.0), noisy(point.torque, 2.0), noisy(point.sinkage, 0.02));
                writeln!(csv, "{load},{slip},0.5,{pull:.9e},{torque:.9e},{sinkage:.9e}").unwrap();
            }
            let file = format!("load{load}_{repeat}.csv");
            std::fs::write(folder.join(&file), csv).unwrap();
            writeln!(toml, "[[run]]\nfile = \"{file}\"\ngroup = \"load{load}\"").unwrap();
        }
    }
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    Experiment::read(folder).unwrap()
}
