"""Measurements that are not on disk: an :class:`Experiment` from data frames or arrays."""

import csv
import io
import os
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bekker, toml_text
from .errors import InputError

__all__ = ["Columns", "Experiment", "ExperimentLike", "MeasuredRun", "Quantity"]

Columns: TypeAlias = Any
"""A pandas or polars frame, a mapping from name to array, or a structured numpy array: named columns of one length."""

Cells: TypeAlias = NDArray[np.float64] | list[str]
"""A column: numbers, NaN where nothing was measured, or labels, empty where there is none."""

Table: TypeAlias = list[tuple[str, Cells]]
"""Columns with their names."""

Arrays: TypeAlias = tuple[str, dict[str, Table]]
"""What the native side reads: settings as in ``experiment.toml``, and the tables that they name."""

Quantity: TypeAlias = float | Mapping[str, float | str]
"""A number in SI units, or ``{"value": 3.0, "unit": "kPa"}``."""


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """One recording. Columns carry the model's own names, SI units; NaN (or None, NA) where nothing was measured.

    Other names and units are mapped by ``columns`` of the :class:`Experiment`. A single wheel needs ``load`` (N), ``slip`` and ``wheel_speed`` (rad/s) and any of ``drawbar_pull`` (N), ``torque``
    (N m), ``sinkage`` (m), one steady point a row; ``condition`` may label rows that repeat one set-point. A traverse
    needs ``time`` (s), ``wheel[k].speed_command`` (rad/s) or ``wheel[k].torque_command`` (N m), and any signals; where no command
    was recorded, the measured ``wheel[k].speed`` of every wheel drives the rover and is not compared.
    """

    data: Columns
    name: str | None = None
    """Name for people; ``run1``, ``run2`` ... where None."""
    group: str | None = None
    """Runs of a group repeat the same inputs; rows pair by index."""
    terrain: tuple[ArrayLike, ArrayLike] | None = None
    """Traverse: the ground, x (increasing) and z, m; flat where None."""
    x0: float | None = None
    """Traverse: where the rover starts, m."""
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    """What was changed for this run, by the model's names."""


