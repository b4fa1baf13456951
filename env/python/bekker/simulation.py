"""Whole runs: :func:`simulate` and its :class:`Result`."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bekker
from ._bekker import Model
from .errors import InputError, ModelError
from .models import ModelLike, as_model
from .vocabulary import unknown

__all__ = ["Inputs", "Result", "simulate", "steady_points"]

Floats: TypeAlias = NDArray[np.float64]
Inputs: TypeAlias = Mapping[str, ArrayLike] | Callable[[float], Mapping[str, float] | Sequence[float] | Floats]
"""By name, constants or one value an interval; or a function of time that gives them by name or in order."""

# A decimal fraction such as 0.02/0.002 is off a whole number by rounding only.
_WHOLE = 1e-9


class Result(Mapping[str, Floats]):
    """Signals of a run: ``result["velocity"]`` is an array with one value an instant of ``result.time``.

    Attributes:
        time: instants, s; the first is the start.
        units: SI unit of every entry, ``time`` included.
        status: ``"running"`` where the run lasted to the end of its time, else the id of the event that
            ended it: ``stuck``, ``tipped_over``, ``belly_contact``, ``left_terrain`` or ``sunk_to_axle``.
        event: that event in words, None where there was none.
    """

    def __init__(self, columns: dict[str, Floats], units: dict[str, str], status: str, event: str | None) -> None:
        self._columns = columns
        self.time = columns["time"]
        self.units = units
        self.status = status
        self.event = event

    def __getitem__(self, name: str) -> Floats:
        try:
            return self._columns[name]
        except KeyError:
            raise unknown("signal", name, self._columns) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        ended = self.event or "ran to its end"
        return f"<bekker.Result {len(self)} signals, {len(self.time)} instants to t = {self.time[-1]:g} s; {ended}>"


def simulate(
    model: ModelLike = "gentle_rtc",
    duration: float | None = None,
    inputs: Inputs | None = None,
    period: float | None = None,
    parameters: Mapping[str, float] | None = None,
) -> Result:
    """Runs a model from rest and records its signals.

    The interpreter is free for other threads meanwhile, and Ctrl-C works.

    Args:
        model: a Model, the name of a preset, TOML text, or the path of a TOML file.
        duration: length of the run, s; the model's own where None.
        inputs: values of the model's inputs (``model.inputs()``), those that are left out keep their starting
            value: a mapping from name to a constant or to an array with one value an interval, or a function of
            time (s) that gives a mapping from name to value, or all values in order. Held over each interval.
        period: interval between two records and two values of the inputs, s; the inner step where None.
        parameters: values by name that replace the model's.

    Returns:
        The signals at the start and after every interval; fewer where an event ended the run.

    Raises:
        UnknownNameError, ModelError: as :func:`bekker.models.as_model`.
        InputError: an input is NaN, out of range or of the wrong length, or the times do not fit the inner step.
        SimulationError: the rover finds no rest on the ground, or the equations or the controller failed.
    """
    own = as_model(model, parameters)
    if own.kind == "carriage":
        raise ModelError(f"`{own.name}` is a wheel on a carriage, which has no motion in time; see bekker.steady_points")
    seconds = own.step_size if period is None else period
    steps = whole("period", seconds, "inner steps", own.step_size)
    intervals = whole("duration", own.duration if duration is None else duration, "periods", seconds)
    time = np.arange(intervals, dtype=np.float64) * steps * own.step_size
    instants, signals, status, event = _bekker.record(own, _table(own, inputs, time), steps)
    described = own.signals()
    columns = {"time": instants} | {v["name"]: np.ascontiguousarray(signals[:, k]) for k, v in enumerate(described)}
    return Result(columns, {"time": "s"} | {v["name"]: v["unit"] for v in described}, status, event)


def steady_points(
    model: ModelLike,
    load: ArrayLike,
    slip: ArrayLike,
    wheel_speed: ArrayLike,
    parameters: Mapping[str, float] | None = None,
) -> dict[str, Floats]:
    """What a carriage measures of a model's wheel: the steady points at a load, a slip and a wheel speed.

    Args:
        model: a wheel on a carriage, or a rover, of which its wheel, soil and effects count.
        load: vertical load, N.
        slip: 1 - V/(r omega) driving, r omega/V - 1 in skid, where -1 is a locked wheel.
        wheel_speed: rad/s; negative backward. All three are numbers or arrays, broadcast against each other.
        parameters: values by name that replace the model's.

    Returns:
        ``drawbar_pull`` (N), ``torque`` (N m, of the drive, its losses included) and ``sinkage`` (m), arrays of the common
        shape.

    Raises:
        UnknownNameError, ModelError: as :func:`bekker.models.as_model`.
        InputError: a value is out of range, or the shapes do not go together.
        SimulationError: the wheel sinks to its axle, or slip and wheel speed contradict each other.
    """
    own = as_model(model, parameters)
    try:
        points = np.broadcast_arrays(*(np.asarray(given, dtype=np.float64) for given in (load, slip, wheel_speed)))
    except ValueError as refused:
        raise InputError(f"load, slip, wheel_speed: expected numbers or arrays of one shape: {refused}") from None
    found = own.steady_points(*(np.ascontiguousarray(points[k]).ravel() for k in range(3)))
    names = ("drawbar_pull", "torque", "sinkage")
    return {name: values.reshape(points[0].shape) for name, values in zip(names, found, strict=True)}


def whole(name: str, seconds: float, what: str, unit: float) -> int:
    """How many ``unit`` make ``seconds``; an :class:`InputError` where that is no whole number from 1."""
    ratio = seconds / unit
    if not (np.isfinite(ratio) and round(ratio) >= 1 and abs(ratio - round(ratio)) <= _WHOLE * ratio):
        raise InputError(f"{name} = {seconds} s: expected a whole number of {what} of {unit} s")
    return round(ratio)


def _table(model: Model, inputs: Inputs | None, time: Floats) -> Floats:
    """Input values, one row an interval."""
    start = {variable["name"]: variable["value"] for variable in model.inputs()}
    table = np.tile(list(start.values()), (len(time), 1))
    if inputs is None:
        return table
    if callable(inputs):
        for row, t in zip(table, time, strict=True):
            given = inputs(float(t))
            if isinstance(given, Mapping):
                _fill(row[np.newaxis], given, list(start))
            else:
                _all(row, given, list(start))
        return table
    if isinstance(inputs, Mapping):
        _fill(table, inputs, list(start))
        return table
    raise InputError(f"inputs: expected a mapping by name or a function of time, found {type(inputs).__name__}")


def _all(row: Floats, given: Sequence[float] | Floats, names: list[str]) -> None:
    values = np.asarray(given, dtype=np.float64)
    if values.shape != row.shape:
        raise InputError(f"inputs gave values of shape {values.shape}, expected {row.shape}: {', '.join(names)}")
    row[:] = values


def _fill(table: Floats, given: Mapping[str, ArrayLike], names: list[str]) -> None:
    for name, value in given.items():
        if name not in names:
            raise unknown("input", name, names)
        column = np.asarray(value, dtype=np.float64)
        if column.shape not in ((), (len(table),)):
            raise InputError(f"input `{name}` has shape {column.shape}, expected one value or {len(table)} (one a period)")
        table[:, names.index(name)] = column
