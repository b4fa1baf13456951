//! The map of the ground ahead: heights, obstacles, other soils, noise and missing cells.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::batch::Batch;
use bekker::model::{Ahead, AheadError, Model, Run};

/// Rounding of differences of heights of some metres.
const ROUNDING: f64 = 1e-12;
/// Readings of as many cells: their standard deviation is known to 1.1 %, a probability of 0.2 to 0.006; four times that.
const CELLS: usize = 4000;
const DEVIATION_ERROR: f64 = 0.045;
const SHARE_ERROR: f64 = 0.026;

fn start(toml: &str) -> Run {
    Model::from_toml(toml, None).unwrap().start().unwrap()
}

/// Heights, which cells are there, strengths.
fn read(run: &Run, ahead: &Ahead) -> [Vec<f64>; 3] {
    let count = ahead.distances().len();
    let mut out = vec![f64::NAN; Ahead::ROWS * count];
    run.look_ahead(ahead, &mut out);
    std::array::from_fn(|k| out[k * count..(k + 1) * count].to_vec())
}

#[test]
fn analytic_heights_are_those_of_the_ground() {
    let ahead = Ahead::new(vec![-0.5, 0.0, 0.3, 2.0], 0.0, 0.0).unwrap();
    let run = start("preset = \"two_wheeled\"\n[terrain]\npreset = \"slope\"\nslope = 0.2\n");
    let [heights, there, strength] = read(&run, &ahead);
    for (height, distance) in heights.iter().zip(ahead.distances()) {
        // The slope is an angle, rad.
        assert!((height - 0.2_f64.tan() * distance).abs() < ROUNDING, "{height} at {distance}");
    }
    assert_eq!((there, strength), (vec![1.0; 4], vec![1.0; 4]));
}

#[cfg(feature = "rigid")]
#[test]
fn analytic_an_obstacle_is_as_high_as_it_stands_out() {
    use bekker::model::Plant;
    use bekker::obstacle::Obstacle;
    let mut model = Model::preset("two_wheeled").unwrap();
    model.stepping.plant = Plant::RigidBodies;
    model.obstacles =
        vec![Obstacle::rock(2.0, 0.1, 0.4), Obstacle::block(3.0, 0.2, 0.1), Obstacle::ledge(4.0, 0.05, 1.0)];
    let run = model.start().unwrap();
    let x = run.signals().body.x;
    // The top of the rock, half way down its side, beside it; the block; the ledge's face and top.
    let places = [2.0, 2.1, 2.3, 3.04, 3.06, 3.99, 4.01, 4.9];
    let expected = [0.1, 0.1 * 0.75_f64.sqrt(), 0.0, 0.2, 0.0, 0.0, 0.05, 0.05];
    let ahead = Ahead::new(places.map(|place| place - x).to_vec(), 0.0, 0.0).unwrap();
    for (height, expected) in read(&run, &ahead)[0].iter().zip(expected) {
        assert!((height - expected).abs() < ROUNDING, "{height} instead of {expected}");
    }
}

#[test]
fn analytic_strength_is_that_of_the_table_over_that_of_the_model() {
    use bekker::terrain::{Profile, SoilColumn, SoilTable, Terrain};
    let mut model = Model::preset("two_wheeled").unwrap();
    let column = SoilColumn { name: "cohesion_factor".to_owned(), values: vec![1.0, 0.5, 0.5, 1.0] };
    let table = SoilTable::new(vec![1.0, 1.1, 2.0, 2.1], vec![column]).unwrap();
    model.rover.terrain = Terrain::new(Profile::Flat).with_soil(table);
    let run = model.start().unwrap();
    let x = run.signals().body.x;
    let ahead = Ahead::new([0.9, 1.05, 1.5, 2.2].map(|place| place - x).to_vec(), 0.0, 0.0).unwrap();
    let (rover, soil) = (&model.rover, &model.rover.soil);
    let pressure = rover.total_mass() * rover.environment.gravity / (2.0 * rover.wheel.radius * rover.wheel.width);
    let friction = pressure * soil.friction_angle.tan();
    for (strength, factor) in read(&run, &ahead)[2].iter().zip([1.0, 0.75, 0.5, 1.0]) {
        let expected = (factor * soil.cohesion + friction) / (soil.cohesion + friction);
        assert!((strength - expected).abs() < ROUNDING, "{strength} instead of {expected}");
    }
}