@dataclass(frozen=True, eq=False)
class Experiment:
    """Measurements, what they were made with and what is known of their noise; checked as strictly as a folder.

    Raises:
        InputError: names run, row (from 0) and column, and what was expected.
    """

    kind: Literal["single_wheel", "traverse", "plate_sinkage", "shear"]
    runs: Sequence[MeasuredRun | Columns]
    """Runs, or their columns alone."""
    name: str = "experiment"
    parameters: Mapping[str, Quantity] = field(default_factory=dict)
    """What is known of the rig, by the model's names; the rest keeps the model's value or is calibrated."""
    priors: Mapping[str, float | tuple[float, float] | Mapping[str, float | str]] = field(default_factory=dict)
    """What a separate test says of a parameter: (mean, standard deviation), ``{"mean": 31.0, "sd": 2.0, "unit": "deg"}``,
    or a standard deviation alone about the value in ``parameters``."""
    noise: Mapping[str, Quantity] = field(default_factory=dict)
    """Standard deviation of one sample by signal, where repeats do not tell it."""
    sensors: Mapping[str, Mapping[str, float | tuple[float, float] | Mapping[str, float | str]]] = field(default_factory=dict)
    """Traverse: what may be wrong with the sensor of a signal, which every fit finds with its prior: ``{"velocity": {"delay": 0.05}}``.
    The record is ``gain * signal(t - delay) + bias``; each of ``delay`` (s), ``gain`` and ``bias`` (in the signal's unit) has a prior as
    in ``priors``, about a perfect sensor where it has no mean."""
    ignore: Sequence[str] = ()
    """Columns that are not for the model; a ``*`` at the end stands for any end of a name."""
    columns: Mapping[str, str | Mapping[str, Any]] = field(default_factory=dict)
    """Columns that are called otherwise, or are not in SI units: the name of a signal, or a table such as
    ``{"signal": "drawbar_pull", "unit": "kN", "sign": -1}``, ``{"signal": "current", "wheels": [1, 2]}``,
    ``{"parameter": "grousers.height", "unit": "mm"}``, ``{"time_stamp": True}``, ``{"run": True}``,
    ``{"signal": "current", "wheels": [1, 2], "side": "left", "magnitude": True}``; the keys are those of
    ``[columns]`` on the page ``examples/experiments.md``."""
    inputs: Mapping[str, Quantity] = field(default_factory=dict)
    """Inputs that no column gives since they are the same in all rows."""
    soil_class: str | None = None
    """Class of the soil, whose priors stand in for tests that were not made."""
    model: str | None = None
    """The vehicle: a built-in model or a model file."""
    shared: Mapping[Literal["soil", "vehicle", "drive"], str] = field(default_factory=dict)
    """Names of what it has in common with other experiments: where several are fitted together, those that name a soil, a vehicle (wheels,
    masses and drive) or a drive (motor and gear) alike have one and the same."""
    signals: tuple[str, ...] = field(init=False)
    """Names of the measured signals."""
    doubts: tuple[str, ...] = field(init=False)
    """Signs, units and sizes that are allowed but unlikely, each with what would mend it."""
    _source: Arrays = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # With the settings of a folder, so that one set of checks serves both.
        arrays = _arrays(self)
        signals, doubts = _bekker.check_experiment(arrays)
        object.__setattr__(self, "_source", arrays)
        object.__setattr__(self, "signals", tuple(signals))
        object.__setattr__(self, "doubts", tuple(doubts))

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the experiment as a folder, for the command line; numbers keep their bits.

        Raises:
            FileExistsError: the folder holds an experiment already.
            OSError: a file cannot be written.
        """
        root = Path(folder)
        if (root / "experiment.toml").exists():
            raise FileExistsError(f"{root} holds an experiment already")
        settings, tables = self._source
        for name, text in {"experiment.toml": settings, **{name: _csv(table) for name, table in tables.items()}}.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="")


ExperimentLike: TypeAlias = Experiment | str | os.PathLike[str]
"""The folder with ``experiment.toml``, or an :class:`Experiment`."""


def source(experiment: ExperimentLike) -> str | Arrays:
    """What the native side takes for an experiment."""
    if isinstance(experiment, Experiment):
        return experiment._source
    if isinstance(experiment, (str, os.PathLike)):
        return os.fspath(experiment)
    raise InputError(f"experiment: expected a folder or a bekker.Experiment, found {type(experiment).__name__}")


def sources(experiments: ExperimentLike | Sequence[ExperimentLike]) -> str | Arrays | list[str | Arrays]:
    """What the native side takes for one experiment, or for several on one soil."""
    if isinstance(experiments, Sequence) and not isinstance(experiments, str):
        return [source(experiment) for experiment in experiments]
    return source(experiments)


def together_of(
    experiments: ExperimentLike | Sequence[ExperimentLike], scatter: float | None, share: Iterable[str] | None
) -> tuple[float | None, list[str] | None]:
    """What is said of several experiments: the scatter of the soil between them, and what they share.

    Raises:
        InputError: there is one experiment only, or it is no number, or no names.
    """
    several = isinstance(experiments, Sequence) and not isinstance(experiments, str)
    if scatter is not None:
        if not several:
            raise InputError("soil_scatter: expected several experiments; it says how their soils differ")
        if isinstance(scatter, bool) or not isinstance(scatter, (int, float)):
            raise InputError(f"soil_scatter: expected a share from 0 to 0.5, found {scatter!r}")
        scatter = float(scatter)
    if share is None:
        return scatter, None
    if not several:
        raise InputError("share: expected several experiments; it says what they have in common")
    names = list(share)
    if isinstance(share, str) or not all(isinstance(name, str) for name in names):
        raise InputError(f"share: expected some of 'soil', 'vehicle', 'drive' in a list, found {share!r}")
    return scatter, names


def _arrays(experiment: Experiment) -> Arrays:
    lines = [f"name = {toml_text.text(experiment.name)}", f"kind = {toml_text.text(experiment.kind)}"]
    lines.append(f"ignore = [{', '.join(toml_text.text(name) for name in experiment.ignore)}]")
    if experiment.model is not None:
        lines.append(f"model = {toml_text.text(experiment.model)}")
    if experiment.soil_class is not None:
        lines.append(f"soil.class = {toml_text.text(experiment.soil_class)}")
    lines += ["[shared]", *(f"{toml_text.text(name)} = {toml_text.text(value)}" for name, value in experiment.shared.items())]
    # A saved folder is written plainly: nothing is to be found out, and no label is a comment.
    lines += ["[file]", 'separator = ","', 'decimal = "."', "comment = []"]
    for table in ("parameters", "noise", "inputs"):
        lines += [f"[{table}]", *toml_text.numbers(table, getattr(experiment, table))]
    lines += ["[priors]", *toml_text.numbers("priors", _priors(experiment.priors))]
    lines += ["[sensors]", *_sensors(experiment.sensors)]
    lines += ["[columns]", *_mapped(experiment.columns)]
    labels = {"condition"} | {name for name, entry in experiment.columns.items() if _is_label(entry)}
    tables: dict[str, Table] = {}
    for k, given in enumerate(experiment.runs):
        run = given if isinstance(given, MeasuredRun) else MeasuredRun(given)
        name = run.name or f"run{k + 1}"
        parts = Path(name).parts
        if Path(name).is_absolute() or ".." in parts:
            raise InputError(f"run `{name}`: expected a name, or a path below the experiment's folder")
        if f"{name}.csv" in tables:
            raise InputError(f"two runs are called `{name}`")
        tables[f"{name}.csv"] = _table(name, _columns(name, run.data), experiment.ignore, labels)
        lines += ["[[run]]", f"file = {toml_text.text(f'{name}.csv')}"]
        if run.group is not None:
            lines.append(f"group = {toml_text.text(str(run.group))}")
        if run.terrain is not None:
            x, z = _ground(name, run.terrain)
            tables[f"{name}.terrain.csv"] = _table(f"{name}` terrain", {"x": x, "z": z}, (), ())
            lines.append(f"terrain = {toml_text.text(f'{name}.terrain.csv')}")
        if run.x0 is not None:
            lines.append(f"x0 = {toml_text.number(f'run `{name}`, x0', run.x0)}")
        own = toml_text.numbers(f"run `{name}`, parameters", run.parameters)
        lines.append(f"parameters = {{ {', '.join(own)} }}")
    return "\n".join(lines) + "\n", tables


def _ground(name: str, terrain: tuple[ArrayLike, ArrayLike]) -> tuple[ArrayLike, ArrayLike]:
    if isinstance(terrain, tuple) and len(terrain) == 2:
        return terrain
    raise InputError(f"run `{name}`, terrain: expected a pair of arrays (x, z), m")


def _priors(priors: Mapping[str, Any]) -> Mapping[str, Any]:
    """With pairs as tables of mean and standard deviation."""
    if not isinstance(priors, Mapping):
        return priors
    return {name: _prior(prior) for name, prior in priors.items()}


def _prior(prior: Any) -> Any:
    if isinstance(prior, (tuple, list)) and len(prior) == 2:
        return {"mean": prior[0], "sd": prior[1]}
    return prior


def _sensors(sensors: Mapping[str, Any]) -> list[str]:
    if not isinstance(sensors, Mapping):
        raise InputError(f"sensors: expected a mapping from signal to its errors, found {type(sensors).__name__}")
    for name, errors in sensors.items():
        if not isinstance(errors, Mapping):
            expected = 'expected a mapping such as {"delay": 0.05}'
            raise InputError(f"sensors, `{name}`: {expected}, found {type(errors).__name__}")
    entries = {name: _priors(errors) for name, errors in sensors.items()}
    return [f"{toml_text.text(name)} = {toml_text.value(f'sensors, `{name}`', entry)}" for name, entry in entries.items()]


def _mapped(columns: Mapping[str, str | Mapping[str, Any]]) -> list[str]:
    if not isinstance(columns, Mapping):
        raise InputError(f"columns: expected a mapping from column to signal, found {type(columns).__name__}")
    return [f"{toml_text.text(name)} = {toml_text.value(f'columns, `{name}`', entry)}" for name, entry in columns.items()]


def _is_label(entry: object) -> bool:
    """Whether a column's cells are texts: of set-points, of runs, of time."""
    if isinstance(entry, Mapping):
        return entry.get("signal") == "condition" or entry.get("time_stamp") is True or entry.get("run") is True
    return entry == "condition"


