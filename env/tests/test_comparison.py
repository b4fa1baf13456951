"""`compare` gives the shipped experiment's own numbers, and names what is wrong in a folder."""

import csv
import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest

import bekker

SAND = Path(__file__).parents[2] / "examples" / "sand_wheel"
SIGNALS = ("drawbar_pull", "sinkage", "torque")
ROUNDING = 1e-12


def measured(run: str, signal: str) -> list[float]:
    with (SAND / f"{run}.csv").open() as file:
        return [float(row[signal]) for row in csv.DictReader(file)]


def test_property_measured_values_and_errors_are_those_of_the_files() -> None:
    comparison = bekker.compare(SAND)
    assert comparison.calibration is None and comparison.fit is comparison.given
    assert len(comparison.fit.runs) == 18
    for run, signals in comparison.fit.runs:
        assert tuple(sorted(signals)) == SIGNALS
        for name, fit in signals.items():
            assert fit.measured.tolist() == measured(run, name)
            assert np.array_equal(fit.residual, fit.measured - fit.modelled)
    for name in SIGNALS:
        residual = comparison.fit.signal(name).residual
        assert comparison.fit.rmse[name] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=ROUNDING)
        assert comparison.noise_floor[name].source == "replicates"


def test_property_calibration_brings_the_model_closer() -> None:
    comparison = bekker.compare(SAND, calibrate=True)
    assert comparison.given is not None and comparison.calibration is not None
    assert comparison.calibration.converged
    assert comparison.fit.rmse["drawbar_pull"] < 0.5 * comparison.given.rmse["drawbar_pull"]
    values = {parameter.name: parameter.value for parameter in comparison.calibration.parameters}
    # The calibrated values, given by hand, are the calibrated model.
    again = bekker.compare(SAND, parameters=values)
    assert again.fit.rmse == pytest.approx(comparison.fit.rmse, rel=ROUNDING)
    assert "soil.friction_angle = " in str(comparison) and "fails most in" in str(comparison)


def test_property_a_parameter_changes_the_prediction() -> None:
    base, softer = bekker.compare(SAND), bekker.compare(SAND, parameters={"soil.k_phi": 4e5})
    assert np.all(softer.fit.signal("sinkage").modelled > base.fit.signal("sinkage").modelled)


def test_property_what_is_given_goes_before_the_folder_and_is_said(tmp_path: Path) -> None:
    model = tmp_path / "m.toml"
    model.write_text("[parameters]\nwheel.radius = 0.11\nsoil.cohesion = 700.0\n")
    found = bekker.compare(SAND, model, parameters={"wheel.width": 0.13})
    values = [found.model.get(name) for name in ("wheel.radius", "soil.cohesion", "wheel.width")]
    assert values == [0.1, 700.0, 0.13], "the rig's radius holds against the model, what is given by hand against both"
    assert any("wheel.radius: 0.1 m" in line and "m.toml" in line for line in found.sources)
    assert any("wheel.width: 0.13 m from parameters, not 0.12 m" in line for line in found.sources)
    # Held in a calibration; a model's value is where that starts.
    fitted = bekker.calibrate(SAND, model, parameters={"soil.friction_angle": 0.5}).calibration
    assert fitted is not None
    starts = {parameter.name: parameter.start for parameter in fitted.parameters}
    assert starts["soil.cohesion"] == 700.0 and "soil.friction_angle" not in starts
    # A model in memory states what was set; a pickle keeps that.
    own = bekker.Model.from_preset("two_wheeled")
    own.set("soil.cohesion", 650.0)
    assert bekker.compare(SAND, pickle.loads(pickle.dumps(own))).model.get("soil.cohesion") == 650.0


