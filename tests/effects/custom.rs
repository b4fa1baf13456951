//! Effects of the user's own: they act like those of the library, with exact derivatives, and bad ones are refused.

use bekker::diagnosis::{Rig, SteadyError, steady_point};
use bekker::effects::custom::{CustomEffect, Derivatives, EffectDefinition};
use bekker::model::{Model, Run};
use bekker::modeldescription::{Lookup, Parameters, Role};
use bekker::scalar::Dual;
use std::fmt::Write;

/// Exact derivatives against central differences of step 1e-5: their truncation error, relative to the scale.
const DIFFERENCE: f64 = 1e-7;
const STEP: f64 = 1e-5;
/// An expression against the same one in Rust, after it was added to a force of some newtons: rounding.
const ROUNDING: f64 = 1e-13;
/// The soil carries the load to 1e-12 of it.
const BALANCE: f64 = 1e-11;

const CABLE: &str = "[[effect]]\nid = 'cable'\nabout = 'A cable that pays out'\ntarget = 'body.force_x'\n\
    expression = '-k * max(travelled, 0)'\nparameters = { k = { neutral = 0, min = 0, max = 10, unit = 'N/m' } }\n";
const GREASE: &str = "[[effect]]\nid = 'grease'\ntarget = 'drive.friction'\nexpression = 'b * speed'\n\
    parameters = { b = { neutral = 0, min = 0, max = 5, unit = 'N m s/rad' } }\n";
const DIGGING: &str = "[[effect]]\nid = 'digging'\ntarget = 'soil.exponent'\nmode = 'add'\n\
    expression = 'n1 * min(abs(slip), 1)'\nparameters = { n1 = { neutral = 0, min = 0, max = 1.5 } }\n";

/// Whether a name stands in an expression.
fn uses(expression: &str, name: &str) -> bool {
    expression.split(|c: char| !c.is_ascii_alphanumeric()).any(|word| word == name)
}

/// One effect with parameters `a` and `b`, neutral at 0, between -10 and 10.
fn effect(target: &str, mode: &str, expression: &str) -> String {
    let mut text = format!("[[effect]]\nid = 'own'\ntarget = '{target}'\nexpression = '{expression}'\n");
    if !mode.is_empty() {
        writeln!(text, "mode = '{mode}'").unwrap();
    }
    for name in ["a", "b"].into_iter().filter(|name| uses(expression, name)) {
        writeln!(text, "parameters.{name} = {{ neutral = 0, min = -10, max = 10 }}").unwrap();
    }
    text
}

fn built(text: &str) -> CustomEffect {
    EffectDefinition::all_from_toml(text).unwrap().remove(0).build().unwrap()
}

fn model(preset: &str, effects: &str, values: &[(&str, f64)]) -> Model {
    let mut model = Model::preset(preset).unwrap();
    model.rover.soil.shear_modulus = 0.01;
    model.add_effects(effects).unwrap();
    values.iter().for_each(|(name, value)| model.set(name, *value).unwrap());
    model
}

fn rig(effects: &str, values: &[(&str, f64)]) -> Rig {
    Rig::of(&model("two_wheeled", effects, values).rover)
}

/// Whether two rigs measure the same, to what the search for the sinkage leaves.
fn same(one: &Rig, other: &Rig) -> bool {
    let [one, other] = [one, other].map(|rig| steady_point(rig, 40.0, 0.3, 0.5).unwrap());
    let pairs = [(one.drawbar_pull, other.drawbar_pull), (one.torque, other.torque), (one.sinkage, other.sinkage)];
    pairs.iter().all(|(a, b)| (a - b).abs() < BALANCE * b.abs())
}

