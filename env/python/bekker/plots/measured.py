"""Measured and modelled signals, one over the other."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np

from ..vocabulary import unknown
from . import data, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..curves import CurveGroup, Curves
    from ..diagnosed import Diagnosis

# More columns of panels than this no page holds.
_MOST_COLUMNS = 4

# Runs of one group, up to four; before and after have their own colours.
_RUNS = ("#333333", "#009E73", "#CC79A7", "#E69F00")


def overlay(diagnosis: "Diagnosis", names: Iterable[str] | None, over: str | None = None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_overlay`."""
    signals = data.signals(diagnosis, names)
    curves = next((curves for curves in diagnosis.curves if over in (None, curves.axis)), None)
    if over is not None and curves is None:
        raise unknown("varied input", over, [curves.axis for curves in diagnosis.curves])
    steady = diagnosis.kind == "single_wheel"
    return _overlay_steady(diagnosis, signals, curves) if steady else _overlay_time(diagnosis, signals)


def _overlay_steady(diagnosis: "Diagnosis", signals: list[str], curves: "Curves | None") -> "Figure":
    over, groups = (curves.axis, curves.groups) if curves else ("slip", [])
    parts = _parts(diagnosis, groups)
    grouped = len(groups) > 1
    columns = min(len(signals), 2)
    with style.figure(-(-len(signals) // columns), columns, width=4.4, height=3.0) as (figure, axes):
        for axis in axes.flat[len(signals) :]:
            axis.set_visible(False)
        for axis, signal in zip(axes.flat, signals, strict=False):
            for group, colour in zip(groups, _group_colours(len(groups)), strict=True):
                _draw_curves(axis, diagnosis, group, signal, colour if grouped else None)
            for colour, _, rows in parts:
                x, y = (data.at(data.column_by_run(diagnosis, name), rows) for name in (over, signal))
                deviation = diagnosis.noise[signal].deviation if signal in diagnosis.noise else None
                yerr = None if deviation is None else 2.0 * deviation
                axis.errorbar(x, y, yerr=yerr, fmt="o", ms=3.8, lw=0.8, color=colour, mec="white", mew=0.5, zorder=4)
            axis.set_ylabel(style.label(signal, data.unit(diagnosis, signal)))
            axis.set_xlabel(style.label(over, data.unit(diagnosis, over)))
        # More groups have no room in a legend; their colours follow their order.
        named = parts if len(parts) <= 8 else []
        entries = [style.line(colour, name, marker="o", ls="") for colour, name, _ in named]
        colours = (style.MEASURED, style.MEASURED) if grouped else (style.BEFORE, style.AFTER)
        entries += style.step_entries(diagnosis, *colours) if groups else []
        style.finish(figure, diagnosis, entries, "Measured, ± 2 noise, and modelled")
        return figure


def _draw_curves(axis: "Axes", diagnosis: "Diagnosis", group: "CurveGroup", signal: str, colour: Any) -> None:
    """The curves of a group with their bands, in its colour or, where that is None, in those of before and after."""
    last = len(diagnosis.steps) - 1
    steps = [0, last] if last else [0]
    for step, (_, dashes, width), own in zip(steps, style.before_after(diagnosis), (style.BEFORE, style.AFTER), strict=False):
        curve = group.curve(step, signal)
        if curve is not None:
            own = own if colour is None else colour
            axis.fill_between(group.at, curve.low, curve.high, color=own, alpha=0.15, lw=0, zorder=1)
            axis.plot(group.at, curve.value, color=own, ls=dashes, lw=width, zorder=3)


def _group_colours(count: int) -> list[Any]:
    return list(mpl.colormaps["viridis"](np.linspace(0.0, 0.82, max(count, 1))))[:count]


def _parts(diagnosis: "Diagnosis", groups: "list[CurveGroup]") -> list[tuple[Any, str, list[tuple[int, int]]]]:
    """Colour, name and rows of what is told apart by colour: groups, or the runs of the only one where they are few."""
    if len(groups) > 1:
        return [(c, group.name, group.rows) for c, group in zip(_group_colours(len(groups)), groups, strict=True)]
    every = [(k, row) for k, run in enumerate(diagnosis.runs) for row in range(data.rows(run.columns))]
    rows = groups[0].rows if groups else every
    runs = sorted({run for run, _ in rows})
    if not 1 < len(runs) <= len(_RUNS):
        return [(style.MEASURED, "measured", rows)]
    return [(c, diagnosis.runs[run].name, [at for at in rows if at[0] == run]) for c, run in zip(_RUNS, runs, strict=False)]


def _overlay_time(diagnosis: "Diagnosis", signals: list[str]) -> "Figure":
    sets = data.repeats(diagnosis)[:_MOST_COLUMNS]
    with style.figure(len(signals), len(sets), width=3.6, height=1.8) as (figure, axes):
        for row, signal in enumerate(signals):
            for column, (title, runs) in enumerate(sets):
                axis = axes[row, column]
                noise = diagnosis.noise[signal].deviation if signal in diagnosis.noise else 0.0
                for k, run in enumerate(runs):
                    time = diagnosis.runs[run].columns["time"]
                    measured = diagnosis.steps[0].fit.runs[run][1].get(signal)
                    if measured is None:
                        continue
                    y = measured.measured
                    axis.fill_between(time, y - 2.0 * noise, y + 2.0 * noise, color=style.QUIET, alpha=0.25, lw=0, zorder=1)
                    axis.plot(time, y, color=style.MEASURED, lw=0.9, zorder=2, alpha=0.8)
                    if k == 0:
                        colours = (style.BEFORE, style.AFTER)
                        for (step, dashes, width), colour in zip(style.before_after(diagnosis), colours, strict=False):
                            curve = step.fit.runs[run][1][signal].modelled
                            axis.plot(time, curve, color=colour, ls=dashes, lw=width, zorder=3)
                if row == 0:
                    axis.set_title(title)
                style.share_y(axes, row, column)
            axes[row, 0].set_ylabel(style.label(signal, data.unit(diagnosis, signal)))
        for axis in axes[-1]:
            axis.set_xlabel("time (s)")
        entries = [style.line(style.MEASURED, "measured, ± 2 noise")]
        style.finish(figure, diagnosis, entries + style.step_entries(diagnosis, style.BEFORE, style.AFTER))
        return figure
