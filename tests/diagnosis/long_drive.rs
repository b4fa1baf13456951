//! Long drives: some of their windows take part in the fits, the others judge what was found.

use crate::hill_drive::{PLANTED, ROWS, drive, shipped};
use bekker::diagnosis::{CompareOptions, Control, DiagnoseOptions, Diagnosis, Uncounted, Verdict, compare, diagnose};
use bekker::measurement::{Experiment, Prior};
use std::sync::LazyLock;

/// Windows that may take part: of the start of the drive and its four windows two do.
const WINDOWS: usize = 3;
/// Columns of the pitch and of the torque of wheel 1, and by how much they are recorded wrong: ten and twenty times their noise.
const PITCH: usize = 4;
const TORQUE: usize = 6;
const TILT: f64 = 0.02;
const TOO_MUCH: f64 = 0.4;

/// The drive with all parameters known.
fn known(change: impl Fn(usize, &mut Vec<Option<f64>>)) -> Experiment {
    let mut experiment = drive(|row, cells| {
        change(row, cells);
        true
    });
    experiment.parameters.extend(PLANTED.map(|(name, value)| (name.to_owned(), value)));
    experiment
}

fn diagnosed(experiment: &Experiment, windows: usize) -> Diagnosis {
    let candidates = Some(vec!["pitch_bias".to_owned(), "drag".to_owned()]);
    let options = DiagnoseOptions { candidates, windows, ..DiagnoseOptions::default() };
    diagnose(&shipped(), experiment, &options, &Control::default()).unwrap()
}

fn add(cells: &mut [Option<f64>], column: usize, by: f64) {
    cells[column] = cells[column].map(|value| value + by);
}

static CLEAN: LazyLock<Diagnosis> = LazyLock::new(|| diagnosed(&known(|_, _| ()), WINDOWS));

/// Whether a row of the drive is spared, counted from 0.
fn is_spared(row: usize) -> bool {
    let spared = CLEAN.uncounted.iter().filter(|rows| rows.why == Uncounted::Spared);
    spared.into_iter().any(|rows| (rows.rows.0..=rows.rows.1).contains(&(row + 1)))
}

fn is_told(diagnosis: &Diagnosis, words: &str) -> bool {
    diagnosis.cautions.iter().any(|caution| caution.contains(words))
}

#[test]
fn property_windows_of_no_fit_are_told_and_confirm_the_verdict() {
    assert_eq!(CLEAN.verdict, Verdict::Explained);
    assert!(is_told(&CLEAN, "2 of the 4 windows of this long drive took no part in the fits"), "{:?}", CLEAN.cautions);
    // Every other window is spared. They have about 5.8 s each, and rows come at 10 Hz.
    let spared = (0..ROWS).filter(|row| is_spared(*row)).count();
    assert!((114..=118).contains(&spared), "{:?}", CLEAN.uncounted);
    // They are shown, and no error counts them.
    for signal in &CLEAN.steps[0].fit.runs[0].signals {
        assert!((0..ROWS).all(|row| signal.modelled[row].is_finite()), "{}", signal.signal);
        assert!((0..ROWS).all(|row| !is_spared(row) || signal.residual[row].is_nan()), "{}", signal.signal);
    }
    // With leave to take part, all windows do.
    let all = diagnosed(&CLEAN.experiment, 5);
    assert!(!all.uncounted.iter().any(|rows| rows.why == Uncounted::Spared));
    assert!(!is_told(&all, "took no part"));
}

#[test]
fn property_windows_of_no_fit_change_no_fit_and_open_what_they_contradict() {
    let wrong = known(|row, cells| {
        if is_spared(row) {
            add(cells, TORQUE, TOO_MUCH);
        }
    });
    let found = diagnosed(&wrong, WINDOWS);
    assert_eq!(found.steps[0].chi_square.to_bits(), CLEAN.steps[0].chi_square.to_bits());
    assert_eq!(found.steps[0].fit.rmse, CLEAN.steps[0].fit.rmse);
    assert_eq!(found.verdict, Verdict::Undetermined);
    assert!(is_told(&found, "differ from those that did"), "{:?}", found.cautions);
}

#[test]
fn property_a_name_has_to_hold_where_no_fit_looks() {
    let everywhere = diagnosed(&known(|_, cells| add(cells, PITCH, TILT)), WINDOWS);
    assert_eq!((everywhere.verdict, &*everywhere.effects), (Verdict::EffectMissing, &["pitch_bias".to_owned()][..]));
    let here_only =
        diagnosed(&known(|row, cells| add(cells, PITCH, if is_spared(row) { -TILT } else { TILT })), WINDOWS);
    assert_eq!(here_only.verdict, Verdict::Undetermined);
    assert!(here_only.effects.is_empty());
    assert!(is_told(&here_only, "no better than the baseline"), "{:?}", here_only.cautions);
}

#[test]
fn agreement_a_calibration_uses_the_windows_of_a_diagnosis() {
    let mut experiment = known(|_, _| ());
    experiment.priors.insert("soil.cohesion".to_owned(), Prior { mean: 1000.0, deviation: 100.0 });
    let options = CompareOptions { calibrate: true, windows: WINDOWS, ..CompareOptions::default() };
    let calibrated = compare(&shipped(), &experiment, &options).unwrap();
    let diagnosis = diagnosed(&experiment, WINDOWS);
    assert_eq!(calibrated.fit().rmse, diagnosis.steps[0].rmse);
    assert_eq!(calibrated.uncounted, diagnosis.uncounted);
    assert!(calibrated.uncounted.iter().any(|rows| rows.why == Uncounted::Spared));
}