/// All signals of a drive, sampled.
fn drive(model: &Model) -> Vec<f64> {
    let mut run = model.start().unwrap();
    let names: Vec<String> = run.inputs_mut().list().into_iter().map(|(variable, _)| variable.name).collect();
    for name in names {
        let value = if name.ends_with("torque_command") { 0.6 } else { 2.0 };
        run.inputs_mut().set(&name, value).unwrap();
    }
    let mut values = Vec::new();
    for _ in 0..20 {
        run.advance(50).unwrap();
        run.signals().values(&mut |value| values.push(value));
    }
    values
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn agreement_an_expression_is_the_librarys_effect_to_the_last_bit() {
    let cases = [
        ("two_wheeled_speed", CABLE, "cable.k", "tether.stiffness", 3.0),
        ("two_wheeled", GREASE, "grease.b", "viscous_friction.coefficient", 0.05),
        // As stiff as the bounds allow: the integrator needs the slope in the wheel speed.
        ("two_wheeled", GREASE, "grease.b", "viscous_friction.coefficient", 5.0),
        ("rocker_bogie_speed", DIGGING, "digging.n1", "slip_sinkage.n1", 0.4),
    ];
    for (preset, text, own, library, value) in cases {
        let (expression, built_in) =
            (drive(&model(preset, text, &[(own, value)])), drive(&model(preset, text, &[(library, value)])));
        assert_ne!(bits(&built_in), bits(&drive(&model(preset, text, &[]))), "{library} shows");
        assert_eq!(bits(&expression), bits(&built_in), "{own} and {library}");
    }
}

#[test]
fn property_neutral_effects_change_nothing() {
    let mut all = String::new();
    let targets = [
        ("body.force_x", "", "a * velocity"),
        ("contact.normal_force", "", "a * normal_force"),
        ("contact.drawbar_pull", "", "a * sin(b * x)"),
        ("contact.torque", "", "a * torque"),
        ("drive.friction", "", "a * tanh(speed)"),
        ("soil.cohesion", "factor", "exp(a * slip)"),
        ("soil.friction_angle", "add", "a * contact_angle"),
        ("soil.k_c", "add", "a"),
        ("soil.k_phi", "factor", "1 + a * x"),
        ("soil.exponent", "add", "a * slip"),
        ("soil.shear_modulus", "factor", "1 + a * sinkage"),
        ("soil.c1", "add", "a"),
        ("soil.c2", "add", "a"),
        ("soil.damping", "factor", "1 + a"),
        ("wheel.radius", "factor", "1 + a / wheel"),
        ("wheel.width", "add", "a * normal_velocity"),
    ];
    for (k, (target, mode, expression)) in targets.into_iter().enumerate() {
        all += &effect(target, mode, expression).replace("'own'", &format!("'own{k}'"));
    }
    for preset in ["two_wheeled", "gentle_velocity", "rocker_bogie_speed"] {
        let with = model(preset, &all, &[]);
        assert_eq!(with.rover.effects.custom.iter().count(), targets.len());
        assert_eq!(bits(&drive(&with)), bits(&drive(&model(preset, CABLE, &[]))), "{preset}");
    }
    let point = |effects| steady_point(&rig(effects, &[]), 40.0, 0.3, 0.5).unwrap();
    assert_eq!(point(&all), point(CABLE));
}

#[test]
fn property_every_target_shows() {
    let names = |target: &str| if target.starts_with("contact") { "a * normal_force" } else { "a" };
    let targets = ["body.force_x", "contact.normal_force", "contact.drawbar_pull", "contact.torque", "drive.friction"];
    for target in targets {
        let text = effect(target, "", names(target));
        let shown = steady_point(&rig(&text, &[("own.a", 0.1)]), 40.0, 0.3, 0.5).unwrap();
        assert_ne!(shown, steady_point(&rig(&text, &[]), 40.0, 0.3, 0.5).unwrap(), "{target}");
    }
    // A factor or an addition is the same as another parameter. (c1 and c2 are small enough to be added to.)
    for name in [
        "soil.cohesion",
        "soil.friction_angle",
        "soil.k_c",
        "soil.k_phi",
        "soil.exponent",
        "soil.shear_modulus",
        "soil.c1",
        "soil.c2",
        "wheel.width",
    ] {
        let factor = rig(&effect(name, "factor", "1 + a"), &[("soil.k_c", 100.0), ("own.a", 0.25)]);
        let mut plain = rig(CABLE, &[("soil.k_c", 100.0)]);
        let (old, new) = (plain.get(name).unwrap(), plain.get(name).unwrap() * 1.25);
        plain.set(name, new).unwrap();
        assert!(same(&factor, &plain), "{name} by a factor");
        let added = rig(&effect(name, "add", &format!("a * {old}")), &[("soil.k_c", 100.0), ("own.a", 0.25)]);
        plain.set(name, old + 0.25 * old).unwrap();
        assert!(same(&added, &plain), "{name} added to");
    }
}

#[test]
fn property_the_ground_never_pulls() {
    let model = model("two_wheeled", &effect("contact.normal_force", "", "a * 1000"), &[]);
    let mut run = model.start().unwrap();
    run.advance(10).unwrap();
    let mut pulled = model.clone();
    pulled.set("own.a", -10.0).unwrap();
    let mut simulation =
        bekker::simulation::Simulation::from_state(pulled.rover.clone(), run.simulation().state().clone(), 0.002)
            .unwrap();
    simulation.advance(&bekker::signals::Command::torque(vec![0.0; 2]), 1).unwrap();
    assert!(simulation.signals().wheels.iter().all(|wheel| wheel.normal_force == 0.0));
}

/// Force on the carriage, N, that an expression in a, b and the velocity adds.
fn force(expression: &str, a: f64, b: f64) -> f64 {
    let text = effect("body.force_x", "", expression);
    let used = |name: &str| uses(expression, name);
    let values: Vec<(&str, f64)> =
        [("own.a", a, used("a")), ("own.b", b, used("b"))].into_iter().filter(|v| v.2).map(|v| (v.0, v.1)).collect();
    let pull = |values: &[(&str, f64)]| steady_point(&rig(&text, values), 40.0, 0.2, 0.5).unwrap().drawbar_pull;
    pull(&values) - pull(&[])
}

#[test]
fn analytic_expressions_mean_what_they_mean_in_mathematics() {
    // The velocity of the carriage is r omega (1 - i) = 0.1 x 0.5 x 0.8.
    let v = 0.04_f64;
    let cases = [
        ("a * -2 ^ 2", -4.0),
        ("a * 2 ^ 3 ^ 2 / 100", 5.12),
        ("a * 2 ^ -1", 0.5),
        ("a * (7 - 2 - 1)", 4.0),
        ("a * 12 / 2 / 3", 2.0),
        ("a * (1 + 2 * 3)", 7.0),
        ("- - a * +3", 3.0),
        ("a*(.5+1.+2e-1+1E+0)", 2.7),
        ("a * (-velocity) ^ 3", -v * v * v),
        ("a * (-3) ^ -2", 1.0 / 9.0),
        ("a * abs(velocity) ^ 0.5", v.sqrt()),
        ("a * abs(velocity) ^ b * 1000", 1000.0 * v * v),
        ("a * abs(-velocity) + a*sign(-velocity) + a*sign(0)", v - 1.0),
        ("a * ( sqrt(4) + exp(velocity) + ln(2) )", 2.0 + v.exp() + 2.0_f64.ln()),
        ("a * (sin(1) + cos(1) + tan(1) + tanh(1))", 1.0_f64.sin() + 1.0_f64.cos() + 1.0_f64.tan() + 1.0_f64.tanh()),
        ("a * (asin(0.3) + acos(0.3) + atan(3))", 0.3_f64.asin() + 0.3_f64.acos() + 3.0_f64.atan()),
        ("a * (min(1, velocity) + max (1 , velocity) + pi)", 1.0 + v + std::f64::consts::PI),
        ("a * 0 ^ 0 + a * 0 ^ 1.5 + a * sqrt(0)", 1.0),
    ];
    for (expression, expected) in cases {
        let value = force(expression, 1.0, 2.0);
        // The difference of two drawbar pulls of a few newtons.
        assert!(
            (value - expected).abs() < 100.0 * ROUNDING * expected.abs().max(1.0),
            "{expression}: {value}, {expected}"
        );
    }
}

/// Drawbar pull, torque and sinkage, and their exact derivatives in a and b.
fn exact(text: &str, a: f64, b: f64, slip: f64) -> [(f64, [f64; 2]); 3] {
    let mut rig = rig(text, &[]).map(&Dual::<2>::from);
    rig.visit("", &mut |variable, value| match variable.name.as_str() {
        "own.a" => *value = Dual::from(a).derivative(0),
        "own.b" => *value = Dual::from(b).derivative(1),
        _ => {}
    });
    let point = steady_point(&rig, 40.0, slip, 0.5).unwrap();
    let parts = |x: Dual<2>| (x.re, x.eps.0.map_or([0.0; 2], |d| [d[0], d[1]]));
    [parts(point.drawbar_pull), parts(point.torque), parts(point.sinkage)]
}

#[test]
fn agreement_derivatives_are_those_of_differences() {
    let smooth = Derivatives::Exact;
    let kinked = Derivatives::ExactBesideKinks;
    let cases = [
        ("body.force_x", "", "a * tanh(b * velocity / 0.01)", smooth),
        ("body.force_x", "", "a * (velocity ^ 2) ^ b / (1 + b)", smooth),
        ("body.force_x", "", "a * (1 + velocity) ^ 2.5 * (b - 2) ^ 3", smooth),
        ("body.force_x", "", "a * sqrt(1 + b) - a * ln(1 + b) + a * exp(-b)", smooth),
        ("body.force_x", "", "a * sin(b) * cos(a) + tan(a * b)", smooth),
        ("body.force_x", "", "a * asin(b / 2) + a * acos(b / 3) + atan(a * b)", smooth),
        ("drive.friction", "", "a * tanh(b * speed)", smooth),
        ("contact.drawbar_pull", "", "-a * normal_force * sinkage * exp(-b * slip)", smooth),
        ("contact.normal_force", "", "a * torque * (1 + b * slip ^ 2)", smooth),
        ("contact.torque", "", "a * min(normal_force, 30 + b) * sign(velocity)", kinked),
        ("soil.k_phi", "factor", "exp(-a * abs(slip) * b)", kinked),
        ("soil.friction_angle", "add", "-a * max(b, slip) * 0.1", kinked),
        ("wheel.radius", "factor", "1 + 0.1 * a * b * sinkage", smooth),
    ];
    let (a, b) = (0.3, 0.7);
    for (target, mode, expression, derivatives) in cases {
        let text = effect(target, mode, expression);
        assert_eq!(built(&text).derivatives(), derivatives, "{expression}");
        for slip in [-0.2, 0.1, 0.5] {
            let here = exact(&text, a, b, slip);
            let value = |a, b, k: usize| exact(&text, a, b, slip)[k].0;
            for (k, (value_here, [exact_a, exact_b])) in here.into_iter().enumerate() {
                let by_a = (value(a + STEP, b, k) - value(a - STEP, b, k)) / (2.0 * STEP);
                let by_b = (value(a, b + STEP, k) - value(a, b - STEP, k)) / (2.0 * STEP);
                let scale = by_a.abs() + by_b.abs() + value_here.abs();
                let within = |x: f64, y: f64| (x - y).abs() < DIFFERENCE * scale;
                assert!(
                    within(exact_a, by_a) && within(exact_b, by_b),
                    "{expression} at {slip}, {k}: {:?} {by_a} {by_b}",
                    here[k]
                );
            }
        }
    }
}

#[test]
fn property_derivatives_stay_finite_at_the_ends_of_a_function() {
    let velocity = 0.04_f64;
    for (expression, by_a) in [
        // Full saturation, where cosh(2400) is beyond all numbers.
        ("tanh(a * 200000 * velocity)", 0.0),
        ("tanh(-a * 200000 * velocity)", 0.0),
        ("b * tanh(a * velocity)", velocity / (0.3 * velocity).cosh().powi(2)),
        // Infinite slopes are left out.
        ("a * velocity + sqrt(b - 1)", velocity),
        ("a * velocity + asin(b) - asin(1) * b", velocity),
        ("a * velocity + (b - 1) ^ 0.5", velocity),
    ] {
        let mut text = effect("body.force_x", "", expression);
        if uses(expression, "b") {
            text = text.replace("parameters.b = { neutral = 0", "parameters.b = { neutral = 1");
        }
        let (_, slopes) = exact(&text, 0.3, 1.0, 0.2)[0];
        assert!((slopes[0] - by_a).abs() < ROUNDING, "{expression}: {slopes:?}, {by_a}");
        assert!(slopes[1].is_finite(), "{expression}: {slopes:?}");
    }
}

#[test]
fn property_bad_definitions_are_refused_with_their_place() {
    let own = |expression: &str| effect("body.force_x", "", expression);
    let cases: Vec<(String, Vec<&str>)> = vec![
        (own("a * "), vec!["`own`", "character 5", "number, a name", "found the end"]),
        (own("a * velocity )"), vec!["character 14", "operator", "`)`"]),
        (own("a * (velocity + 1"), vec!["character 18", "`)`", "the end"]),
        (own("a * * velocity"), vec!["character 5", "`*`"]),
        (own("2 a"), vec!["character 3", "operator", "`a`"]),
        (own("a * 1e999"), vec!["character 5", "1e999", "finite"]),
        (own("a * slip"), vec!["character 5", "`slip`", "parameters a", "signals travelled, velocity"]),
        (own("a * exec(1)"), vec!["character 5", "function `exec`", "tanh"]),
        (own("a * sin"), vec!["unknown name `sin`"]),
        (own("a * max(1)"), vec!["character 10", "second argument of `max`"]),
        (own("a * sin(1, 2)"), vec!["character 10", "`)`", "`,`"]),
        (own("a; b"), vec!["character 2", "`;`"]),
        (own("a * µ"), vec!["character 5", "`µ`"]),
        (own("a + 1"), vec!["neutral", "is 1 where", "travelled", "expected 0"]),
        (effect("soil.k_phi", "factor", "a * slip"), vec!["0 where", "slip = -1", "expected 1"]),
        (own("a * ln(velocity)"), vec!["NaN", "velocity = -0.5"]),
        (own("a / velocity"), vec!["NaN", "velocity = 0"]),
        (own(&format!("a * {}1{}", "(".repeat(60), ")".repeat(60))), vec!["character 29", "24 deep"]),
        (own(&format!("a * {}1", "(".repeat(200_000))), vec!["200005 bytes", "at most 500"]),
        (own(&format!("a * {}1", "-".repeat(10_000))), vec!["at most 500"]),
        (own(&format!("{}a", "1^".repeat(80))), vec!["32 values"]),
        (own("velocity * 0"), vec!["missing field `parameters`"]),
        (own("a").replace("neutral = 0", "neutral = 20"), vec!["parameters.a", "neutral = 20", "-10 .. 10"]),
        (own("a").replace("neutral = 0", "neutral = nan"), vec!["parameters.a", "NaN"]),
        (own("a").replace("max = 10", "max = inf"), vec!["parameters.a", "inf", "finite"]),
        (own("a").replace("max = 10", "max = -10"), vec!["parameters.a", "min below max"]),
        (own("a").replace("max = 10", "max = 10, unit = 'furlong'"), vec!["`furlong`", "N/m", "kg"]),
        (own("a").replace("max = 10", "max = 10, colour = 1"), vec!["colour", "line"]),
        (own("a").replace("parameters.a", "parameters.A"), vec!["parameters.A", "small letter"]),
        (
            own("a * velocity").replace("parameters.a", "parameters.velocity"),
            vec!["parameters.velocity", "choose another"],
        ),
        (own("a").replace("parameters.a", "parameters.exp"), vec!["parameters.exp", "choose another"]),
        (own("a") + "parameters.idle = { neutral = 0, min = 0, max = 1 }\n", vec!["parameters.idle", "does not use"]),
        (own("a").replace("body.force_x", "body.force_y"), vec!["`body.force_y`", "body.force_x", "soil.k_phi"]),
        (effect("soil.k_phi", "", "a"), vec!["mode", "factor", "add"]),
        (effect("body.force_x", "factor", "1 + a"), vec!["mode", "only be added"]),
        (effect("soil.k_phi", "times", "a"), vec!["times", "factor"]),
        (own("a").replace("'own'", "'My Effect'"), vec!["`My Effect`", "small letter"]),
        (own("a").replace("'own'", "'tether'"), vec!["`tether`", "library"]),
        (own("a").replace("'own'", "'soil'"), vec!["`soil`", "taken"]),
        (own("a").replace("'own'", "'rtc'"), vec!["`rtc`", "taken"]),
        (own("a").replace("'own'", "'velocity_command'"), vec!["`velocity_command`", "taken"]),
        (own("a") + &own("a * 2"), vec!["`own`", "another effect"]),
        ("[[effects]]\nid = 'x'".to_owned(), vec!["effects", "effect"]),
    ];
    let untouched = Model::preset("gentle_velocity").unwrap();
    for (text, words) in cases {
        let mut model = untouched.clone();
        let message = model.add_effects(&text).expect_err(&text).to_string();
        for word in words {
            assert!(message.contains(word), "`{text}` gives `{message}`, without `{word}`");
        }
        assert!(message.len() < 1500, "a message to be read: {message}");
        assert_eq!(model.list(), untouched.clone().list(), "nothing is added by half");
    }
}

#[test]
fn property_no_text_makes_the_parser_fall_over() {
    let pieces = [
        "a", "velocity", "(", ")", "+", "-", "*", "/", "^", "sin(", "max(", ",", "1", "2.5e3", ".", "é", " ", "pi",
        "e", "_",
    ];
    let mut seed = 1_u64;
    let mut accepted = 0;
    for _ in 0..20_000 {
        let mut text = "a * (".to_owned();
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize
        };
        for _ in 0..1 + next() % 12 {
            text += pieces[next() % pieces.len()];
        }
        let toml = effect("body.force_x", "", &(text + ")"));
        accepted += usize::from(EffectDefinition::all_from_toml(&toml).unwrap().remove(0).build().is_ok());
    }
    assert!(accepted > 100, "some of them are expressions: {accepted}");
}