def test_property_bad_folders_are_named(tmp_path: Path) -> None:
    with pytest.raises(bekker.ModelError, match=r"no_such.*experiment\.toml"):
        bekker.compare(tmp_path / "no_such")
    folder = tmp_path / "broken"
    shutil.copytree(SAND, folder)
    file = folder / "runs" / "load20_speed0.2_a.csv"
    lines = file.read_text().splitlines()
    lines[1] = lines[1].rsplit(",", 1)[0] + ",nan"
    file.write_text("\n".join(lines))
    with pytest.raises(bekker.ModelError, match=r"load20_speed0\.2_a\.csv, line 2, column `\w+`: `nan` is not a finite"):
        bekker.compare(folder)
    with pytest.raises(bekker.UnknownNameError, match="`soil.k_fi`"):
        bekker.compare(SAND, parameters={"soil.k_fi": 1.0})
    with pytest.raises(bekker.SimulationError, match="run .*load20.*, row "):
        bekker.compare(SAND, parameters={"soil.k_phi": 1e3, "soil.k_c": 0.0})
    with pytest.raises(bekker.InputError, match="windows = 7: expected a whole number from 8"):
        bekker.calibrate(SAND, windows=7)


def test_regress_a_row_without_an_answer_is_left_out_and_listed() -> None:
    rows = {"load": [40.0, 4e6, 40.0], "slip": [0.1, 0.2, 0.3], "wheel_speed": [0.5] * 3, "sinkage": [0.02] * 3}
    comparison = bekker.compare(bekker.Experiment("single_wheel", [rows]))
    (left,) = comparison.unanswered
    assert (left.first_row, left.last_row) == (2, 2) and "sinks to its axle" in left.reason
    assert comparison.given_unanswered == comparison.unanswered
    fit = comparison.fit.signal("sinkage")
    assert np.isnan(fit.modelled).tolist() == np.isnan(fit.residual).tolist() == [False, True, False]
    assert fit.measured.tolist() == [0.02, 0.02, 0.02]
    assert f"left out: {left}" in str(comparison)


def test_agreement_a_calibration_is_the_baseline_of_the_diagnosis() -> None:
    comparison = bekker.calibrate(SAND)
    diagnosis = bekker.diagnose(SAND, candidates=["slip_sinkage"], draws=100)
    assert comparison.fit.rmse == diagnosis.steps[0].rmse
    assert diagnosis.unanswered == comparison.unanswered == []


def plates(diameters: tuple[float, ...] = (0.04, 0.08, 0.2)) -> "bekker.Experiment":
    """Plates on a soil with k_c = 30 kN/m^(n+1), k_phi = 2 MN/m^(n+2), n = 0.9; three tests each, which scatter by 4 %."""
    runs = []
    for diameter in diameters:
        for repeat, factor in enumerate((0.96, 1.0, 1.04)):
            z = np.linspace(0.0015, 0.03, 20)
            force = factor * (30e3 / (0.5 * diameter) + 2e6) * z**0.9 * np.pi * diameter**2 / 4
            run = bekker.MeasuredRun(
                {"sinkage": z, "force": force},
                f"plate{1e3 * diameter:.0f}_{repeat}",
                group=f"{diameter}",
                parameters={"plate.diameter": diameter},
            )
            runs.append(run)
    return bekker.Experiment("plate_sinkage", runs, name="plates")


def test_property_a_found_soil_is_a_prior_and_a_randomisation(tmp_path: Path) -> None:
    found = bekker.calibrate(plates())
    soil = found.soil
    assert soil is not None and [p.name for p in soil.parameters] == ["soil.k_c", "soil.k_phi", "soil.exponent"]
    assert found.model.kind == "soil_test"
    soil.save(tmp_path / "soil.toml")
    read = bekker.Soil.read(tmp_path / "soil.toml")
    assert read.toml == soil.toml and np.array_equal(read.covariance, soil.covariance)
    # One plate alone does not tell k_c from k_phi; with the soil it does.
    one = bekker.calibrate(plates((0.08,)), soil_from=tmp_path / "soil.toml")
    assert one.calibration is not None
    values = {p.name: p.value for p in one.calibration.parameters}
    assert abs(values["soil.k_phi"] / 2e6 - 1.0) < 0.1
    assert any("priors of soil.toml" in line for line in one.sources)
    env = bekker.RoverEnv(randomise={"soil": read})
    drawn = [env.reset(seed=seed)[1]["drawn"] for seed in (1, 1, 2)]
    assert drawn[0] == drawn[1] != drawn[2]
    assert set(drawn[0]) == {"soil.k_c", "soil.k_phi", "soil.exponent"}
    with pytest.raises(bekker.InputError, match="no known soil"):
        bekker.Soil("name = 'nothing'\nparameter = []")
