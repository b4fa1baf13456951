#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use super::{Plate, PlateError, SoilTest, TEST_EFFECTS, TestRig};
use crate::rover::Rover;
use crate::scalar::Dual;
use bekker_modeldescription::{Lookup, Parameters, Role};

/// Rounding of a few products.
const ROUNDING: f64 = 1e-12;
/// Differences over a thousandth of a range agree with exact derivatives to this share.
const DIFFERENCE: f64 = 1e-5;

/// LETE sand (Wong), under a plate of 12 cm.
fn sand() -> SoilTest {
    let mut test = SoilTest::of(&Rover::two_wheeled(), &TestRig::default());
    for (name, value) in [
        ("soil.k_c", 102e3),
        ("soil.k_phi", 5301e3),
        ("soil.exponent", 0.793),
        ("soil.cohesion", 1300.0),
        ("soil.friction_angle", 31.1_f64.to_radians()),
        ("soil.shear_modulus", 0.012),
        ("plate.diameter", 0.12),
        ("plate.speed", 0.02),
        ("soil_box.width", 0.4),
        ("soil_box.depth", 0.15),
        ("shear_box.speed", 0.003),
        ("moisture.content", 0.1),
    ] {
        test.set(name, value).unwrap();
    }
    test
}

/// What is measured at a few places.
fn measured(test: &SoilTest) -> Vec<f64> {
    let pressed = [0.0, 0.002, 0.01, 0.03].into_iter().flat_map(|z| [test.force(z), test.pressure(z)]);
    let sheared =
        [0.0, 0.002, 0.02, 0.1].into_iter().flat_map(|j| [test.shear_stress(j, 0.0), test.shear_stress(j, 8e3)]);
    pressed.chain(sheared).collect()
}

#[test]
fn analytic_formulas_of_bekker_and_of_janosi_and_hanamoto() {
    let test = sand();
    let pressure = (102e3 / 0.06 + 5301e3) * 0.02_f64.powf(0.793);
    assert!((test.pressure(0.02) / pressure - 1.0).abs() < ROUNDING);
    assert!((test.force(0.02) / (pressure * std::f64::consts::PI * 0.0036) - 1.0).abs() < ROUNDING);
    let stress = (1300.0 + 8e3 * 31.1_f64.to_radians().tan()) * (1.0 - (-0.02_f64 / 0.012).exp());
    assert!((test.shear_stress(0.02, 8e3) / stress - 1.0).abs() < ROUNDING);
    let mut square = test;
    for (name, value) in [("plate.diameter", 0.0), ("plate.width", 0.08), ("plate.length", 0.2)] {
        square.set(name, value).unwrap();
    }
    let pressure = (102e3 / 0.08 + 5301e3) * 0.02_f64.powf(0.793);
    assert!((square.force(0.02) / (pressure * 0.016) - 1.0).abs() < ROUNDING);
}

#[test]
fn property_a_plate_has_one_size() {
    let plate = |diameter, width, length| Plate { diameter, width, length, ..Plate::default() }.check();
    assert_eq!(plate(0.1, 0.0, 0.0), Ok(()));
    assert_eq!(plate(0.0, 0.1, 0.2), Ok(()));
    assert_eq!(plate(0.0, 0.0, 0.0), Err(PlateError::NoSize));
    assert_eq!(plate(0.1, 0.1, 0.2), Err(PlateError::TwoSizes));
    assert_eq!(plate(0.0, 0.2, 0.1), Err(PlateError::Turned));
}

#[test]
fn property_every_effect_is_neutral_by_default_and_shows_where_its_facts_say() {
    let plain = sand();
    assert_eq!(TEST_EFFECTS.len(), plain.rig.effects.facts().count());
    for (id, facts) in plain.rig.effects.facts() {
        assert!(TEST_EFFECTS.iter().any(|(known, about)| *known == id && !about.trim().is_empty()), "{id}");
        let mut on = plain.clone();
        for (name, value) in facts.typical {
            on.set(&format!("{id}.{name}"), *value).unwrap();
        }
        let (before, after) = (measured(&plain), measured(&on));
        let moved =
            |range: std::ops::Range<usize>| before[range.clone()].iter().zip(&after[range]).any(|(a, b)| a != b);
        assert_eq!(moved(0..8), facts.seen_in_soil_test.contains(&"force"), "{id}");
        assert_eq!(moved(8..16), facts.seen_in_soil_test.contains(&"shear_stress"), "{id}");
        assert!(after.iter().all(|value| value.is_finite()), "{id}");
        // Off again it leaves no trace, to the last bit.
        let mut off = on;
        let defaults: Vec<(String, f64)> = off
            .list()
            .into_iter()
            .filter(|(variable, _)| variable.role == Role::Effect && variable.name.starts_with(id))
            .map(|(variable, _)| (variable.name, variable.default))
            .collect();
        defaults.iter().for_each(|(name, value)| off.set(name, *value).unwrap());
        assert_eq!(measured(&off), before, "{id}");
    }
}