#[test]
fn property_values_without_a_meaning_end_the_run_with_a_clear_error() {
    let command = |model: &Model| -> Run {
        let mut run = model.start().unwrap();
        run.inputs_mut().set_all(&[2.0; 2]).unwrap();
        run
    };
    let root = effect("body.force_x", "", "ln(1 + a * travelled)");
    let mut run = command(&model("two_wheeled_speed", &root, &[("own.a", -10.0)]));
    let message = run.advance(2000).unwrap_err().to_string();
    for word in ["at t = ", "`own`", "body.force_x", "NaN", "travelled = 0.1", "own.a = -10", "finite"] {
        assert!(message.contains(word), "{message}: {word}");
    }
    assert!(run.signals().body.x < 0.11, "the state is that of the last good step");
    let friction = effect("drive.friction", "", "exp(a * abs(speed) * 100) - 1");
    let message =
        command(&model("two_wheeled_speed", &friction, &[("own.a", 10.0)])).advance(10).unwrap_err().to_string();
    assert!(
        message.contains("drive.friction") && message.contains("inf") && message.contains("speed = 2"),
        "{message}"
    );
    let soil = effect("soil.shear_modulus", "factor", "1 - a * slip");
    let refused = steady_point(&rig(&soil, &[("own.a", 5.0)]), 40.0, 0.5, 0.5).unwrap_err();
    assert!(matches!(refused, SteadyError::Effect(_)));
    for word in ["soil.shear_modulus would be -0.0", "slip = 0.5", "more than 0"] {
        assert!(refused.to_string().contains(word), "{refused}: {word}");
    }
    assert!(steady_point(&rig(&soil, &[("own.a", 1.0)]), 40.0, 0.5, 0.5).is_ok());
}

