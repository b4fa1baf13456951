//! Runs in a batch beside the same runs alone: the same bits, statuses and errors at the same steps, for all vehicles,
//! grounds, controllers, effects and instruction sets. The batch has no tolerance: elementary functions, choices and
//! their order are the same.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::batch::{Batch, Kernel};
use bekker::effects::EFFECTS;
use bekker::model::{ControlKind, Model, Run};
use bekker::modeldescription::{Lookup, Parameters, Role};
use bekker::simulation::Status;
use bekker::terrain::{Ditch, Profile, Random, Rocks, Slope, Spectrum, Step, Terrain, Waves};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Kernels that this processor has.
fn kernels() -> impl Iterator<Item = Kernel> {
    [Kernel::Portable, Kernel::Avx2, Kernel::Avx512].into_iter().filter(|kernel| kernel.is_there())
}

/// Signals of a run, as bits.
fn bits(run: &Run) -> Vec<u64> {
    let mut row = Vec::new();
    run.signals().values(&mut |x| row.push(x.to_bits()));
    row
}

/// Steps runs alone and in batches and compares every signal, status, time and error; how many runs have ended.
fn compare(what: &str, runs: &[Run], turns: usize, steps: u64, input: impl Fn(usize, usize) -> f64) -> usize {
    let count = runs.len();
    let mut batches: Vec<(Kernel, Batch)> =
        kernels().map(|kernel| (kernel, Batch::on(runs.to_vec(), 1, kernel).unwrap())).collect();
    let width = batches[0].1.input_count();
    let mut out = vec![0.0; count * batches[0].1.signal_count()];
    let mut alone = runs.to_vec();
    let mut failed = vec![None; count];
    for turn in 0..turns {
        let inputs: Vec<f64> = (0..count * width).map(|i| input(i, turn)).collect();
        for (k, run) in alone.iter_mut().enumerate() {
            if failed[k].is_none() {
                run.inputs_mut().set_all(&inputs[k * width..(k + 1) * width]).unwrap();
                failed[k] = run.advance(steps).err();
            }
        }
        for (kernel, batch) in &mut batches {
            batch.step(&inputs, steps, None).unwrap();
            batch.signals(&mut out);
            for (k, run) in alone.iter().enumerate() {
                let place = format!("{what}, {kernel:?}: run {k}, turn {turn}");
                assert_eq!(batch.error(k), failed[k].as_ref(), "{place}");
                assert_eq!((batch.statuses()[k], batch.time(k)), (run.status(), run.time()), "{place}");
                let row = bits(run);
                let got: Vec<u64> = out[k * row.len()..(k + 1) * row.len()].iter().map(|x| x.to_bits()).collect();
                assert_eq!(got, row, "{place}");
            }
        }
    }
    alone.iter().filter(|run| run.status() != Status::Running).count()
}

/// Inputs about `mean`, of both signs where `spread` is over 1, new in every turn.
fn varied(mean: f64, spread: f64) -> impl Fn(usize, usize) -> f64 {
    move |i, turn| {
        let share = ((i * 37 + turn * 101) as f64 * 0.618_033_988_75).fract();
        mean * (1.0 + spread * (2.0 * share - 1.0))
    }
}

#[test]
fn agreement_presets() {
    for (preset, mean) in [
        ("two_wheeled", 1.5),
        ("two_wheeled_speed", 2.0),
        ("rocker_bogie", 0.3),
        ("rocker_bogie_speed", 1.5),
        ("gentle_velocity", 0.2),
        ("rocker_bogie_velocity", 0.1),
        ("challenging_velocity", 0.2),
        ("gentle_rtc", 0.2),
        ("challenging_rtc", 0.2),
        ("fsrl_ditch", 0.08),
        ("fsrl_incline", 0.08),
    ] {
        let model = Model::preset(preset).unwrap();
        let runs: Vec<Run> = (0..9).map(|_| model.start().unwrap()).collect();
        compare(preset, &runs, 12, 7, varied(mean, 0.3));
        // Standing, reversing, spinning against the motion.
        compare(preset, &runs, 12, 7, varied(0.5 * mean, 2.5));
    }
}

