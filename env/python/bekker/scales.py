"""Scales by which the environment normalises signals and actions, taken from the model's own size and weight.

With mass m, gravity g, wheel radius r, n wheels and distance L between the outer wheels, a value of one means:

| signal | scale | two-wheeled rover |
|---|---|---|
| ``pitch``, ``wheel.contact_angle``, ``link.angle`` | pi/2 | 1.57 rad |
| ``pitch_rate``, ``link.rate`` | sqrt(g/L) | 3.7 rad/s |
| ``wheel.speed`` | 1.2 times the no-load speed U/(N K_t) of the motor, at least sqrt(g/r) | 12.3 rad/s |
| ``velocity``, ``target_velocity`` | r times that: a Froude number of one at least | 1.23 m/s |
| ``wheel.slip`` | 1 | 1 |
| ``wheel.sinkage`` | r | 0.1 m |
| ``wheel.normal_force``, ``wheel.drawbar_pull`` | m g/n, a wheel's share of the weight | 49 N |
| ``wheel.torque`` | m g r/n | 4.9 N m |
| ``wheel.current`` | m g r/n over gear ratio and torque constant | 2.1 A |
| ``height_ahead`` | half of the farthest distance of the `bekker.Ahead` | 0.5 m if that is 1 m |
| ``power``, ``electrical_power`` | m g sqrt(g r), the weight lifted at a Froude number of one | 97 W |

The supply voltage U bounds the speed of a driven wheel, so wheel speeds and velocities stay within their scales.

An action of one means half of the scale of torque, wheel speed or velocity: half a wheel's weight at its rim is
about what sand can carry (tan 29 degrees = 0.55).
"""

from collections.abc import Iterable, Mapping, Sequence
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from ._bekker import Ahead, Model, ObservedSignals
from .checked import finite
from .errors import InputError
from .vocabulary import unknown

OBSERVED = ("pitch", "pitch_rate", "velocity", "wheel.speed", "wheel.torque", "wheel.contact_angle")
"""What the environment observes by default: what a rover's own sensors can tell."""

EXTRAS = ("target_velocity", "goal_distance", "time_left")
"""What can be observed besides signals: the speed that the task asks for; what is left of the way to the goal, as a share; and
what is left of the time that the way takes at the speed asked for, as a share."""

AHEAD = ("height_ahead", "seen_ahead", "soil_ahead")
"""What can be observed of the ground ahead, an entry for each distance of a `bekker.Ahead`: heights above the ground at the rover, m; 1 where
the cell is there and 0 where it is missing; the shear strength of the soil over that of the model's soil."""

AHEAD_SLOPE = 0.5
"""Scale of the heights ahead over the farthest distance: a slope of 27 degrees all the way."""

RAW_LIMIT = 10.0
"""Bounds of raw observations, in scales."""

ACTION_SHARE = 0.5
"""Share of the scale that an action of one commands."""

NO_LOAD_MARGIN = 1.2
"""Scale of the wheel speed over the no-load speed. Downhill a wheel drives its motor beyond that speed: 5 N m, the
weight of the two-wheeled rover on one rim, by 2.1 rad/s, a fifth."""

_COMMANDED = {
    "torque": "wheel.torque",
    "speed": "wheel.speed",
    "speed_loop": "wheel.speed",
    "velocity": "velocity",
    "velocity_tuned": "velocity",
    "rtc": "velocity",
    "rtc_speed": "velocity",
    "slip": "velocity",
    "equal_torque": "velocity",
}


def natural_scales(model: Model) -> dict[str, float]:
    """The table above for ``model``; a name without a number stands for that signal of every wheel."""
    gravity, radius = model.get("gravity"), model.get("wheel.radius")
    share = model.total_mass * gravity / model.wheels
    length = model.get(f"wheel[{model.wheels}].x") - model.get("wheel[1].x")
    if length <= 0.0:
        raise InputError(f"wheel[{model.wheels}].x - wheel[1].x = {length} m: expected the front wheel before the rear")
    power = model.total_mass * gravity * sqrt(gravity * radius)
    turning = max(sqrt(gravity / radius), NO_LOAD_MARGIN * no_load_speed(model))
    return {
        "pitch": pi / 2,
        "pitch_rate": sqrt(gravity / length),
        "velocity": turning * radius,
        "power": power,
        "electrical_power": power,
        "wheel.speed": turning,
        "wheel.slip": 1.0,
        "wheel.sinkage": radius,
        "wheel.normal_force": share,
        "wheel.drawbar_pull": share,
        "wheel.torque": share * radius,
        "wheel.current": share * radius / (model.get("motor.gear_ratio") * model.get("motor.torque_constant")),
        "wheel.contact_angle": pi / 2,
        "link.angle": pi / 2,
        "link.rate": sqrt(gravity / length),
    }


def no_load_speed(model: Model) -> float:
    """Wheel speed at which the back-EMF is the supply voltage, rad/s; 0 where no voltage limits a motor."""
    inverse = 0.0 if model.control == "speed" else model.get("motor.inverse_voltage")
    return 0.0 if inverse == 0.0 else 1.0 / (inverse * model.get("motor.gear_ratio") * model.get("motor.torque_constant"))