def _columns(run: str, data: Columns) -> dict[str, Any]:
    """Columns by name, whatever holds them."""
    names: Iterable[Any] | None
    if isinstance(data, np.ndarray):
        names = data.dtype.names
    else:
        names = getattr(data, "columns", None) if not isinstance(data, Mapping) else data.keys()
    if names is None:
        expected = "expected a data frame, a mapping from name to array or a structured array"
        raise InputError(f"run `{run}`: {expected}, found {type(data).__name__}")
    found: dict[str, Any] = {}
    for name in names:
        if not isinstance(name, str):
            raise InputError(f"run `{run}`: column {name!r}: expected a text for a name")
        if name in found:
            raise InputError(f"run `{run}`, column `{name}`: this column appears twice")
        found[name] = data[name]
    if not found:
        raise InputError(f"run `{run}`: no columns")
    return found


def _table(run: str, columns: Mapping[str, Any], ignore: Sequence[str], labels: Container[str]) -> Table:
    table = [(name, _cells(run, name, column, ignore, labels)) for name, column in columns.items() if name not in ignore]
    for name, column in table:
        first, expected = table[0][0], len(table[0][1])
        if len(column) != expected:
            raise InputError(f"run `{run}`, column `{name}`: {len(column)} rows where `{first}` has {expected}")
    return table