/// Least share of the inner steps of eight like runs on their way that is made side by side. Only a step in which one of
/// them meets what a single run handles is made alone.
const SHARE_SIDE_BY_SIDE: f64 = 0.95;

#[test]
fn property_like_runs_go_side_by_side() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    for (preset, mean) in [("two_wheeled", 1.5), ("gentle_rtc", 0.2), ("rocker_bogie_velocity", 0.1)] {
        let base = Model::preset(preset).unwrap();
        for effects in
            [&[][..], &["slip_sinkage"], &["gear_efficiency", "rim_adhesion"], &["sensor_lag", "tracking_delay"]]
        {
            let runs = drawn(&base, effects, &mut random, 8);
            for kernel in kernels() {
                let mut batch = Batch::on(runs.clone(), 1, kernel).unwrap();
                let inputs = vec![mean; 8 * batch.input_count()];
                batch.step(&inputs, 100, None).unwrap();
                let made: f64 = (0..8).map(|k| (batch.time(k) / batch.step_size()).round()).sum();
                let share = batch.steps_side_by_side() as f64 / made;
                let place = format!("{preset} with {effects:?} on {kernel:?}");
                assert!((SHARE_SIDE_BY_SIDE..=1.0).contains(&share), "{place}: {share}");
            }
            let mut alone = Batch::on(runs, 1, Kernel::Single).unwrap();
            alone.step(&vec![mean; 8 * alone.input_count()], 10, None).unwrap();
            assert_eq!(alone.steps_side_by_side(), 0);
        }
    }
}

/// Compares runs of a preset, with inputs about `mean`, whose parameters of these names have each of the `values`.
fn compare_under((preset, mean): (&str, f64), names: [&str; 2], values: &[[f64; 2]]) {
    let run = |values: &[f64; 2]| {
        let mut model = Model::preset(preset).unwrap();
        names.iter().zip(values).for_each(|(name, value)| model.rover.set(name, *value).unwrap());
        model.start().unwrap()
    };
    let runs: Vec<Run> = values.iter().map(run).collect();
    compare(preset, &runs, 12, 7, varied(mean, 0.3));
    // Reversing and spinning against the motion, where the shear changes its sign.
    compare(preset, &runs, 12, 7, varied(0.5 * mean, 2.5));
}

/// Rims that transmit all of the soil's shear, less with a sharp corner and less with a rounded one, each beside others of its kind.
#[test]
fn agreement_rims_of_all_kinds() {
    for (preset, mean) in [("two_wheeled", 1.5), ("two_wheeled_speed", 2.0)] {
        let rims = [[0.0, 0.0], [0.2, 0.0], [0.6, 0.0], [0.2, 0.05], [0.6, 0.3], [0.6, 1.0], [0.0, 0.5], [0.8, 0.02]];
        compare_under((preset, mean), ["rim_adhesion.loss", "rim_adhesion.rounding"], &rims);
    }
}

/// Wheels that dig at once, with several lengths and not at all, each beside others of its kind.
#[test]
fn agreement_digging_of_all_kinds() {
    for (preset, mean) in [("two_wheeled", 1.5), ("two_wheeled_speed", 2.0), ("rocker_bogie", 0.3)] {
        let at_once = [[0.4, 0.0], [0.3, 0.0], [0.2, 0.0]];
        let along = [[0.4, 0.05], [0.2, 0.5], [0.5, 0.001], [0.4, 0.02]];
        let not = [[0.0, 0.05], [0.0, 0.02], [0.0, 0.3]];
        let diggers = [&at_once[..], &along, &not].concat();
        compare_under((preset, mean), ["slip_sinkage.n1", "slip_sinkage.length"], &diggers);
        let laws =
            [[0.0, 0.0], [0.3, 0.0], [0.0, 0.002], [0.2, 0.001], [1.0, 0.0], [0.0, 0.0], [0.5, 0.004], [0.0, 0.01]];
        compare_under((preset, mean), ["slip_sinkage.growth", "slip_sinkage.carried"], &laws);
    }
}

