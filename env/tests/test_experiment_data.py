"""Experiments from arrays: bad data and settings are named, missing values are kept."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import bekker

ROW = {"load": [30.0, 30.0], "slip": [0.1, 0.2], "wheel_speed": [0.2, 0.2], "sinkage": [0.012, 0.014]}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sinkage": [0.012, np.inf]}, r"run `run1`, row 1, column `sinkage`: `inf` is not a finite number"),
        ({"slip": [0.1, np.nan]}, r"run `run1`, row 1, column `slip`: an input may not be missing"),
        ({"slip": [10.0, 20.0]}, r"run `run1`, row 0, column `slip`: 10 cannot be right: .*per cent"),
        ({"slip": [0.1]}, r"run `run1`, column `slip`: 1 rows where `load` has 2"),
        ({"slip": [[0.1], [0.2]]}, r"run `run1`, column `slip`: expected one number a row: the shape is \(2, 1\)"),
        ({"slip": ["a", "b"]}, r"run `run1`, column `slip`: expected one number a row"),
        ({"slop": [0.1, 0.2]}, r"run `run1`, column `slop`: unknown column"),
        ({"sinkage": [np.nan, np.nan]}, r"run `run1`: nothing is measured"),
    ],
)
def test_property_bad_data_are_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(bekker.InputError, match=message):
        bekker.Experiment("single_wheel", [ROW | change])


def test_property_bad_settings_are_named() -> None:
    with pytest.raises(bekker.InputError, match=r"experiment, key `noise\.sinkage`: a standard deviation is positive"):
        bekker.Experiment("single_wheel", [ROW], noise={"sinkage": -1.0})
    with pytest.raises(bekker.InputError, match="experiment: unknown variant `wheel`"):
        bekker.Experiment("wheel", [ROW])
    with pytest.raises(bekker.InputError, match="run `a`: 1 rows, where b|not a repeat"):
        short = {name: values[:1] for name, values in ROW.items()}
        bekker.Experiment(
            "single_wheel", [bekker.MeasuredRun(ROW, "b", group="g"), bekker.MeasuredRun(short, "a", group="g")]
        )
    with pytest.raises(bekker.InputError, match="two runs are called `a`"):
        bekker.Experiment("single_wheel", [bekker.MeasuredRun(ROW, "a"), bekker.MeasuredRun(ROW, "a")])
    with pytest.raises(bekker.InputError, match="below the experiment's folder"):
        bekker.Experiment("single_wheel", [bekker.MeasuredRun(ROW, "../a")])
    with pytest.raises(bekker.InputError, match="terrain of run `a`, row 1, column `x`"):
        commands = {"time": np.arange(12.0), "wheel[1].speed_command": np.ones(12), "pitch": np.zeros(12)}
        bekker.Experiment("traverse", [bekker.MeasuredRun(commands, "a", terrain=([0.0, -1.0], [0.0, 0.0]))])
    # Names and texts of any kind come through.
    odd = bekker.Experiment("single_wheel", [bekker.MeasuredRun(ROW, 'a "b", c')], name="ü \x7f 'q' \\ \U0001f600")
    assert odd.signals == ("sinkage",)


def test_property_missing_values_of_every_kind() -> None:
    missing = [
        [0.012, None],
        pd.array([0.012, None], dtype="Float64"),
        np.ma.MaskedArray([0.012, 7.0], [False, True]),
        pd.Series([0.012, np.nan]),
    ]
    for column in missing:
        compared = bekker.compare(bekker.Experiment("single_wheel", [ROW | {"sinkage": column}]))
        assert np.isnan(compared.fit.signal("sinkage").residual).tolist() == [False, True]


def test_property_a_frame_of_a_drive_with_a_corner_becomes_two_runs(tmp_path: Path) -> None:
    time = np.arange(230) * 0.1
    turning = (time >= 10.0) & (time < 13.0)
    wheel = np.where(turning, 0.0, 2.5)
    frame = pd.DataFrame(
        {
            "time": time,
            "left": wheel,
            "right": wheel,
            "amps_left": 1.0 + wheel,
            "amps_right": 2.0 + wheel,
            "yaw_rate": np.where(turning, 0.5, 0.0),
            "velocity": 0.2 * wheel,
        }
    )
    columns = {
        "left": {"signal": "speed", "wheels": [1, 2], "side": "left"},
        "right": {"signal": "speed", "wheels": [1, 2], "side": "right"},
        "amps_left": {"signal": "current", "wheels": [1, 2], "side": "left", "magnitude": True},
        "amps_right": {"signal": "current", "wheels": [1, 2], "side": "right", "magnitude": True},
    }
    given = bekker.Experiment("traverse", [frame], parameters={"wheel.radius": 0.2}, columns=columns)
    assert given.signals == ("wheel[1+2].current", "velocity")
    assert any("2 straight stretches" in doubt for doubt in given.doubts)
    given.save(tmp_path)
    for experiment in (given, tmp_path):
        runs = bekker.compare(experiment, "two_wheeled_speed").given.runs
        assert [name for name, _ in runs] == ["run1#1", "run1#2"]
        assert all(signals["wheel[1+2].current"].measured[5] == 4.0 for _, signals in runs)