def _csv(table: Table) -> str:
    """Numbers read back to the same bits; what is missing is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(name for name, _ in table)
    plain = ([_text(cell) for cell in (cells if isinstance(cells, list) else cells.tolist())] for _, cells in table)
    writer.writerows(zip(*plain, strict=True))
    return text.getvalue()


def _text(cell: str | float) -> str:
    if isinstance(cell, str):
        return cell
    return "" if cell != cell else repr(cell)


def _cells(run: str, name: str, column: Any, ignore: Sequence[str], labels: Container[str]) -> Cells:
    if name in labels:
        return _labels(run, name, column)
    try:
        return _numbers(run, name, column)
    except InputError:
        # A pattern of `ignore` leaves out only what is no signal, which is decided where signals are known.
        if any(entry.endswith("*") and name.startswith(entry[:-1]) for entry in ignore):
            return _labels(run, name, column)
        raise


def _numbers(run: str, name: str, column: Any) -> NDArray[np.float64]:
    try:
        return _array(column)
    except (TypeError, ValueError) as error:
        raise InputError(f"run `{run}`, column `{name}`: expected one number a row: {error}") from None


def _array(column: Any) -> NDArray[np.float64]:
    if isinstance(column, np.ma.MaskedArray):
        column = np.ma.filled(column.astype(np.float64), np.nan)
    plain = np.asarray(column)
    if plain.ndim != 1:
        raise ValueError(f"the shape is {plain.shape}")
    if plain.dtype.kind == "O":
        # None and the NA of nullable columns, which do not equal themselves or anything else.
        present = [np.nan if value is None or value is _na(value) else value for value in plain]
        if texts := [value for value in present if isinstance(value, str)]:
            raise ValueError(f"found the text {texts[0]!r}")
        return np.array(present, dtype=np.float64)
    if plain.dtype.kind not in "fiu":
        raise ValueError(f"the type is {plain.dtype}")
    return plain.astype(np.float64)


def _na(value: Any) -> Any:
    """The value itself where it is pandas' NA, without importing pandas."""
    return value if type(value).__name__ == "NAType" else None


def _labels(run: str, name: str, column: Any) -> list[str]:
    plain = np.asarray(column)
    if plain.dtype.kind == "M":
        # Dates, which as objects would lose nanoseconds or become counts of them.
        plain = np.where(np.isnat(plain), "", np.datetime_as_string(plain))
    values = np.asarray(plain, dtype=object)
    if values.ndim != 1:
        raise InputError(f"run `{run}`, column `{name}`: expected one label a row, the shape is {values.shape}")
    missing = (value is None or value is _na(value) or value != value for value in values)
    return ["" if gone else str(value) for gone, value in zip(missing, values, strict=True)]