#[test]
fn agreement_grounds() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for kind in 0..7 {
        for preset in ["two_wheeled", "rocker_bogie"] {
            let base = Model::preset(preset).unwrap();
            let mut draw = |from: f64, to: f64| from + (to - from) * random.random::<f64>();
            let runs: Vec<Run> = (0..8)
                .map(|k| {
                    let mut model = base.clone();
                    let profile = match kind {
                        0 => Profile::Flat,
                        1 => Profile::Slope(Slope { slope: draw(-0.2, 0.2) }),
                        2 => {
                            Profile::Waves(Waves { amplitude: draw(0.0, 0.05), wavelength: draw(0.3, 3.0), start: 0.1 })
                        }
                        3 => Profile::Ditch(Ditch { depth: draw(-0.05, 0.1), width: draw(0.2, 0.8), position: 0.6 }),
                        4 => Profile::Step(Step { height: draw(-0.04, 0.04), length: draw(0.05, 0.3), position: 0.35 }),
                        5 => Profile::Random(Random::new(
                            Spectrum { roughness: draw(0.0, 0.02), ..Spectrum::default() },
                            k,
                        )),
                        _ => Model::preset("challenging_velocity").unwrap().rover.terrain.profile,
                    };
                    model.rover.terrain = Terrain::new(profile);
                    model.set("soil.cohesion", draw(500.0, 2000.0)).unwrap();
                    model.start().unwrap()
                })
                .collect();
            let mean = if preset == "two_wheeled" { 2.0 } else { 0.35 };
            compare(&format!("ground {kind}, {preset}"), &runs, 25, 10, varied(mean, 0.4));
        }
    }
}

/// Whether a wheel of the run is about above a rock.
fn on_rock(run: &Run) -> bool {
    let rover = run.simulation().rover();
    let x = run.signals().clone().get("x").unwrap();
    rover.wheels.iter().any(|wheel| rover.terrain.soil(&rover.soil, x + wheel.mount.x) != rover.soil)
}

/// Rovers before rocks of several sizes, and one on ground without any.
#[test]
fn agreement_rocks() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for (preset, reach) in [("two_wheeled", 0.6), ("rocker_bogie", 0.35)] {
        let base = Model::preset(preset).unwrap();
        let mut placed = |k: u32| {
            let mut model = base.clone();
            let spectrum = Spectrum { roughness: 0.01, ..Spectrum::default() };
            let rocks = Rocks { rock_coverage: 0.09 * f64::from(k % 4), largest_rock: 0.1 + 0.01 * f64::from(k) };
            let terrain = Terrain::new(Profile::Random(Random::new(spectrum, k).with_rocks(rocks)));
            let soil = model.rover.soil;
            let ahead = |x: f64| k.is_multiple_of(4) || terrain.soil(&soil, x + reach) != soil;
            let x = std::iter::repeat_with(|| 2.0 + 90.0 * random.random::<f64>()).find(|x| ahead(*x)).unwrap();
            model.start.x0 = x;
            model.rover.terrain = terrain;
            model.start().unwrap()
        };
        let runs: Vec<Run> = (0..8).map(&mut placed).collect();
        let mean = if preset == "two_wheeled" { 3.0 } else { 0.45 };
        compare(&format!("rocks, {preset}"), &runs, 150, 10, varied(mean, 0.4));
        let mut met = 0;
        for mut run in runs {
            let wheels = run.simulation().rover().wheels.len();
            run.inputs_mut().set_all(&vec![mean; wheels]).unwrap();
            let mut meets = on_rock(&run);
            for _ in 0..150 {
                // A run that has ended stays where it is.
                let _ = run.advance(10);
                meets |= on_rock(&run);
            }
            met += usize::from(meets);
        }
        assert!(met >= 4, "{preset}: {met} of 8 rovers meet a rock");
    }
}

