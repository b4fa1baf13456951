"""Figures of a diagnosis show its numbers."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import bekker
from bekker.levels import levels, set_points, smooth

mpl.use("Agg")


def test_property_levels_follow_gaps_then_counts() -> None:
    assert levels(np.array([20.0, 20.1, 40.0, np.nan, 70.0]), most=5) == [(20.0, 20.1), (40.0, 40.0), (70.0, 70.0)]
    spread = levels(np.linspace(0.0, 1.0, 100), most=4)
    assert len(spread) == 4 and all(a[1] < b[0] for a, b in zip(spread, spread[1:], strict=False))
    assert levels(np.array([3.0, 3.0]), most=4) == [(3.0, 3.0)]


def test_property_set_points_are_told_from_accidental_differences() -> None:
    held = np.array([20.1, 39.8, 60.0, 19.9, 40.3, 60.2, 40.0, 20.0, np.nan])
    assert set_points(held, 3.0) == [(19.9, 20.1), (39.8, 40.3), (60.0, 60.2)]
    assert set_points(np.array([21.6, 24.0, 24.3, 24.5, 24.8, 25.3, 26.1]), 1.3) == [(21.6, 26.1)]


def test_analytic_a_smooth_meets_a_straight_line() -> None:
    x = np.arange(20.0) ** 2
    at, y = smooth(np.append(x, np.nan), np.append(3.0 - 0.5 * x, 1.0))
    assert at[0] == 0.0 and at[-1] == 361.0
    # Rounding of sums of some twenty terms of the size of the largest.
    assert np.abs(y - (3.0 - 0.5 * at)).max() < 361.0 * 1e-12


def test_property_plots_show_the_numbers(diagnosis: bekker.Diagnosis, tmp_path: Path) -> None:
    for name in ("overlay", "residuals", "steps", "candidates", "profiles", "heatmap"):
        figure = getattr(diagnosis, f"plot_{name}")()
        figure.savefig(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000
        mpl.pyplot.close(figure)
    figure = diagnosis.plot_steps(["torque"])
    heights = [bar.get_height() for bar in figure.axes[0].patches]
    assert heights == [step.rmse["torque"] for step in diagnosis.steps]
    figure = diagnosis.plot_candidates()
    assert {bar.get_width() for bar in figure.axes[0].patches} >= {c.probability for c in diagnosis.candidates}
    figure = diagnosis.plot_overlay(["sinkage"])
    axis = figure.axes[0]
    assert (axis.get_ylabel(), axis.get_xlabel()) == ("sinkage (m)", "slip")
    # The curves that are drawn are those of the result: before and after in each group of rows.
    drawn = [line.get_ydata() for line in axis.lines if len(line.get_ydata()) > 50]
    groups = diagnosis.curves[0].groups
    last = len(diagnosis.steps) - 1
    expected = [group.curve(step, "sinkage") for group in groups for step in (0, last)]
    assert len(drawn) == len(expected) == 12
    for line, curve in zip(drawn, expected, strict=True):
        assert curve is not None and np.array_equal(line, curve.value)
    assert [curves.axis for curves in diagnosis.curves] == ["slip", "load", "wheel_speed"]
    assert diagnosis.plot_overlay(["torque"], axis="load").axes[0].get_xlabel() == "load (N)"
    with pytest.raises(bekker.UnknownNameError, match="unknown varied input `lode`"):
        diagnosis.plot_overlay(axis="lode")
    with pytest.raises(bekker.UnknownNameError, match="unknown measured signal `sinkag`"):
        diagnosis.plot_residuals(["sinkag"])
    with pytest.raises(bekker.UnknownNameError, match="unknown column `lode`"):
        diagnosis.plot_heatmap(y="lode")
    mpl.pyplot.close("all")