def action_scale(model: Model) -> float:
    """What an action of one commands: N m, rad/s or m/s by the model's control."""
    return ACTION_SHARE * natural_scales(model)[_COMMANDED[model.control]]


class Observer:
    """Picks signals and normalises them to -1..1; what exceeds its scale is clipped.

    Attributes:
        names: full names of the entries of an observation, in order.
        scales: SI value of one, entry by entry.
        limit: bound of the entries: 1 where they are normalised, RAW_LIMIT scales in SI where they are not.
    """

    def __init__(
        self, model: Model, observed: Sequence[str], changed: Mapping[str, float], *, raw: bool, ahead: Ahead | None = None
    ) -> None:
        scales = natural_scales(model) | {name: 1.0 for name in EXTRAS + AHEAD}
        cells = _cells(observed, ahead)
        scales["height_ahead"] = AHEAD_SLOPE * max((abs(distance) for distance in cells), default=0.0) or 1.0
        scales["target_velocity"] = scales["velocity"]
        for name, scale in changed.items():
            if name not in scales:
                raise unknown("observable signal", name, scales)
        scales |= {name: finite(f"scale of `{name}`", scale, above=0.0) for name, scale in changed.items()}
        if not observed:
            raise InputError("observe: expected at least one signal")
        self.names: list[str] = []
        values: list[float] = []
        for place, kind in enumerate(observed):
            if kind not in scales:
                raise unknown("observable signal", kind, scales)
            if kind in observed[:place]:
                raise InputError(f"observe: `{kind}` stands there twice; expected each signal once")
            self.names += _entries(kind, model, len(cells))
            values += [scales[kind]] * (len(self.names) - len(values))
        self.scales = np.array(values)
        self.limit = RAW_LIMIT * self.scales if raw else np.ones(len(values))
        self._raw = raw
        self._extras = {name: k for k, name in enumerate(self.names) if name in EXTRAS}
        self._ahead = [[k for k, name in enumerate(self.names) if name.startswith(f"{kind}[")] for kind in AHEAD]
        others = set(self._extras.values()).union(*self._ahead)
        columns = [k for k in range(len(self.names)) if k not in others]
        self._own = (indices(model, [self.names[k] for k in columns]).tolist(), columns)

    def signals(self, readings: Sequence[int] = ()) -> ObservedSignals:
        """The entries that are signals; where sensors are to be seen, ``readings`` are the places of the signals that they read."""
        places, columns = self._own
        scales = np.ones(len(columns)) if self._raw else self.scales[columns]
        return ObservedSignals(len(self.names), places, columns, scales, self.limit[columns], readings)

    def add_extras(self, observations: NDArray[np.float32], **extras: NDArray[np.float64]) -> None:
        """Writes the entries that are no signals."""
        for name, place in self._extras.items():
            values = extras[name] if self._raw else extras[name] / self.scales[place]
            observations[:, place] = np.clip(values, -self.limit[place], self.limit[place])

    def add_ahead(self, observations: NDArray[np.float32], read: NDArray[np.float64]) -> None:
        """Writes the entries of the ground ahead; ``read`` is what `Batch.look_ahead` has read, a row a rover."""
        for columns, values in zip(self._ahead, np.split(read, len(AHEAD), axis=1), strict=True):
            if columns:
                scaled = values if self._raw else values / self.scales[columns]
                observations[:, columns] = np.clip(scaled, -self.limit[columns], self.limit[columns])


def _cells(observed: Sequence[str], ahead: Ahead | None) -> list[float]:
    """Distances of the map of the ground ahead.

    Raises:
        InputError: what is observed needs a map that is not given, or nothing needs the one that is.
    """
    wanted = [kind for kind in observed if kind in AHEAD]
    if wanted and ahead is None:
        raise InputError(f"observe `{wanted[0]}`: expected the argument `ahead`, such as ahead=bekker.Ahead([0.2, 0.4])")
    if ahead is not None and not isinstance(ahead, Ahead):
        raise InputError(f"ahead = {ahead!r}: expected a bekker.Ahead, such as bekker.Ahead([0.2, 0.4])")
    if ahead is not None and not wanted:
        raise InputError(f"ahead = {ahead!r}: nothing of it is observed; expected {', '.join(AHEAD)} in `observe`")
    return [] if ahead is None else ahead.distances


def _entries(kind: str, model: Model, cells: int) -> list[str]:
    if kind in AHEAD:
        return [f"{kind}[{k}]" for k in range(1, cells + 1)]
    for group, count in (("wheel", model.wheels), ("link", model.links)):
        if kind.startswith(f"{group}."):
            return [f"{group}[{k}]{kind.removeprefix(group)}" for k in range(1, count + 1)]
    return [kind]


def indices(model: Model, names: Iterable[str]) -> NDArray[np.intp]:
    """Positions of signals in the vocabulary's order."""
    order = [variable["name"] for variable in model.signals()]
    return np.array([order.index(name) for name in names], dtype=np.intp)