/// Runs of `base` whose parameters are drawn: those of the effects named, or of all of them, and the soil.
fn drawn(base: &Model, effects: &[&str], random: &mut ChaCha8Rng, count: usize) -> Vec<Run> {
    let mut runs = Vec::new();
    while runs.len() < count {
        let mut model = base.clone();
        model.visit("", &mut |variable, place| {
            let effect = effects.iter().any(|id| variable.name.starts_with(&format!("{id}.")));
            let (low, high) = (variable.min.max(-1e3), variable.max.min(1e3));
            let share = random.random::<f64>();
            if effect && variable.role == Role::Effect {
                // A tenth of the range from the neutral value on, which is far more than usual.
                *place = (*place + 0.1 * share * (high - low)).clamp(low, high);
            } else if variable.name.starts_with("soil.") && variable.role == Role::Calibrated {
                *place *= 0.9 + 0.2 * share;
            }
        });
        // A rover that finds no rest with them is no run.
        runs.extend(model.start());
    }
    runs
}

#[test]
fn agreement_each_effect() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for preset in ["two_wheeled", "rocker_bogie_speed"] {
        let base = Model::preset(preset).unwrap();
        let mean = 1.5;
        for (id, _) in EFFECTS {
            let runs = drawn(&base, &[id], &mut random, 8);
            compare(&format!("{preset}, {id}"), &runs, 8, 10, varied(mean, 0.8));
        }
    }
}

#[test]
fn agreement_all_effects_at_once() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let ids: Vec<&str> = EFFECTS.iter().map(|(id, _)| *id).collect();
    for preset in ["two_wheeled", "gentle_velocity", "rocker_bogie_velocity"] {
        let runs = drawn(&Model::preset(preset).unwrap(), &ids, &mut random, 16);
        compare(preset, &runs, 20, 10, varied(if preset == "two_wheeled" { 2.0 } else { 0.2 }, 1.5));
    }
}

#[test]
fn agreement_events_at_the_same_step() {
    // Under commands from outside, and with a controller that decides; with signals that are recorded as they are, and later.
    for (kind, mean) in [(ControlKind::Torque, 2.2), (ControlKind::SpeedLoop, 5.0)] {
        for dead_time in [0.0, 0.013] {
            events_at_the_same_step(kind, mean, dead_time);
        }
    }
}

fn events_at_the_same_step(kind: ControlKind, mean: f64, dead_time: f64) {
    let mut base = Model::preset("two_wheeled").unwrap();
    base.control.kind = kind;
    base.set("sensor_lag.dead_time", dead_time).unwrap();
    base.set("tracking_delay.dead_time", 0.5 * dead_time).unwrap();
    let runs: Vec<Run> = (0..19)
        .map(|k| {
            let mut model = base.clone();
            // From soil that carries to soil in which wheels spin; the last drive off known ground.
            model.set("soil.cohesion", 2500.0 - 130.0 * f64::from(k)).unwrap();
            model.set("soil.friction_angle", 0.6 - 0.02 * f64::from(k)).unwrap();
            if k > 15 {
                let samples = bekker::terrain::Samples::new(&[-1.0, 0.0, 0.42, 0.45], &[0.0; 4]).unwrap();
                model.rover.terrain = Terrain::new(Profile::Samples(samples.into()));
            }
            model.start().unwrap()
        })
        .collect();
    let ended = compare("events", &runs, 180, 10, varied(mean, 0.2));
    assert!(ended > 5 && ended < runs.len(), "{ended} of {} runs ended", runs.len());
}

#[test]
fn agreement_snapshots_and_replacements() {
    snapshots_and_replacements(&Model::preset("rocker_bogie").unwrap());
    let mut lagging = Model::preset("rocker_bogie").unwrap();
    lagging.set("sensor_lag.time_constant", 0.02).unwrap();
    lagging.set("sensor_lag.dead_time", 0.013).unwrap();
    snapshots_and_replacements(&lagging);
}

