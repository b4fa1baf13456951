"""The model's errors: residuals along the conditions, errors by step, and where a signal fails."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from ..levels import Floats, levels, set_points, smooth
from . import data, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..diagnosed import Diagnosis


def residuals(diagnosis: "Diagnosis", names: Iterable[str] | None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_residuals`."""
    signals, conditions = data.signals(diagnosis, names), data.conditions(diagnosis)
    with style.figure(len(signals), len(conditions), width=3.0, height=2.0) as (figure, axes):
        for row, signal in enumerate(signals):
            noise = diagnosis.noise[signal].deviation if signal in diagnosis.noise else None
            for column, condition in enumerate(conditions):
                axis, x = axes[row, column], data.column(diagnosis, condition)
                if noise is not None:
                    axis.axhspan(-2.0 * noise, 2.0 * noise, color=style.QUIET, alpha=0.22, lw=0)
                axis.axhline(0.0, color=style.MEASURED, lw=0.8)
                for (step, _, _), colour in zip(style.before_after(diagnosis), (style.BEFORE, style.AFTER), strict=False):
                    residual = data.values(diagnosis, step.fit, signal, "residual")
                    size = 6.0 if x.size < 2000 else 1.5
                    axis.scatter(x, residual, s=size, color=colour, alpha=0.3, lw=0, rasterized=x.size > 2000)
                    _average(axis, x, residual, colour)
                style.share_y(axes, row, column)
            axes[row, 0].set_ylabel(style.label(signal, data.unit(diagnosis, signal)))
        for axis, condition in zip(axes[-1], conditions, strict=True):
            axis.set_xlabel(style.label(condition, data.unit(diagnosis, condition)))
        entries = style.step_entries(diagnosis, style.BEFORE, style.AFTER, dashes=False)
        if diagnosis.noise:
            entries.append(style.patch("± 2 noise"))
        style.finish(figure, diagnosis, entries, "Measured minus modelled")
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
    signals = data.signals(diagnosis, names)
    places = np.arange(len(diagnosis.steps))
    labels = [f"+ {step.added}" if step.added else "calibrated" for step in diagnosis.steps]
    columns = min(len(signals), 3)
    with style.figure(-(-len(signals) // columns), columns, width=max(2.6, 0.9 * len(places) + 1.0), height=2.6) as (figure, axes):
        for axis in axes.flat[len(signals) :]:
            axis.set_visible(False)
        for axis, signal in zip(axes.flat, signals, strict=False):
            fitted = [step.rmse.get(signal, np.nan) for step in diagnosis.steps]
            left_out = [step.heldout_rmse.get(signal, np.nan) for step in diagnosis.steps]
            colours = [style.BEFORE] + [style.AFTER] * (len(places) - 1)
            bars = axis.bar(places, fitted, width=0.55, color=colours, alpha=0.85)
            for bar, value in zip(bars, fitted, strict=True):
                # At the foot, where neither the floor nor the points lie.
                middle = bar.get_x() + 0.5 * bar.get_width()
                axis.annotate(f"{value:.3g}", (middle, 0.0), (0, 4), textcoords="offset points", ha="center", color="white")
            axis.plot(places, left_out, "D", color=style.MEASURED, ms=5, mfc="white", mew=1.4, zorder=4)
            floor = diagnosis.noise_floor[signal].value
            if floor is not None:
                axis.axhline(floor, color=style.MEASURED, ls=(0, (4, 2)), lw=1.2, zorder=3)
            axis.set_xticks(places, labels, rotation=20 if len(places) > 2 else 0)
            axis.set_xlim(-0.6, len(places) - 0.4)
            axis.set_ylim(0.0, 1.12 * np.nanmax([*fitted, *left_out, floor or 0.0]))
            axis.yaxis.set_major_locator(MaxNLocator(5))
            axis.grid(axis="x", visible=False)
            axis.set_title(style.label(signal, data.unit(diagnosis, signal)), loc="left")
        axes[0, 0].set_ylabel("error, rms")
        entries = [style.patch("before", style.BEFORE, 0.85), style.patch("with effects", style.AFTER, 0.85)][: len(places)]
        entries.append(style.line(style.MEASURED, "on left-out data", marker="D", ls="", mfc="white", mew=1.4))
        entries.append(style.line(style.MEASURED, f"noise floor ({diagnosis.noise_floor_source})", ls=(0, (4, 2))))
        style.finish(figure, diagnosis, entries, "Error by step")
        return figure


def heatmap(diagnosis: "Diagnosis", signal: str | None, x: str | None, y: str | None) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_heatmap`."""
    steady = diagnosis.kind == "single_wheel"
    signal = data.signals(diagnosis, None if signal is None else [signal])[0]
    across, up = x or ("slip" if steady else "time"), y or ("load" if steady else "run")
    places, heights = data.column(diagnosis, across), data.column(diagnosis, up)
    columns, rows = levels(places, most=24), levels(heights, most=24)
    scale = diagnosis.noise_floor[signal].value
    shown = style.before_after(diagnosis)
    grids = [
        _grid(places, heights, columns, rows, data.values(diagnosis, step.fit, signal, "residual") / (scale or 1.0))
        for step, _, _ in shown
    ]
    size = max(float(np.nanmax(np.abs(grid))) for grid in grids)
    with style.figure(1, len(grids), width=3.9, height=1.4 + 0.22 * max(len(rows), 6)) as (figure, axes):
        for column, (axis, grid) in enumerate(zip(axes[0], grids, strict=True)):
            mesh = axis.pcolormesh(grid, cmap="RdBu_r", vmin=-size, vmax=size, edgecolors="white", lw=0.6)
            axis.grid(visible=False)
            _ticks(axis.xaxis, columns)
            _ticks(axis.yaxis, rows, [run.name for run in diagnosis.runs] if up == "run" else None, hidden=column > 0)
            axis.set_xlabel(style.label(across, data.unit(diagnosis, across)))
            axis.set_title(style.step_labels(diagnosis)[column], loc="left")
        axes[0, 0].set_ylabel(style.label(up, data.unit(diagnosis, up)))
        unit = "standard deviations of the noise" if scale else data.unit(diagnosis, signal)
        figure.colorbar(mesh, ax=axes[0, -1], label=f"mean residual, {unit}")
        style.finish(figure, diagnosis, [], f"Where {style.spoken(signal)} fails")
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
