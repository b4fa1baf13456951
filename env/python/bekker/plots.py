"""Figures of a diagnosis. Needs matplotlib; use the methods ``plot_*`` of :class:`bekker.Diagnosis`."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .comparison import Fit
from .errors import InputError
from .levels import Floats, levels, set_points, smooth
from .vocabulary import unknown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .curves import CurveGroup, Curves
    from .diagnosis import Candidate, Diagnosis, Parameter

try:
    import matplotlib as mpl
    from matplotlib import pyplot as plt
    from matplotlib.ticker import MaxNLocator
except ImportError as error:  # pragma: no cover
    raise ImportError("plots need matplotlib: pip install 'bekker[plot]'") from error

__all__ = ["candidates", "heatmap", "overlay", "profiles", "residuals", "steps"]

# Of the palette of Okabe and Ito, which people with any colour vision tell apart.
_MEASURED, _BEFORE, _AFTER, _QUIET = "#333333", "#D55E00", "#0072B2", "#9A9A9A"
# Runs of one group, up to four; before and after have their own colours.
_RUNS = ("#333333", "#009E73", "#CC79A7", "#E69F00")
_STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "figure.constrained_layout.use": True,
}

# More panels than this no page holds.
_MOST_SIGNALS, _MOST_COLUMNS = 6, 4

# 95 % point of chi-square with one degree of freedom: where a profile's interval ends.
_RISE = 3.841

_UNITS = {
    "load": "N",
    "slip": "",
    "wheel_speed": "rad/s",
    "drawbar_pull": "N",
    "torque": "N m",
    "sinkage": "m",
    "time": "s",
}

_WORDS = {
    "explained": "explained: nothing but noise is left",
    "effect_missing": "missing effect",
    "unexplained": "unexplained structure",
    "undetermined": "undetermined",
}


def overlay(diagnosis: "Diagnosis", names: Iterable[str] | None, over: str | None = None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_overlay`."""
    signals = _signals(diagnosis, names)
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
    with _figure(-(-len(signals) // columns), columns, width=4.4, height=3.0) as (figure, axes):
        for axis in axes.flat[len(signals) :]:
            axis.set_visible(False)
        for axis, signal in zip(axes.flat, signals, strict=False):
            for group, colour in zip(groups, _group_colours(len(groups)), strict=True):
                _draw_curves(axis, diagnosis, group, signal, colour if grouped else None)
            for colour, _, rows in parts:
                x, y = _at(_column_by_run(diagnosis, over), rows), _at(_column_by_run(diagnosis, signal), rows)
                deviation = diagnosis.noise[signal].deviation if signal in diagnosis.noise else None
                yerr = None if deviation is None else 2.0 * deviation
                axis.errorbar(x, y, yerr=yerr, fmt="o", ms=3.8, lw=0.8, color=colour, mec="white", mew=0.5, zorder=4)
            axis.set_ylabel(_label(signal, _unit(diagnosis, signal)))
            axis.set_xlabel(_label(over, _unit(diagnosis, over)))
        # More groups have no room in a legend; their colours follow their order.
        named = parts if len(parts) <= 8 else []
        entries = [_line(colour, name, marker="o", ls="") for colour, name, _ in named]
        colours = (_MEASURED, _MEASURED) if grouped else (_BEFORE, _AFTER)
        entries += _step_entries(diagnosis, *colours) if groups else []
        _finish(figure, diagnosis, entries, "Measured, ± 2 noise, and modelled")
        return figure


def _draw_curves(axis: "Axes", diagnosis: "Diagnosis", group: "CurveGroup", signal: str, colour: Any) -> None:
    """The curves of a group with their bands, in its colour or, where that is None, in those of before and after."""
    last = len(diagnosis.steps) - 1
    steps = [0, last] if last else [0]
    for step, (_, dashes, width), own in zip(steps, _before_after(diagnosis), (_BEFORE, _AFTER), strict=False):
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
    every = [(k, row) for k, run in enumerate(diagnosis.runs) for row in range(_rows(run.columns))]
    rows = groups[0].rows if groups else every
    runs = sorted({run for run, _ in rows})
    if not 1 < len(runs) <= len(_RUNS):
        return [(_MEASURED, "measured", rows)]
    return [(c, diagnosis.runs[run].name, [at for at in rows if at[0] == run]) for c, run in zip(_RUNS, runs, strict=False)]


def _column_by_run(diagnosis: "Diagnosis", name: str) -> list[Floats]:
    """A column of each run; NaN where a run does not have it."""
    return [run.columns.get(name, np.full(_rows(run.columns), np.nan)) for run in diagnosis.runs]


def _at(columns: list[Floats], rows: list[tuple[int, int]]) -> Floats:
    return np.array([columns[run][row] for run, row in rows])


def _overlay_time(diagnosis: "Diagnosis", signals: list[str]) -> "Figure":
    sets = _repeats(diagnosis)[:_MOST_COLUMNS]
    with _figure(len(signals), len(sets), width=3.6, height=1.8) as (figure, axes):
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
                    axis.fill_between(time, y - 2.0 * noise, y + 2.0 * noise, color=_QUIET, alpha=0.25, lw=0, zorder=1)
                    axis.plot(time, y, color=_MEASURED, lw=0.9, zorder=2, alpha=0.8)
                    if k == 0:
                        for (step, dashes, width), colour in zip(_before_after(diagnosis), (_BEFORE, _AFTER), strict=False):
                            curve = step.fit.runs[run][1][signal].modelled
                            axis.plot(time, curve, color=colour, ls=dashes, lw=width, zorder=3)
                if row == 0:
                    axis.set_title(title)
                _share_y(axes, row, column)
            axes[row, 0].set_ylabel(_label(signal, _unit(diagnosis, signal)))
        for axis in axes[-1]:
            axis.set_xlabel("time (s)")
        entries = [_line(_MEASURED, "measured, ± 2 noise")]
        _finish(figure, diagnosis, entries + _step_entries(diagnosis, _BEFORE, _AFTER))
        return figure


def residuals(diagnosis: "Diagnosis", names: Iterable[str] | None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_residuals`."""
    signals, conditions = _signals(diagnosis, names), _conditions(diagnosis)
    with _figure(len(signals), len(conditions), width=3.0, height=2.0) as (figure, axes):
        for row, signal in enumerate(signals):
            noise = diagnosis.noise[signal].deviation if signal in diagnosis.noise else None
            for column, condition in enumerate(conditions):
                axis, x = axes[row, column], _column(diagnosis, condition)
                if noise is not None:
                    axis.axhspan(-2.0 * noise, 2.0 * noise, color=_QUIET, alpha=0.22, lw=0)
                axis.axhline(0.0, color=_MEASURED, lw=0.8)
                for (step, _, _), colour in zip(_before_after(diagnosis), (_BEFORE, _AFTER), strict=False):
                    residual = _values(diagnosis, step.fit, signal, "residual")
                    size = 6.0 if x.size < 2000 else 1.5
                    axis.scatter(x, residual, s=size, color=colour, alpha=0.3, lw=0, rasterized=x.size > 2000)
                    _average(axis, x, residual, colour)
                _share_y(axes, row, column)
            axes[row, 0].set_ylabel(_label(signal, _unit(diagnosis, signal)))
        for axis, condition in zip(axes[-1], conditions, strict=True):
            axis.set_xlabel(_label(condition, _unit(diagnosis, condition)))
        entries = _step_entries(diagnosis, _BEFORE, _AFTER, dashes=False)
        if diagnosis.noise:
            entries.append(_patch("± 2 noise"))
        _finish(figure, diagnosis, entries, "Measured minus modelled")
        return figure


def _average(axis: "Axes", x: Floats, residual: Floats, colour: str) -> None:
    """Means with two standard errors at set-points, or a smooth where x takes values all along."""
    there = ~(np.isnan(x) | np.isnan(residual))
    x, residual = x[there], residual[there]
    if x.size == 0:
        return
    classes = set_points(x, 0.02 * float(x.max() - x.min()))
    # Fewer than two samples at each on average are no set-points.
    if len(classes) < 2 or x.size < 2 * len(classes):
        axis.plot(*smooth(x, residual), color=colour, lw=1.6)
        return
    own = [residual[(x >= low) & (x <= high)] for low, high in classes]
    error = [2.0 * part.std(ddof=1) / np.sqrt(part.size) if part.size > 1 else 0.0 for part in own]
    places = [float(x[(x >= low) & (x <= high)].mean()) for low, high in classes]
    axis.errorbar(places, [part.mean() for part in own], yerr=error, fmt="D", color=colour, ms=4.0, lw=1.4, zorder=4)


def steps(diagnosis: "Diagnosis", names: Iterable[str] | None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_steps`."""
    signals = _signals(diagnosis, names)
    places = np.arange(len(diagnosis.steps))
    labels = [f"+ {step.added}" if step.added else "calibrated" for step in diagnosis.steps]
    columns = min(len(signals), 3)
    with _figure(-(-len(signals) // columns), columns, width=max(2.6, 0.9 * len(places) + 1.0), height=2.6) as (figure, axes):
        for axis in axes.flat[len(signals) :]:
            axis.set_visible(False)
        for axis, signal in zip(axes.flat, signals, strict=False):
            fitted = [step.rmse.get(signal, np.nan) for step in diagnosis.steps]
            left_out = [step.heldout_rmse.get(signal, np.nan) for step in diagnosis.steps]
            colours = [_BEFORE] + [_AFTER] * (len(places) - 1)
            bars = axis.bar(places, fitted, width=0.55, color=colours, alpha=0.85)
            for bar, value in zip(bars, fitted, strict=True):
                # At the foot, where neither the floor nor the points lie.
                middle = bar.get_x() + 0.5 * bar.get_width()
                axis.annotate(f"{value:.3g}", (middle, 0.0), (0, 4), textcoords="offset points", ha="center", color="white")
            axis.plot(places, left_out, "D", color=_MEASURED, ms=5, mfc="white", mew=1.4, zorder=4)
            floor = diagnosis.noise_floor[signal].value
            if floor is not None:
                axis.axhline(floor, color=_MEASURED, ls=(0, (4, 2)), lw=1.2, zorder=3)
            axis.set_xticks(places, labels, rotation=20 if len(places) > 2 else 0)
            axis.set_xlim(-0.6, len(places) - 0.4)
            axis.set_ylim(0.0, 1.12 * np.nanmax([*fitted, *left_out, floor or 0.0]))
            axis.yaxis.set_major_locator(MaxNLocator(5))
            axis.grid(axis="x", visible=False)
            axis.set_title(_label(signal, _unit(diagnosis, signal)), loc="left")
        axes[0, 0].set_ylabel("error, rms")
        entries = [_patch("before", _BEFORE, 0.85), _patch("with effects", _AFTER, 0.85)][: len(places)]
        entries.append(_line(_MEASURED, "on left-out data", marker="D", ls="", mfc="white", mew=1.4))
        entries.append(_line(_MEASURED, f"noise floor ({diagnosis.noise_floor_source})", ls=(0, (4, 2))))
        _finish(figure, diagnosis, entries, "Error by step")
        return figure


def candidates(diagnosis: "Diagnosis", most: int) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_candidates`."""
    shown = diagnosis.candidates[:most]
    hidden = len(diagnosis.candidates) - len(shown)
    rows = [(c.effect, c.probability, _candidate_words(c), _colour(diagnosis, c)) for c in shown]
    rows.append(("enough already", diagnosis.share.enough, "no effect is needed", _MEASURED))
    rows.append(("something else", diagnosis.share.other, "none of the candidates", _MEASURED))
    with _figure(1, 1, width=7.2, height=0.9 + 0.27 * len(rows)) as (figure, axes):
        axis = axes[0, 0]
        for place, (name, probability, words, colour) in enumerate(rows):
            y = place + (0.6 if place >= len(shown) else 0.0)
            axis.barh(y, probability, height=0.62, color=colour)
            axis.text(probability + 0.012, y, words, va="center", fontsize=8, color="#555555")
        axis.set_yticks([k + (0.6 if k >= len(shown) else 0.0) for k in range(len(rows))], [row[0] for row in rows])
        axis.invert_yaxis()
        axis.set_xlim(0.0, 1.6)
        axis.set_xticks(np.linspace(0.0, 1.0, 6))
        axis.spines["bottom"].set_bounds(0.0, 1.0)
        axis.grid(axis="y", visible=False)
        axis.set_xlabel("probability" + (f"  ({hidden} less probable candidates not shown)" if hidden else ""))
        entries = [_patch("named", _AFTER, 1.0), _patch("tied", "#56B4E9", 1.0), _patch("not named", _QUIET, 1.0)]
        _finish(figure, diagnosis, entries, "Which effect")
        return figure


def _candidate_words(candidate: "Candidate") -> str:
    words = [f"p {candidate.p_value:.2g}", f"gain {_gain(candidate.gain)}"]
    if candidate.heldout_gain is not None:
        words.append(f"on left-out data {_gain(candidate.heldout_gain)}")
    return ", ".join(words) + ("" if candidate.refitted else " (screened only)")


def _gain(value: float) -> str:
    # A gain of rounding is none; adding 0 turns -0 into 0.
    return f"{round(value, 1) + 0.0:.1f}" if abs(value) < 100.0 else f"{value:.0f}"


def _colour(diagnosis: "Diagnosis", candidate: "Candidate") -> str:
    if candidate.tied:
        return "#56B4E9"
    return _AFTER if candidate.effect in diagnosis.effects else _QUIET


def profiles(diagnosis: "Diagnosis") -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_profiles`."""
    if not diagnosis.profiles:
        why = "it was interrupted before" if diagnosis.interrupted else "no effect was added to the traverse"
        raise InputError(f"this diagnosis has no profiles: {why}")
    known = {parameter.name: parameter for parameter in diagnosis.steps[-1].parameters}
    count = len(diagnosis.profiles)
    columns = min(count, 3)
    with _figure(-(-count // columns), columns, width=2.9, height=2.1) as (figure, axes):
        for axis in axes.flat[count:]:
            axis.set_visible(False)
        for axis, profile in zip(axes.flat, diagnosis.profiles, strict=False):
            parameter = known.get(profile.name)
            _profile(axis, profile.values, profile.rise, profile.interval, parameter)
            unit = "" if parameter is None or parameter.unit == "1" else parameter.unit
            axis.set_xlabel(f"{profile.name} ({unit})" if unit else profile.name)
            axis.xaxis.set_major_locator(MaxNLocator(4))
        for row in axes:
            row[0].set_ylabel("rise of chi-square")
        entries = [_patch("95 % interval", _AFTER), _line(_MEASURED, "value"), _line(_BEFORE, "bound", ls=":")]
        _finish(figure, diagnosis, entries, "How well each parameter is known")
        return figure


def _profile(
    axis: "Axes",
    values: Floats,
    rise: Floats,
    interval: tuple[float | None, float | None],
    parameter: "Parameter | None",
) -> None:
    low, high = float(values.min()), float(values.max())
    margin = 0.06 * (high - low) or 1e-3 * max(abs(high), 1e-9)
    axis.set_xlim(low - margin, high + margin)
    ends = [end if end is not None else edge for end, edge in zip(interval, (low, high), strict=True)]
    axis.axvspan(ends[0], ends[1], color=_AFTER, alpha=0.15, lw=0)
    axis.axhline(_RISE, color=_QUIET, lw=1.0, ls=(0, (4, 2)))
    if values.size > 2:
        # The root of the rise is nearly straight on either side, so it is what is interpolated.
        place = np.linspace(low, high, 200)
        best = float(values[np.argmin(rise)])
        root = np.interp(place, values, np.where(values < best, -1.0, 1.0) * np.sqrt(rise))
        axis.plot(place, root**2, color=_AFTER, lw=1.6)
    axis.plot(values, rise, "o", color=_AFTER, ms=3.5)
    axis.set_ylim(-0.3, max(2.0 * _RISE, min(4.0 * _RISE, 1.08 * float(rise.max()))))
    if parameter is not None:
        axis.axvline(parameter.value, color=_MEASURED, lw=1.0)
        for bound in (parameter.min, parameter.max):
            if low - margin <= bound <= high + margin:
                axis.axvline(bound, color=_BEFORE, lw=1.6, ls=":")
        error = "" if parameter.deviation is None else f" ± {parameter.deviation:.2g}"
        axis.set_title(f"{parameter.value:.4g}{error}{', on its bound' if parameter.at_bound else ''}", loc="left")


def heatmap(diagnosis: "Diagnosis", signal: str | None, x: str | None, y: str | None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_heatmap`."""
    steady = diagnosis.kind == "single_wheel"
    signal = _signals(diagnosis, None if signal is None else [signal])[0]
    across, up = x or ("slip" if steady else "time"), y or ("load" if steady else "run")
    places, heights = _column(diagnosis, across), _column(diagnosis, up)
    columns, rows = levels(places, most=24), levels(heights, most=24)
    scale = diagnosis.noise_floor[signal].value
    shown = _before_after(diagnosis)
    grids = [
        _grid(places, heights, columns, rows, _values(diagnosis, step.fit, signal, "residual") / (scale or 1.0))
        for step, _, _ in shown
    ]
    size = max(float(np.nanmax(np.abs(grid))) for grid in grids)
    with _figure(1, len(grids), width=3.9, height=1.4 + 0.22 * max(len(rows), 6)) as (figure, axes):
        for column, (axis, grid) in enumerate(zip(axes[0], grids, strict=True)):
            mesh = axis.pcolormesh(grid, cmap="RdBu_r", vmin=-size, vmax=size, edgecolors="white", lw=0.6)
            axis.grid(visible=False)
            _ticks(axis.xaxis, columns)
            _ticks(axis.yaxis, rows, [run.name for run in diagnosis.runs] if up == "run" else None, hidden=column > 0)
            axis.set_xlabel(_label(across, _unit(diagnosis, across)))
            axis.set_title(_step_labels(diagnosis)[column], loc="left")
        axes[0, 0].set_ylabel(_label(up, _unit(diagnosis, up)))
        unit = "standard deviations of the noise" if scale else _unit(diagnosis, signal)
        figure.colorbar(mesh, ax=axes[0, -1], label=f"mean residual, {unit}")
        _finish(figure, diagnosis, [], f"Where {_spoken(signal)} fails")
        return figure


def _grid(x: Floats, y: Floats, columns: list[tuple[float, float]], rows: list[tuple[float, float]], z: Floats) -> Floats:
    """Mean of z by levels of y (rows) and x (columns); NaN where there are no samples."""
    grid = np.full((len(rows), len(columns)), np.nan)
    for i, (low, high) in enumerate(rows):
        for k, (left, right) in enumerate(columns):
            inside = (y >= low) & (y <= high) & (x >= left) & (x <= right) & ~np.isnan(z)
            if inside.any():
                grid[i, k] = z[inside].mean()
    return grid


def _ticks(
    axis: Any, of: list[tuple[float, float]], names: Sequence[str] | None = None, hidden: bool = False
) -> None:
    every = -(-len(of) // 8) if names is None else 1
    places = np.arange(0, len(of), every)
    words = [names[round(of[k][0])] if names else f"{0.5 * (of[k][0] + of[k][1]):.3g}" for k in places]
    axis.set_ticks(places + 0.5, ["" for _ in words] if hidden else words)


# What the figures share.


@contextmanager
def _figure(rows: int, columns: int, width: float, height: float) -> "Iterator[tuple[Figure, NDArray[Any]]]":
    """A figure of equal panels (inches), in the style of the package."""
    with mpl.rc_context(_STYLE):
        # One panel is wide enough for the title and the legend above it.
        size = (max(columns * width + 0.4, 6.4), rows * height + 0.9)
        figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False)
        try:
            yield figure, axes
        except BaseException:
            plt.close(figure)
            raise


def _finish(figure: "Figure", diagnosis: "Diagnosis", entries: list[Any], what: str | None = None) -> None:
    """Title with the verdict, and the legend below it."""
    effects = f": {', '.join(diagnosis.effects)}" if diagnosis.effects else ""
    title = f"{diagnosis.experiment} — {_WORDS[diagnosis.verdict]}{effects}"
    figure.suptitle(f"{what}\n{title}" if what else title, x=0.01, ha="left", fontsize=10.5)
    if entries:
        figure.legend(handles=entries, loc="outside lower center", ncols=min(len(entries), 4), fontsize=8.5)


def _line(colour: Any, label: str, **style: Any) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], **{"color": colour, "label": label, "ms": 5, "lw": 1.6} | style)


def _patch(label: str, colour: str = _QUIET, alpha: float = 0.35) -> Any:
    from matplotlib.patches import Patch

    return Patch(color=colour, alpha=alpha, label=label, lw=0)


def _before_after(diagnosis: "Diagnosis") -> list[tuple[Any, Any, float]]:
    """Baseline and final step with their line styles; the baseline alone where nothing was added."""
    shown = [(diagnosis.steps[0], (0, (3, 2)), 1.2)]
    if len(diagnosis.steps) > 1:
        shown.append((diagnosis.steps[-1], "-", 1.6))  # type: ignore[arg-type]
    return shown


def _step_labels(diagnosis: "Diagnosis") -> list[str]:
    added = [step.added for step in diagnosis.steps if step.added]
    return ["calibrated"] + ([f"with {' and '.join(added)}"] if added else [])


def _step_entries(diagnosis: "Diagnosis", before: str, after: str, dashes: bool = True) -> list[Any]:
    styles = [(before, (0, (3, 2)) if dashes else "-"), (after, "-")]
    return [_line(c, label, ls=ls) for (c, ls), label in zip(styles, _step_labels(diagnosis), strict=False)]


def _share_y(axes: "NDArray[Any]", row: int, column: int) -> None:
    if column > 0:
        axes[row, column].sharey(axes[row, 0])
        axes[row, column].tick_params(labelleft=False)


def _signals(diagnosis: "Diagnosis", names: Iterable[str] | None) -> list[str]:
    """The signals asked for, else those whose baseline error is largest in units of the noise."""
    rmse = diagnosis.steps[0].rmse
    if names is not None:
        chosen = [names] if isinstance(names, str) else list(names)
        for name in chosen:
            if name not in rmse:
                raise unknown("measured signal", name, rmse)
        return chosen
    size = {name: error / (diagnosis.noise_floor[name].value or error or 1.0) for name, error in rmse.items()}
    return sorted(size, key=lambda name: -size[name])[:_MOST_SIGNALS]


def _conditions(diagnosis: "Diagnosis") -> list[str]:
    if diagnosis.kind == "single_wheel":
        names = ["slip", "load", "wheel_speed"]
    else:
        names = ["time", *diagnosis.runs[0].inputs[:1], "x", "pitch"]
    known = {name for run in diagnosis.runs for name in run.columns}
    varied = [name for name in names if name in known and np.nanmax(c := _column(diagnosis, name)) > np.nanmin(c)]
    return varied or names[:1]


def _column(diagnosis: "Diagnosis", name: str) -> Floats:
    """A column of all runs end to end, or the number of the run; NaN where a run does not have it."""
    if name == "run":
        parts = [np.full(_rows(run.columns), float(k)) for k, run in enumerate(diagnosis.runs)]
    else:
        known = list(dict.fromkeys(column for run in diagnosis.runs for column in run.columns))
        if name not in known:
            raise unknown("column", name, [*known, "run"])
        parts = _column_by_run(diagnosis, name)
    return np.concatenate(parts)


def _rows(columns: dict[str, Floats]) -> int:
    return len(next(iter(columns.values())))


def _values(diagnosis: "Diagnosis", fit: Fit, signal: str, column: str) -> Floats:
    """Values of a fit in the rows of :func:`_column`; NaN where a run does not measure the signal."""
    parts = [
        getattr(signals[signal], column) if signal in signals else np.full(_rows(run.columns), np.nan)
        for run, (_, signals) in zip(diagnosis.runs, fit.runs, strict=True)
    ]
    return np.concatenate(parts)


def _repeats(diagnosis: "Diagnosis") -> list[tuple[str, list[int]]]:
    """Runs by group; a run without one stands alone."""
    sets: dict[str, list[int]] = {}
    for k, run in enumerate(diagnosis.runs):
        sets.setdefault(f"group {run.group}" if run.group is not None else run.name, []).append(k)
    return list(sets.items())


def _unit(diagnosis: "Diagnosis", name: str) -> str:
    if diagnosis.kind == "single_wheel" or name in ("time", "run"):
        return _UNITS.get(name, "")
    if name.endswith("_command"):
        return "rad/s" if "speed" in name else "N m"
    units = {variable["name"]: variable["unit"] for variable in diagnosis.improved.signals()}
    unit = units.get(name, "")
    return "" if unit == "1" else unit.replace(".", " ")


def _spoken(name: str) -> str:
    return name.replace("_", " ")


def _label(name: str, unit: str) -> str:
    return f"{_spoken(name)} ({unit})" if unit else _spoken(name)
