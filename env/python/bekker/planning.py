"""Poses of a robot on a map, and safe paths over it: :func:`pose` and :func:`plan`."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _bekker
from .errors import InputError
from .from_json import built
from .models import ModelLike, as_model
from .soil import SoilLike, as_soil
from .toml_text import text, value

__all__ = [
    "Alternative",
    "Failure",
    "GroundLike",
    "JointValue",
    "Plan",
    "Pose",
    "RobotLike",
    "WheelContact",
    "plan",
    "planning_settings",
    "pose",
    "robots",
]

GroundLike: TypeAlias = str | os.PathLike[str] | ArrayLike
"""Heights in metres as an array ``[row, column]``, NaN where nothing was measured; a file (.tif, .asc, .npy, .csv, .yaml with a
PGM); or generated ground: ``benign``, ``moderate``, ``difficult``, with a seed as in ``"moderate:7"``."""

RobotLike: TypeAlias = str | os.PathLike[str] | Mapping[str, Any]
"""The name of one of :func:`robots`, a TOML file, its text, or its content as a dictionary."""

_COLUMNS = ("x", "y", "z", "travelled", "heading", "roll", "pitch", "stability", "thrust", "clearance")
_SLIP = ("slip", "slip_low", "slip_high", "slip_none")


@dataclass(frozen=True)
class WheelContact:
    """Where a wheel touches."""

    name: str
    point: tuple[float, float, float]
    """m."""
    normal: tuple[float, float, float]
    """Of the ground."""
    contact_angle: float
    """Slope in the wheel's plane, uphill positive, rad."""


@dataclass(frozen=True)
class JointValue:
    """A joint's value from that on level ground, rad or m."""

    name: str
    value: float


@dataclass(frozen=True)
class Pose:
    """A robot on the ground, in SI units and radians."""

    position: tuple[float, float, float]
    """Of the reference point, m."""
    heading: float
    """From x (east) towards y (north), rad."""
    roll: float
    """Left side up, rad."""
    pitch: float
    """Nose up, rad."""
    joints: list[JointValue]
    wheels: list[WheelContact]
    clearance: float
    """Smallest distance of the belly from the ground, m; NaN for a robot without a belly."""
    safe: bool
    """Whether joints, belly, stability and forces keep their limits."""
    failure: str | None
    """Why not."""
    stability: float
    """Stability angle, rad."""
    thrust: float
    """Largest thrust in the direction of travel, N; NaN where no forces hold the robot."""


@dataclass(frozen=True)
class Failure:
    """A place where the robot would fail."""

    x: float
    y: float
    heading: float
    kind: str
    """``unknown ground``, ``no pose``, ``joint limit``, ``belly``, ``stability`` or ``forces``."""
    reason: str


@dataclass(frozen=True)
class Alternative:
    """Another path to the goal of a plan, judged as the plan is, in SI units and radians."""

    name: str
    """What it is: ``different route``, ``shortest safe path``, ``least energy``, ..."""
    points: NDArray[np.float64]
    """From start to goal, m: array of shape (n, 2)."""
    length: float
    """m."""
    cost: float
    """In the plan's measure; NaN where that does not allow the path."""
    energy: float
    """As :attr:`Plan.energy`, J."""
    stability: float
    """Least stability angle, rad; NaN where the robot has no pose at some place."""
    thrust: float
    """Least thrust in reserve, N; NaN where the robot has no pose, or no forces hold it, at some place."""
    slip: float
    """Largest slip, 0 or more; NaN on firm ground, where none is enough, and where the path is not safe."""
    safe: bool
    """Whether the robot may stand at all of its places."""
    stands: int
    """Places evaluated."""
    failures: list[Failure]
    """Those at which the robot would fail, from start to goal."""
    verdict: str
    """How it compares with the plan."""