#[test]
fn property_derivatives_are_those_of_differences() {
    let mut test = sand();
    for (name, value) in [
        ("plate_size.exponent", 0.5),
        ("box_walls.strength", 3.0),
        ("box_bottom.strength", 4.0),
        ("box_bottom.reach", 2.0),
        ("box_bottom.growth", 0.5),
        ("rate.exponent", 0.1),
    ] {
        test.set(name, value).unwrap();
    }
    for (name, value) in [
        ("seating.offset", 0.002),
        ("shear_rate.exponent", 0.1),
        ("shear_softening.drop", 0.3),
        ("shear_play.displacement", 0.001),
        ("shear_play.rounding", 0.5),
    ] {
        test.set(name, value).unwrap();
    }
    let open: Vec<_> =
        test.list().into_iter().filter(|(v, _)| matches!(v.role, Role::Effect | Role::Calibrated)).collect();
    for (variable, value) in open {
        let step = 1e-3 * value.abs().max(1e-3 * (variable.max - variable.min));
        if value - step < variable.min || value + step > variable.max {
            continue;
        }
        let at = |value: f64| {
            let mut moved = test.clone();
            moved.set(&variable.name, value).unwrap();
            [moved.force(0.02), moved.shear_stress(0.02, 8e3)]
        };
        let mut dual = test.map(&|value| Dual::<1>::from(value));
        dual.visit("", &mut |other, place| {
            if other.name == variable.name {
                *place = Dual::from(value).derivative(0);
            }
        });
        let exact = [dual.force(0.02), dual.shear_stress(0.02, 8e3)].map(|x| x.eps.0.map_or(0.0, |all| all[0]));
        let (up, down) = (at(value + step), at(value - step));
        for k in 0..2 {
            let difference = (up[k] - down[k]) / (2.0 * step);
            let size = exact[k].abs().max(1e-9 * at(value)[k].abs() / step);
            assert!((difference - exact[k]).abs() <= DIFFERENCE * size, "{}: {difference} {}", variable.name, exact[k]);
        }
    }
}

#[test]
fn property_all_derivatives_at_neutral_effects_are_finite_in_every_row() {
    let mut test = sand();
    let names: Vec<String> =
        test.list().into_iter().filter(|(v, _)| v.role == Role::Effect).map(|(v, _)| v.name).collect();
    for some in names.chunks(8) {
        let mut dual = test.map(&|value| Dual::<8>::from(value));
        dual.visit("", &mut |variable, place| {
            if let Some(k) = some.iter().position(|name| *name == variable.name) {
                *place = Dual::from(place.re).derivative(k);
            }
        });
        for x in [0.0, 0.002, 0.02] {
            for value in [dual.force(x), dual.shear_stress(x, 8e3)] {
                let slopes = value.eps.0.map_or([0.0; 8], |all| std::array::from_fn(|k| all[k]));
                assert!(
                    value.re.is_finite() && slopes.iter().all(|slope| slope.is_finite()),
                    "{some:?} at {x}: {slopes:?}"
                );
            }
        }
    }
}

#[test]
fn analytic_play_rounds_its_corner_and_takes_the_same_displacement_in_the_end() {
    let mut test = sand();
    let (play, rounding) = (0.001, 0.5);
    test.set("shear_play.displacement", play).unwrap();
    let sharp = test.clone();
    test.set("shear_play.rounding", rounding).unwrap();
    assert_eq!(test.shear_stress(0.0, 8e3), 0.0);
    // Far behind the gaps j - j_0 + (w j_0)^2/(4 (j - j_0)) - j_0 (sqrt(1 + w^2) - 1)/2 is left.
    let far: f64 = 0.03;
    let gone = play * (f64::hypot(1.0, rounding) - 1.0) / 2.0 - (rounding * play).powi(2) / (4.0 * (far - play));
    let (rounded, moved) = (test.shear_stress(far, 8e3), sharp.shear_stress(far - gone, 8e3));
    assert!((rounded / moved - 1.0).abs() < 1e-7, "{rounded} and {moved}");
    assert!(test.shear_stress(play, 8e3) > 0.0 && sharp.shear_stress(play, 8e3) == 0.0);
}

#[test]
fn analytic_a_bottom_that_acts_more_the_deeper_the_plate_sinks() {
    let mut test = sand();
    let far = test.pressure(0.03);
    for (name, value) in [("box_bottom.strength", 4.0), ("box_bottom.reach", 0.9), ("box_bottom.growth", 0.5)] {
        test.set(name, value).unwrap();
    }
    // 1 + a (z/H)^g exp(-(H - z)/(l d))
    let factor = 1.0 + 4.0 * (0.03_f64 / 0.15).sqrt() * (-0.12_f64 / (0.9 * 0.12)).exp();
    assert!((test.pressure(0.03) / far / factor - 1.0).abs() < ROUNDING);
}

#[test]
fn property_the_shape_of_an_effect_without_strength_changes_nothing_bit_for_bit() {
    let test = sand();
    let mut shaped = test.clone();
    for (name, value) in [("box_bottom.reach", 3.0), ("box_bottom.growth", 0.5), ("shear_play.rounding", 1.5)] {
        shaped.set(name, value).unwrap();
    }
    assert_eq!(measured(&shaped), measured(&test));
}
