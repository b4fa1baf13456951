//! A wheel on a carriage as a model: the steady points of the core, at any step, under parameters that change.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod core_support;

use bekker::carriage::SetPoint;
use bekker::model::Model as RoverModel;
use bekker::modeldescription::Lookup;
use bekker_fmu::Kind;
use bekker_modeldescription::xml::{Causality, Variability};
use core_support::{all, bits, get, loaded, set};

const RIG: &str = "name = \"wheel\"\n[rig]\nkind = \"carriage\"\n[parameters]\nwheel.radius = 0.058\nwheel.width = 0.05\n\
                   soil.exponent = 1.1\nsoil.k_phi = 1.5e6\nslip_sinkage.n1 = 0.3\n";

fn rig() -> RoverModel {
    RoverModel::from_toml(RIG, None).unwrap()
}

#[test]
fn agreement_outputs_are_the_steady_points_of_the_core() {
    let model = rig();
    let mut fmu = loaded(&model, Kind::Carriage);
    fmu.start().unwrap();
    for (k, (load, slip, wheel_speed)) in
        [(10.0, 0.2, 0.5), (20.0, -0.1, 0.5), (15.0, 0.6, -0.7)].into_iter().enumerate()
    {
        for (name, value) in [("load", load), ("slip", slip), ("wheel_speed", wheel_speed)] {
            set(&mut *fmu, name, value);
        }
        fmu.advance_to(0.37 * (k + 1) as f64).unwrap();
        let point = model.rig().at(&SetPoint { load, slip, wheel_speed }).unwrap();
        let outputs = ["drawbar_pull", "torque", "sinkage"].map(|name| get(&*fmu, name));
        assert_eq!(outputs, [point.drawbar_pull, point.torque, point.sinkage]);
    }
    // A parameter changes between two steps.
    set(&mut *fmu, "soil.cohesion", 2500.0);
    fmu.advance(3).unwrap();
    let mut other = rig();
    other.set("soil.cohesion", 2500.0).unwrap();
    let point = other.rig().at(&SetPoint { load: 15.0, slip: 0.6, wheel_speed: -0.7 }).unwrap();
    assert_eq!(get(&*fmu, "drawbar_pull"), point.drawbar_pull);
}

#[test]
fn property_every_parameter_can_be_set_and_all_goes_back() {
    let mut fmu = loaded(&rig(), Kind::Carriage);
    let parameters = all(&*fmu, Causality::Parameter);
    assert_eq!(parameters.len(), rig().list().len());
    assert!(parameters.iter().all(|at| fmu.description().entries[*at].variability == Variability::Tunable));
    fmu.start().unwrap();
    let start = bits(&*fmu);
    set(&mut *fmu, "load", 25.0);
    set(&mut *fmu, "wheel.width", 0.07);
    fmu.advance(1).unwrap();
    let (there, bytes) = (bits(&*fmu), fmu.serialise().unwrap());
    assert_ne!(start, there);
    fmu.reset();
    fmu.start().unwrap();
    assert_eq!(bits(&*fmu), start);
    fmu.deserialise(&bytes).unwrap();
    assert_eq!((bits(&*fmu), fmu.elapsed()), (there, 0.01));
    assert!(fmu.deserialise(&bytes[..bytes.len() - 1]).is_err());
}

#[test]
fn property_what_has_no_steady_point_is_a_failure_in_words() {
    let mut fmu = loaded(&rig(), Kind::Carriage);
    fmu.start().unwrap();
    set(&mut *fmu, "load", 1e5);
    let sunk = fmu.advance(1).unwrap_err().to_string();
    assert!(sunk.contains("the wheel sinks to its axle"), "{sunk}");
    set(&mut *fmu, "load", 10.0);
    set(&mut *fmu, "slip", 2.0);
    let slip = fmu.advance(1).unwrap_err().to_string();
    assert!(slip.contains("slip") && slip.contains('2'), "{slip}");
    set(&mut *fmu, "slip", 0.2);
    fmu.advance(1).unwrap();
    for (model, kind) in [(rig(), Kind::Rover), (RoverModel::preset("two_wheeled").unwrap(), Kind::Carriage)] {
        let refused = bekker_fmu::describe_as(&model, kind).unwrap_err();
        assert!(refused.contains("carriage"), "{refused}");
    }
}