@dataclass(frozen=True)
class Plan:
    """A path on which the robot is safe at every point, in SI units and radians.

    The arrays have one value a point from start to goal; a turn where the robot stands is a second point at the same place.
    """

    path: NDArray[np.float64]
    """Points, m: array of shape (n, 2)."""
    travelled: NDArray[np.float64]
    """Way from the start, m."""
    z: NDArray[np.float64]
    """Height of the reference point, m."""
    heading: NDArray[np.float64]
    roll: NDArray[np.float64]
    pitch: NDArray[np.float64]
    stability: NDArray[np.float64]
    """Smallest stability angle of all cases, rad."""
    thrust: NDArray[np.float64]
    """Smallest of the largest thrusts of all cases, N."""
    clearance: NDArray[np.float64]
    """Smallest distance of the belly from the ground, m; NaN for a robot without a belly."""
    slip: NDArray[np.float64]
    """Slip that the wheels need for the slope on the plan's soil; NaN on firm ground, and where none is enough."""
    slip_low: NDArray[np.float64]
    """Lower end of its band; NaN also where the robot slides there."""
    slip_high: NDArray[np.float64]
    """Upper end of its band; NaN also where no slip is enough there."""
    slip_none: NDArray[np.float64]
    """Share of the soils looked at on which no slip is enough; NaN on firm ground."""
    length: float
    """m."""
    cost: float
    """Performance index (3.5), or by energy that of the wheels, J."""
    searches: int
    evaluations: int
    """Places evaluated."""
    failures: list[Failure]
    """Places that were found unsafe on the way to the plan."""
    remarks: list[str]
    """What is doubtful in the map, and what was changed in it."""
    energy: float
    """Energy of the wheels by the slopes on which the robot stands, J; NaN on firm ground, and where some slope needs more slip than
    ``energy.most_slip``."""
    slip_told: str | None
    """How the slip and its band were made; None on firm ground."""
    alternatives: list[Alternative]
    """Other paths to the goal, where they were asked for."""
    alternatives_missing: list[str]
    """Those that were looked for and are not there, or take the same path, with the reason."""
    page: str = field(repr=False)
    """The plan as a self-contained HTML page: map, path and alternatives, margins, slip, the robot at any point."""

    def save_page(self, file: str | os.PathLike[str]) -> Path:
        """Writes :attr:`page`; the file's path."""
        path = Path(file)
        path.write_text(self.page, encoding="utf-8")
        return path

    def _repr_html_(self) -> str:
        from html import escape

        return f'<iframe srcdoc="{escape(self.page)}" width="100%" height="1000" style="border:0"></iframe>'


def plan(
    ground: GroundLike,
    start: Sequence[float],
    goal: Sequence[float],
    robot: RobotLike = "fsrl",
    *,
    heading: float | None = None,
    cell: float = 1.0,
    origin: Sequence[float] = (0.0, 0.0),
    from_north: bool = False,
    smooth: bool = True,
    spikes: float | None = None,
    fill_holes: bool = False,
    soil: ModelLike | None = None,
    soil_from: SoilLike | None = None,
    soil_class: str | None = None,
    settings: Mapping[str, float] | None = None,
    active: Sequence[float] = (),
    by_energy: bool = False,
    alternatives: bool = False,
    most_evaluations: int = 100_000,
) -> Plan:
    """The cheapest path by the performance index (3.5) of Iagnemma 2001 on which the robot is safe at every point.

    With ``by_energy`` it is the path on which the wheels need the least energy by the wheel-soil model, at any angle; needs ``soil``.

    Args:
        ground: heights, a file or generated ground.
        start: x (east) and y (north), m.
        goal: the same.
        robot: the robot.
        heading: at the start, from x towards y, rad; any where None.
        cell: spacing of an array, a .npy or .csv file, m.
        origin: place of its south-western node, m.
        from_north: its first row is the northern one.
        smooth: a smooth surface through the heights; False for one with creases along the grid.
        spikes: nodes that stand out of all neighbours by more than this (m) are put to the neighbours' median.
        fill_holes: fill holes of the map from their rims.
        soil: a model whose soil lies there, in place of firm ground.
        soil_from: what an experiment found of that soil (:class:`bekker.Soil`, or the path of its file): its values replace those of
            ``soil``, and from its covariance follows the band of the slip.
        soil_class: the class of that soil, whose standard deviations make the band; None for the class nearest to it.
        settings: numbers of :func:`planning_settings` by name, SI units.
        active: values of the robot's active joints, rad or m; 0 where empty.
        by_energy: the least energy of the wheels (J) as the cost, in the place of the performance index.
        alternatives: look for other paths too, for :attr:`Plan.alternatives` and the page; takes some seconds.
        most_evaluations: most places to evaluate before giving up.

    Raises:
        PlanningError: there is no safe path; the message says why and where, :attr:`~bekker.errors.PlanningError.nearest` how far
            one gets.
        InputError: heights or places are no numbers, or of the wrong shape; ``soil_from`` or ``soil_class`` without ``soil``, or both.
        ModelError: the robot's description, a setting or the map's file is refused.
        UnknownNameError: no robot, setting or class of soil of that name.
        OSError: a file cannot be read.
    """
    site = _site(ground, robot, cell, origin, from_north, smooth, spikes, fill_holes, soil, settings, active)
    site |= _known(soil, soil_from, soil_class)
    places = _place("start", start), _place("goal", goal)
    found, page = _bekker.plan(site, *places, heading, most_evaluations, by_energy, alternatives)
    answer = json.loads(found)
    points = answer.pop("points")
    columns = {name: _numbers(point[name] for point in points) for name in _COLUMNS + _SLIP}
    path = np.column_stack([columns.pop("x"), columns.pop("y")])
    return built(Plan, answer, path=path, page=page, **columns)