fn snapshots_and_replacements(base: &Model) {
    let runs: Vec<Run> = (0..13).map(|_| base.start().unwrap()).collect();
    for kernel in kernels() {
        let mut alone = runs.clone();
        let mut batch = Batch::on(runs.clone(), 2, kernel).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(4);
        for turn in 0..40 {
            let inputs: Vec<f64> = (0..39).map(|i| varied(0.3, 0.5)(i, turn)).collect();
            let active: Vec<bool> = (0..13).map(|_| random.random::<f64>() < 0.8).collect();
            batch.step(&inputs, 10, Some(&active)).unwrap();
            for (k, run) in alone.iter_mut().enumerate().filter(|(k, _)| active[*k]) {
                run.inputs_mut().set_all(&inputs[3 * k..3 * k + 3]).unwrap();
                run.advance(10).unwrap();
            }
            // What comes out goes on alone to the same bits; what goes in goes on in the batch.
            let k = random.random_range(0..13);
            let mut out = batch.run(k);
            assert_eq!(bits(&out), bits(&alone[k]), "{kernel:?}: run {k}, turn {turn}");
            for run in [&mut out, &mut alone[k]] {
                run.inputs_mut().set_all(&[0.2; 3]).unwrap();
                run.advance(3).unwrap();
            }
            assert_eq!(bits(&out), bits(&alone[k]), "{kernel:?}: run {k}, turn {turn}, 3 steps on");
            batch.replace(k, out).unwrap();
        }
        (0..13).for_each(|k| assert_eq!(bits(&batch.run(k)), bits(&alone[k]), "{kernel:?}: run {k}"));
    }
}

#[test]
fn property_bits_depend_neither_on_size_nor_order_nor_threads() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut runs = drawn(&Model::preset("two_wheeled").unwrap(), &["slip_sinkage"], &mut random, 21);
    // Two kinds of runs, which take turns.
    let other = drawn(&Model::preset("two_wheeled").unwrap(), &["gear_efficiency"], &mut random, 21);
    runs = runs.into_iter().zip(other).flat_map(|(a, b)| [a, b]).collect();
    let input = |k: usize| [1.5 + 0.02 * k as f64, 1.4];
    let end = |order: Vec<usize>, threads: usize| {
        let mut batch = Batch::new(order.iter().map(|&k| runs[k].clone()).collect(), threads).unwrap();
        let inputs: Vec<f64> = order.iter().flat_map(|&k| input(k)).collect();
        (0..20).for_each(|_| batch.step(&inputs, 10, None).unwrap());
        order.iter().enumerate().map(|(place, &k)| (k, bits(&batch.run(place)))).collect::<Vec<_>>()
    };
    let whole = end((0..42).collect(), 1);
    for (order, threads) in [
        ((0..42).rev().collect(), 1),
        ((0..42).collect(), 3),
        ((5..30).collect(), 2),
        (vec![7], 1),
        (vec![40, 2, 9], 1),
    ] {
        for (k, bits) in end(order, threads) {
            assert_eq!(bits, whole[k].1, "run {k}, {threads} threads");
        }
    }
}

#[test]
fn property_random_parameters_stay_finite() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    for preset in ["two_wheeled", "rocker_bogie"] {
        let base = Model::preset(preset).unwrap();
        let runs: Vec<Run> = (0..64).flat_map(|_| drawn(&base, &[], &mut random, 1)).collect();
        let mut batch = Batch::new(runs, 1).unwrap();
        let (count, width) = (batch.len(), batch.input_count());
        let mut out = vec![0.0; count * batch.signal_count()];
        for turn in 0..60 {
            let inputs: Vec<f64> = (0..count * width).map(|i| varied(0.5, 6.0)(i, turn)).collect();
            batch.step(&inputs, 10, None).unwrap();
            batch.signals(&mut out);
            assert!(out.iter().all(|x| x.is_finite()), "{preset}, turn {turn}");
            assert!((0..count).all(|k| batch.error(k).is_none()), "{preset}, turn {turn}");
        }
    }
}