#[test]
fn property_their_parameters_are_in_the_vocabulary() {
    let mut model = model("two_wheeled", &(CABLE.to_owned() + GREASE), &[("cable.k", 2.5)]);
    let listed = model.list();
    let (variable, value) = listed.iter().find(|(variable, _)| variable.name == "cable.k").unwrap();
    assert_eq!((variable.unit.symbol, variable.role, variable.default, *value), ("N/m", Role::Effect, 0.0, 2.5));
    assert!(model.set("cable.k", 11.0).unwrap_err().to_string().contains("0 .. 10 N/m"));
    let grease = listed.iter().find(|(variable, _)| variable.name == "grease.b").unwrap();
    assert_eq!(grease.0.unit.symbol, "N.m.s/rad");
    let ids: Vec<String> = model.rover.effects.list().into_iter().map(|(id, _)| id).collect();
    assert!(ids.ends_with(&["cable".to_owned(), "grease".to_owned()]) && ids.contains(&"tether".to_owned()));
}

#[test]
fn property_a_model_file_keeps_them() {
    let original = model("rocker_bogie", &(DIGGING.to_owned() + CABLE), &[("cable.k", 1.0 / 3.0), ("digging.n1", 0.2)]);
    let text = original.to_toml().unwrap();
    let mut again = Model::from_toml(&text, None).unwrap();
    assert_eq!(again.rover.effects, original.rover.effects);
    assert_eq!(again.list(), original.clone().list());
    assert_eq!(again.to_toml().unwrap(), text);
    assert_eq!(bits(&drive(&again)), bits(&drive(&original)));
    again.add_effects(CABLE).unwrap();
    assert_eq!(again.get("cable.k"), Ok(1.0 / 3.0), "the same definition again changes nothing");
    let refused = Model::from_toml(&CABLE.replace("travelled", "slip"), None).unwrap_err().to_string();
    assert!(refused.contains("`cable`") && refused.contains("unknown name `slip`"), "{refused}");
}

#[test]
fn property_the_example_file_acts() {
    let text = include_str!("../../examples/own_effects.toml");
    let start = [("x0", 2.5)];
    let none = bits(&drive(&model("two_wheeled", text, &start)));
    let own = model("two_wheeled", text, &start);
    for effect in own.rover.effects.custom.iter() {
        let free = effect.definition().parameters.iter().find(|(_, parameter)| parameter.free).unwrap();
        let name = format!("{}.{}", effect.id(), free.0);
        let on = drive(&model("two_wheeled", text, &[start[0], (&name, 0.2 * free.1.max)]));
        assert_ne!(bits(&on), none, "{name}");
    }
}