def pose(
    ground: GroundLike,
    at: Sequence[float],
    robot: RobotLike = "fsrl",
    *,
    heading: float = 0.0,
    cell: float = 1.0,
    origin: Sequence[float] = (0.0, 0.0),
    from_north: bool = False,
    smooth: bool = True,
    spikes: float | None = None,
    fill_holes: bool = False,
    soil: ModelLike | None = None,
    settings: Mapping[str, float] | None = None,
    active: Sequence[float] = (),
) -> Pose:
    """How a robot stands with its reference point over ``at`` (m), and whether it is safe there. Arguments as for :func:`plan`.

    Raises:
        PlanningError: no pose has all wheels on known ground.
        InputError, ModelError, UnknownNameError, OSError: as :func:`plan`.
    """
    site = _site(ground, robot, cell, origin, from_north, smooth, spikes, fill_holes, soil, settings, active)
    return built(Pose, json.loads(_bekker.pose(site, _place("at", at), float(heading))))


def robots() -> dict[str, str]:
    """Names and meanings of the robots that are built in."""
    return dict(_bekker.robots())


def planning_settings() -> list[dict[str, Any]]:
    """Every number that ``settings`` of :func:`plan` changes: name, value, unit and meaning."""
    keys = ("name", "value", "unit", "meaning")
    return [dict(zip(keys, row, strict=True)) for row in _bekker.planning_settings()]


def _numbers(values: Any) -> NDArray[np.float64]:
    return np.array(list(values), dtype=np.float64)


def _place(name: str, given: Sequence[float]) -> tuple[float, float]:
    try:
        x, y = (float(number) for number in given)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected two numbers (x, y) in metres, found {given!r}") from None
    if not (np.isfinite(x) and np.isfinite(y)):
        raise InputError(f"{name}: expected finite numbers, found ({x}, {y})")
    return x, y


def _site(
    ground: GroundLike,
    robot: RobotLike,
    cell: float,
    origin: Sequence[float],
    from_north: bool,
    smooth: bool,
    spikes: float | None,
    fill: bool,
    soil: ModelLike | None,
    settings: Mapping[str, float] | None,
    active: Sequence[float],
) -> dict[str, object]:
    is_text = isinstance(robot, Mapping) or (isinstance(robot, str) and "\n" in robot)
    given = _robot_text(robot) if isinstance(robot, Mapping) else os.fspath(robot)
    return {
        "map": _heights(ground),
        "cell": float(cell),
        "origin": _place("origin", origin),
        "from_north": from_north,
        "smooth": smooth,
        "spikes": spikes,
        "fill": fill,
        "robot": given,
        "robot_is_text": is_text,
        "settings": {name: float(number) for name, number in (settings or {}).items()},
        "active": [float(number) for number in active],
        "soil": None if soil is None else as_model(soil),
        "soil_from": None,
        "soil_class": None,
    }


def _known(soil: ModelLike | None, soil_from: SoilLike | None, soil_class: str | None) -> dict[str, object]:
    if soil is None and (soil_from is not None or soil_class is not None):
        raise InputError("soil_from and soil_class say what is known of the soil of a model: expected `soil` too")
    if soil_from is not None and soil_class is not None:
        raise InputError("expected soil_from or soil_class, found both")
    return {"soil_from": None if soil_from is None else as_soil(soil_from).toml, "soil_class": soil_class}


def _heights(ground: GroundLike) -> str | NDArray[np.float64]:
    if isinstance(ground, (str, os.PathLike)):
        return os.fspath(ground)
    try:
        heights = np.asarray(ground, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"ground: expected heights in metres, a file or generated ground, found {ground!r}") from None
    if heights.ndim != 2:
        raise InputError(f"ground: expected an array [row, column] of heights, found one of shape {heights.shape}")
    return np.ascontiguousarray(heights)


def _robot_text(robot: Mapping[str, Any]) -> str:
    # TOML has no null: what is None is left out.
    def present(content: Any) -> Any:
        if isinstance(content, Mapping):
            return {key: present(inner) for key, inner in content.items() if inner is not None}
        if isinstance(content, (list, tuple)):
            return [present(inner) for inner in content]
        return content

    return "".join(f"{text(key)} = {value(f'robot, `{key}`', inner)}\n" for key, inner in present(robot).items())
