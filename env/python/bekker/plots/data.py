"""What figures show of a diagnosis: signals, conditions, columns of the runs, and their units."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ..comparison import Fit
from ..levels import Floats
from ..vocabulary import unknown

if TYPE_CHECKING:
    from ..diagnosed import Diagnosis

# More panels than this no page holds.
_MOST_SIGNALS = 6

_UNITS = {
    "load": "N",
    "slip": "",
    "wheel_speed": "rad/s",
    "drawbar_pull": "N",
    "torque": "N m",
    "sinkage": "m",
    "time": "s",
}


def signals(diagnosis: "Diagnosis", names: Iterable[str] | None) -> list[str]:
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


def conditions(diagnosis: "Diagnosis") -> list[str]:
    if diagnosis.kind == "single_wheel":
        names = ["slip", "load", "wheel_speed"]
    else:
        names = ["time", *diagnosis.runs[0].inputs[:1], "x", "pitch"]
    known = {name for run in diagnosis.runs for name in run.columns}
    varied = [name for name in names if name in known and np.nanmax(c := column(diagnosis, name)) > np.nanmin(c)]
    return varied or names[:1]


def column(diagnosis: "Diagnosis", name: str) -> Floats:
    """A column of all runs end to end, or the number of the run; NaN where a run does not have it."""
    if name == "run":
        parts = [np.full(rows(run.columns), float(k)) for k, run in enumerate(diagnosis.runs)]
    else:
        known = list(dict.fromkeys(column for run in diagnosis.runs for column in run.columns))
        if name not in known:
            raise unknown("column", name, [*known, "run"])
        parts = column_by_run(diagnosis, name)
    return np.concatenate(parts)


def column_by_run(diagnosis: "Diagnosis", name: str) -> list[Floats]:
    """A column of each run; NaN where a run does not have it."""
    return [run.columns.get(name, np.full(rows(run.columns), np.nan)) for run in diagnosis.runs]


def at(columns: list[Floats], rows: list[tuple[int, int]]) -> Floats:
    return np.array([columns[run][row] for run, row in rows])


def rows(columns: dict[str, Floats]) -> int:
    return len(next(iter(columns.values())))


def values(diagnosis: "Diagnosis", fit: Fit, signal: str, column: str) -> Floats:
    """Values of a fit in the rows of :func:`_column`; NaN where a run does not measure the signal."""
    parts = [
        getattr(signals[signal], column) if signal in signals else np.full(rows(run.columns), np.nan)
        for run, (_, signals) in zip(diagnosis.runs, fit.runs, strict=True)
    ]
    return np.concatenate(parts)


def repeats(diagnosis: "Diagnosis") -> list[tuple[str, list[int]]]:
    """Runs by group; a run without one stands alone."""
    sets: dict[str, list[int]] = {}
    for k, run in enumerate(diagnosis.runs):
        sets.setdefault(f"group {run.group}" if run.group is not None else run.name, []).append(k)
    return list(sets.items())


def unit(diagnosis: "Diagnosis", name: str) -> str:
    if diagnosis.kind == "single_wheel" or name in ("time", "run"):
        return _UNITS.get(name, "")
    if name.endswith("_command"):
        return "rad/s" if "speed" in name else "N m"
    units = {variable["name"]: variable["unit"] for variable in diagnosis.improved.signals()}
    unit = units.get(name, "")
    return "" if unit == "1" else unit.replace(".", " ")
