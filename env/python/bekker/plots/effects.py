"""Which effect, and how well its parameters are known."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MaxNLocator

from ..errors import InputError
from ..levels import Floats
from . import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..diagnosed import Diagnosis
    from ..findings import Candidate, Parameter

# 95 % point of chi-square with one degree of freedom: where a profile's interval ends.
_RISE = 3.841


def candidates(diagnosis: "Diagnosis", most: int) -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_candidates`."""
    shown = diagnosis.candidates[:most]
    hidden = len(diagnosis.candidates) - len(shown)
    rows = [(c.effect, c.probability, _candidate_words(c), _colour(diagnosis, c)) for c in shown]
    rows.append(("enough already", diagnosis.share.enough, "no effect is needed", style.MEASURED))
    rows.append(("something else", diagnosis.share.other, "none of the candidates", style.MEASURED))
    with style.figure(1, 1, width=7.2, height=0.9 + 0.27 * len(rows)) as (figure, axes):
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
        colours = {"named": style.AFTER, "tied": "#56B4E9", "not named": style.QUIET}
        entries = [style.patch(label, colour, 1.0) for label, colour in colours.items()]
        style.finish(figure, diagnosis, entries, "Which effect")
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
    return style.AFTER if candidate.effect in diagnosis.effects else style.QUIET


def profiles(diagnosis: "Diagnosis") -> "Figure":
    """See :meth:`bekker.Diagnosis.plot_profiles`."""
    if not diagnosis.profiles:
        why = "it was interrupted before" if diagnosis.interrupted else "no effect was added to the traverse"
        raise InputError(f"this diagnosis has no profiles: {why}")
    known = {parameter.name: parameter for parameter in diagnosis.steps[-1].parameters}
    count = len(diagnosis.profiles)
    columns = min(count, 3)
    with style.figure(-(-count // columns), columns, width=2.9, height=2.1) as (figure, axes):
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
        entries = [style.patch("95 % interval", style.AFTER), style.line(style.MEASURED, "value")]
        entries.append(style.line(style.BEFORE, "bound", ls=":"))
        style.finish(figure, diagnosis, entries, "How well each parameter is known")
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
    axis.axvspan(ends[0], ends[1], color=style.AFTER, alpha=0.15, lw=0)
    axis.axhline(_RISE, color=style.QUIET, lw=1.0, ls=(0, (4, 2)))
    if values.size > 2:
        # The root of the rise is nearly straight on either side, so it is what is interpolated.
        place = np.linspace(low, high, 200)
        best = float(values[np.argmin(rise)])
        root = np.interp(place, values, np.where(values < best, -1.0, 1.0) * np.sqrt(rise))
        axis.plot(place, root**2, color=style.AFTER, lw=1.6)
    axis.plot(values, rise, "o", color=style.AFTER, ms=3.5)
    axis.set_ylim(-0.3, max(2.0 * _RISE, min(4.0 * _RISE, 1.08 * float(rise.max()))))
    if parameter is not None:
        axis.axvline(parameter.value, color=style.MEASURED, lw=1.0)
        for bound in (parameter.min, parameter.max):
            if low - margin <= bound <= high + margin:
                axis.axvline(bound, color=style.BEFORE, lw=1.6, ls=":")
        error = "" if parameter.deviation is None else f" ± {parameter.deviation:.2g}"
        note = ", left off" if parameter.left_off else ", on its bound" if parameter.at_bound else ""
        axis.set_title(f"{parameter.value:.4g}{error}{note}", loc="left")
