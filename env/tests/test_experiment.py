"""Data frames in names and units of their own, and folders that are proposed for files."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import bekker

RIG: dict[str, Any] = {"wheel.radius": {"value": 58, "unit": "mm"}, "wheel.width": 0.05}
COLUMNS: dict[str, Any] = {
    "DP [kN]": {"signal": "drawbar_pull", "unit": "kN"},
    "W": {"signal": "load", "unit": "kg"},
    "z": {"signal": "sinkage", "unit": "mm", "sign": -1},
    "Vx": {"signal": "carriage_speed", "unit": "mm/s"},
    "Vr": {"signal": "rim_speed", "unit": "mm/s"},
    "set": "condition",
}
TRIALS = pd.DataFrame(
    {
        "DP [kN]": [-0.0015, 0.004, 0.006],
        "W": [2.5, 2.5, 2.6],
        "z": [-10.0, -12.0, -15.0],
        "Vx": [10.0, 10.0, 10.0],
        "Vr": [10.0, 12.5, 20.0],
        "set": ["#1", "#2", None],
        "note": ["a", "b", "c"],
    }
)


def read(**options: Any) -> bekker.Experiment:
    return bekker.Experiment("single_wheel", [TRIALS], ignore=["no*"], columns=COLUMNS, parameters=RIG, **options)


def test_property_frames_are_mapped_like_files(tmp_path: Path) -> None:
    experiment = read(soil_class="dry sand", priors={"soil.cohesion": (500.0, 200.0)})
    assert experiment.signals == ("drawbar_pull", "sinkage")
    assert experiment.doubts == ()
    fit = bekker.compare(experiment).fit
    np.testing.assert_allclose(fit.signal("drawbar_pull").measured, [-1.5, 4.0, 6.0], rtol=1e-14)
    np.testing.assert_allclose(fit.signal("sinkage").measured, [0.01, 0.012, 0.015], rtol=1e-14)
    # The folder that is saved has the mapping, and gives the same.
    experiment.save(tmp_path / "saved")
    again = bekker.compare(tmp_path / "saved").fit
    assert np.array_equal(again.signal("sinkage").measured, fit.signal("sinkage").measured)


def test_property_priors_of_every_form() -> None:
    forms = [
        {"soil.friction_angle": (0.55, 0.05)},
        {"soil.friction_angle": {"mean": 31.5, "sd": 2.9, "unit": "deg"}},
    ]
    for priors in forms:
        assert read(priors=priors).signals
    with pytest.raises(bekker.InputError, match=r"unit = \"deg\""):
        read(priors={"soil.friction_angle": (3.0, 0.1)})
    with pytest.raises(bekker.InputError, match="needs the mean"):
        read(priors={"soil.friction_angle": 0.05})


def log(**options: Any) -> bekker.Experiment:
    """A log of a rover without commands."""
    rows = np.arange(40)
    columns = {"time": 0.05 * rows, "encoder": 2.0 + 0.1 * np.sin(rows), "x": 0.01 * rows, "velocity": np.full(40, 0.2)}
    encoder = {"signal": "speed", "wheels": [1, 2]}
    return bekker.Experiment("traverse", [columns], columns={"encoder": encoder}, model="two_wheeled_speed", **options)


def test_property_measured_wheel_speeds_drive_where_there_is_no_command() -> None:
    experiment = log()
    assert experiment.signals == ("x", "velocity")
    comparison = bekker.compare(experiment)
    assert any("measured wheel speeds drive the rover" in line for line in comparison.sources)


def test_property_errors_of_sensors_are_stated_and_found() -> None:
    sensors = {"velocity": {"delay": 0.05, "gain": (1.0, 0.02), "bias": {"sd": 1, "unit": "cm/s"}}}
    soil = {"soil.cohesion": 1000.0, "soil.exponent": 1.0, "soil.shear_modulus": 0.02, "soil.c1": 0.4, "soil.c2": 0.2}
    experiment = log(sensors=sensors, parameters=soil, noise={"x": 0.01, "velocity": 0.01})
    calibration = bekker.compare(experiment, calibrate=True).calibration
    assert calibration is not None
    found = {parameter.name: parameter for parameter in calibration.parameters}
    for error in ("delay", "gain", "bias"):
        parameter = found[f"sensors.velocity.{error}"]
        assert parameter.deviation is None or parameter.deviation > 0.0
    with pytest.raises(bekker.InputError, match=r"`velocty` is no signal .* did you mean velocity"):
        log(sensors={"velocty": {"delay": 0.05}})
    with pytest.raises(bekker.InputError, match="a standard deviation is positive"):
        log(sensors={"velocity": {"delay": -0.05}})
    with pytest.raises(bekker.InputError, match="expected a mapping such as"):
        log(sensors={"velocity": 0.05})


def test_property_dates_become_seconds_and_commands_go_to_several_wheels() -> None:
    log = pd.DataFrame(
        {
            "stamp": pd.date_range("2019-01-29T10:53:36.120", periods=12, freq="100ms"),
            "command": np.full(12, 10.0),
            "I": np.full(12, 900.0),
        }
    )
    columns: dict[str, Any] = {
        "stamp": {"time_stamp": True},
        "command": {"signal": "speed_command", "wheels": [1, 2], "unit": "deg/s"},
        "I": {"signal": "current", "wheels": [1, 2], "unit": "mA"},
    }
    experiment = bekker.Experiment("traverse", [log], columns=columns)
    assert experiment.signals == ("wheel[1+2].current",)
    constant = bekker.Experiment(
        "traverse",
        [log.drop(columns="command")],
        columns={name: entry for name, entry in columns.items() if name != "command"},
        inputs={"wheel[1].speed_command": 0.2, "wheel[2].speed_command": {"value": 10, "unit": "deg/s"}},
    )
    assert constant.signals == experiment.signals


def test_property_what_is_wrong_or_doubtful_is_said() -> None:
    with pytest.raises(bekker.InputError, match="expected one of N, kN"):
        metres = COLUMNS | {"DP [kN]": {"signal": "drawbar_pull", "unit": "m"}}
        bekker.Experiment("single_wheel", [TRIALS], ignore=["note"], columns=metres)
    with pytest.raises(bekker.InputError, match="columns: expected a mapping"):
        bekker.Experiment("single_wheel", [TRIALS], columns=["DP"])  # type: ignore[arg-type]
    kilonewtons = COLUMNS | {"DP [kN]": {"signal": "drawbar_pull", "unit": "N"}}
    doubts = bekker.Experiment("single_wheel", [TRIALS], ignore=["note"], columns=kilonewtons, parameters=RIG).doubts
    assert any("the file itself says kN" in doubt for doubt in doubts)
    assert any('unit = "kN"' in doubt for doubt in doubts)


def test_property_a_folder_is_proposed(tmp_path: Path) -> None:
    file = tmp_path / "trials.csv"
    TRIALS.drop(columns="set").to_csv(file, index=False, sep=";", decimal=",")
    imported = bekker.import_experiment(file, tmp_path / "made")
    assert imported.kind == "single_wheel"
    assert any("wheel.radius" in missing for missing in imported.missing)
    assert imported.problem is not None and "wheel.radius" in imported.problem
    settings = (imported.folder / "experiment.toml").read_text()
    assert '"z" = { signal = "sinkage", unit = "mm", sign = -1 }' in settings
    with pytest.raises(FileExistsError):
        bekker.import_experiment([file], tmp_path / "made")
    with pytest.raises(bekker.InputError, match="expected single_wheel, shear, plate_sinkage, traverse"):
        bekker.import_experiment(file, tmp_path / "other", kind="boat")  # type: ignore[arg-type]
    with pytest.raises(bekker.InputError, match="cannot be read"):
        bekker.import_experiment(tmp_path / "absent.csv", tmp_path / "other")
