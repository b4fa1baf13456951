"""How figures look: colours, panels, titles, legends and labels."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from matplotlib import pyplot as plt
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..diagnosed import Diagnosis

# Of the palette of Okabe and Ito, which people with any colour vision tell apart.
MEASURED, BEFORE, AFTER, QUIET = "#333333", "#D55E00", "#0072B2", "#9A9A9A"
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

_WORDS = {
    "explained": "explained: nothing but noise is left",
    "effect_missing": "missing effect",
    "unexplained": "unexplained structure",
    "undetermined": "undetermined",
}


@contextmanager
def figure(rows: int, columns: int, width: float, height: float) -> "Iterator[tuple[Figure, NDArray[Any]]]":
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


def finish(figure: "Figure", diagnosis: "Diagnosis", entries: list[Any], what: str | None = None) -> None:
    """Title with the verdict, and the legend below it."""
    effects = f": {', '.join(diagnosis.effects)}" if diagnosis.effects else ""
    title = f"{diagnosis.experiment} — {_WORDS[diagnosis.verdict]}{effects}"
    figure.suptitle(f"{what}\n{title}" if what else title, x=0.01, ha="left", fontsize=10.5)
    if entries:
        figure.legend(handles=entries, loc="outside lower center", ncols=min(len(entries), 4), fontsize=8.5)


def line(colour: Any, label: str, **style: Any) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], **{"color": colour, "label": label, "ms": 5, "lw": 1.6} | style)


def patch(label: str, colour: str = QUIET, alpha: float = 0.35) -> Any:
    from matplotlib.patches import Patch

    return Patch(color=colour, alpha=alpha, label=label, lw=0)


def before_after(diagnosis: "Diagnosis") -> list[tuple[Any, Any, float]]:
    """Baseline and final step with their line styles; the baseline alone where nothing was added."""
    shown = [(diagnosis.steps[0], (0, (3, 2)), 1.2)]
    if len(diagnosis.steps) > 1:
        shown.append((diagnosis.steps[-1], "-", 1.6))  # type: ignore[arg-type]
    return shown


def step_labels(diagnosis: "Diagnosis") -> list[str]:
    added = [step.added for step in diagnosis.steps if step.added]
    return ["calibrated"] + ([f"with {' and '.join(added)}"] if added else [])


def step_entries(diagnosis: "Diagnosis", before: str, after: str, dashes: bool = True) -> list[Any]:
    styles = [(before, (0, (3, 2)) if dashes else "-"), (after, "-")]
    return [line(c, label, ls=ls) for (c, ls), label in zip(styles, step_labels(diagnosis), strict=False)]


def share_y(axes: "NDArray[Any]", row: int, column: int) -> None:
    if column > 0:
        axes[row, column].sharey(axes[row, 0])
        axes[row, column].tick_params(labelleft=False)


def spoken(name: str) -> str:
    return name.replace("_", " ")


def label(name: str, unit: str) -> str:
    return f"{spoken(name)} ({unit})" if unit else spoken(name)