#[test]
fn property_noise_and_missing_cells_are_as_asked() {
    let run = start("preset = \"two_wheeled\"\n");
    let ahead = Ahead::new(vec![0.5; CELLS], 0.02, 0.2).unwrap();
    let [heights, there, _] = read(&run, &ahead);
    let present: Vec<f64> = heights.iter().zip(&there).filter(|(_, there)| **there == 1.0).map(|(h, _)| *h).collect();
    let missing = heights.iter().zip(&there).filter(|(_, there)| **there == 0.0);
    assert!(missing.clone().all(|(height, _)| *height == 0.0));
    let share = missing.count() as f64 / CELLS as f64;
    assert!((share - 0.2).abs() < SHARE_ERROR, "{share}");
    let deviation = (present.iter().map(|h| h * h).sum::<f64>() / present.len() as f64).sqrt();
    assert!((deviation / 0.02 - 1.0).abs() < DEVIATION_ERROR, "{deviation}");
}

#[test]
fn agreement_a_batch_reads_what_each_run_reads() {
    let ahead = Ahead::new(vec![0.1, 0.4, 0.9], 0.01, 0.3).unwrap();
    let runs = [1, 2, 3].map(|seed| {
        let mut model =
            Model::from_toml("preset = \"two_wheeled\"\n[terrain]\npreset = \"random\"\nseed = 4\n", None).unwrap();
        model.stepping.seed = seed;
        model.start().unwrap()
    });
    let mut batch = Batch::new(runs.to_vec(), 2).unwrap();
    let mut out = vec![0.0; 3 * Ahead::ROWS * 3];
    for _ in 0..3 {
        batch.step(&[0.8; 6], 10, None).unwrap();
        batch.look_ahead(&ahead, &mut out);
        for (row, index) in out.chunks(Ahead::ROWS * 3).zip(0..) {
            let alone = batch.run(index);
            assert_eq!(row, read(&alone, &ahead).concat());
            assert_eq!(row, read(&alone, &ahead).concat(), "a second look in one step");
        }
    }
}

#[test]
fn property_each_seed_and_each_step_has_noise_of_its_own() {
    let ahead = Ahead::new(vec![0.2; 20], 0.01, 0.5).unwrap();
    let mut readings = Vec::new();
    for seed in [1, 2] {
        let mut model = Model::preset("two_wheeled").unwrap();
        model.stepping.seed = seed;
        let mut run = model.start().unwrap();
        for _ in 0..3 {
            // Level ground: nothing but noise differs.
            readings.push(read(&run, &ahead));
            run.advance(1).unwrap();
        }
    }
    for (k, one) in readings.iter().enumerate() {
        assert!(readings[..k].iter().all(|other| other[0] != one[0] && other[1] != one[1]));
    }
}

#[test]
fn property_the_map_is_looked_up_at_the_recorded_place() {
    let mut model = Model::from_toml(
        "preset = \"two_wheeled\"\n[terrain]\npreset = \"waves\"\namplitude = 0.05\nwavelength = 2.0\n",
        None,
    )
    .unwrap();
    model.rover.effects.radius_scale.odometry = 0.1;
    let mut run = model.start().unwrap();
    run.inputs_mut().set_all(&[2.0, 2.0]).unwrap();
    run.advance(1000).unwrap();
    let ground = |x: f64| model.rover.terrain.at(x).height;
    let recorded = run.signals().body.x;
    let ahead = Ahead::new(vec![0.4], 0.0, 0.0).unwrap();
    let height = read(&run, &ahead)[0][0];
    assert!((height - (ground(recorded + 0.4) - ground(recorded))).abs() < ROUNDING, "{height}");
    let place = run.simulation().state().position[0];
    assert!((recorded - place).abs() > 0.01, "the scale of the odometry shows: {recorded}, {place}");
}

#[test]
fn property_what_cannot_be_read_is_refused_by_name() {
    let refused = |distances: &[f64], noise, dropout| Ahead::new(distances.to_vec(), noise, dropout).unwrap_err();
    assert_eq!(refused(&[], 0.0, 0.0), AheadError::Empty);
    assert!(refused(&[0.1, f64::NAN], 0.0, 0.0).to_string().starts_with("distances[1] = NaN: expected"));
    assert_eq!(refused(&[0.1], -1.0, 0.0).to_string(), "noise = -1: expected a standard deviation from 0, m");
    assert_eq!(refused(&[0.1], 0.0, 1.5), AheadError::Dropout(1.5));
}
