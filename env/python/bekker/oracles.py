"""Drivers that know more than a policy may: they show that every episode of a task can be solved.

An oracle is a list of drivers, tried one after the other on the very episode that counts, the same soil and the same ground.
What the best of them reaches is what somebody reaches who knows the ground before the drive::

    env = gymnasium.make("bekker/SlopeClimb-v0")
    result = bekker.oracles.evaluate(env, range(20))
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import gymnasium
import numpy as np

from .baselines import Actions, ControllerPolicy, Evaluation, Floats, Policy, State, rover_of
from .baselines import evaluate as evaluate_policy
from .errors import InputError

__all__ = ["Gentle", "OnSchedule", "Survey", "drivers", "evaluate"]

ON_SCHEDULE = ("SlopeClimb", "BlindSlope", "EnergyTraverse")
"""Tasks whose oracle is :class:`OnSchedule`."""

_FIRST_RATIO = 1.25
"""Speed of the rims over that of the rover before it has been seen to move: 20 % slip."""

_MOST_RATIO = 5.0
"""Largest such ratio that is believed: 80 % slip. A rover that starts has any."""

_STEP = 0.01
"""Distance between the places of a plan, m."""

_AROUND = 5
"""Places over which a survey is smoothed."""

_SMALLEST_TURNING = 0.02
"""What is added to the turning of the ground, rad/m, so that level ground has a speed."""

_LOOK = 0.02
"""How far before a place its speed is commanded, m, since wheels take a while to follow."""

_FASTEST = 0.37
"""Upper limit of a plan's speed, m/s: full action turns the wheels of RockTraverse for 0.38 m/s without slip."""

_SMOOTHING = 0.5
"""Time over which the ratio is smoothed, s."""


@dataclass
class Survey:
    """Pitch of the chassis over the way, as a first drive on the episode's ground has found it."""

    distance: list[float] = field(default_factory=list)
    """Along x from the start, m."""
    pitch: list[float] = field(default_factory=list)
    """rad."""

    def turning(self, grid: Floats) -> Floats:
        """|d pitch/d distance| about the places of ``grid`` (m, at equal distances), rad/m; 0 beyond what was driven.

        Raises:
            InputError: nothing was driven yet.
        """
        if len(self.distance) < 2:
            raise InputError("survey: expected one that a drive on the episode's ground has filled")
        pitch = np.interp(grid, np.maximum.accumulate(self.distance), self.pitch)
        per_metre = np.abs(np.gradient(pitch, grid))
        smoothed: Floats = np.convolve(per_metre, np.full(_AROUND, 1.0 / _AROUND), mode="same")
        return smoothed


class OnSchedule:
    """Wheel speeds with which a rover comes to its goal on time: the way left over the time left, and as much more as the
    wheels slip. It reads the true speed, of body and wheels, and the clock of the episode.

    Args:
        env: the environment, whose actions must be wheel speeds, and whose goal a distance.
        aim: time of arrival over that of the schedule, which is the way at the speed asked for.
        notes: where to write what the ground does to the pitch.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], aim: float = 1.0, notes: Survey | None = None) -> None:
        self._rover = rover_of(env)
        setup = self._rover.setup
        if setup.model.control not in ("speed", "speed_loop") or setup.goal.way() <= 0.0:
            raise InputError("a driver on schedule needs wheel speeds as actions and a goal at a distance")
        self._aim, self._way, self._period = aim, setup.goal.way(), setup.period
        self._per_speed = 1.0 / (setup.model.get("wheel.radius") * setup.action_scale)
        self._ratio, self._command = _FIRST_RATIO, 0.0
        self._notes = notes

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Actions, State]:
        """The action for the present state of the environment; what is observed is not looked at."""
        mechanics = self._rover.mechanics
        if episode_start is not None and np.any(episode_start):
            self._begin()
        velocity = float(mechanics.signals[0, mechanics.places["velocity"]])
        if self._command > 0.0:
            seen = min(max(self._command / max(velocity, 1e-6), 1.0), _MOST_RATIO)
            self._ratio += (seen - self._ratio) * min(self._period / _SMOOTHING, 1.0)
        gone = float(mechanics.distance[0])
        if self._notes is not None:
            self._notes.distance.append(gone)
            self._notes.pitch.append(float(mechanics.signals[0, mechanics.places["pitch"]]))
        target = float(mechanics.info(0)["target_velocity"])
        time_left = self._aim * self._way / target - float(mechanics.elapsed[0]) * self._period
        self._command = self._speed(gone, max(time_left, self._period), target) * self._ratio
        action = np.clip(self._command * self._per_speed, 0.0, 1.0)
        return np.full(mechanics.inputs.shape[1], action, dtype=np.float32), state

    def _begin(self) -> None:
        self._ratio, self._command = _FIRST_RATIO, 0.0
        if self._notes is not None:
            self._notes.distance.clear()
            self._notes.pitch.clear()

    def _speed(self, gone: float, time_left: float, target: float) -> float:
        """Speed of the rover after the way ``gone``, m/s."""
        # At the end, when both are short, no faster than twice the speed asked for.
        return min((self._way - gone) / time_left, 2.0 * target)


class Gentle(OnSchedule):
    """A rover on schedule that is slow where, by a survey, the ground turns its chassis.

    Where the ground gives the chassis the pitch p(x), its pitch rate is p'(x) v. The largest one of a way is smallest, for a given time of
    arrival, with speeds in proportion to 1/|p'|. They are kept within limits here.

    Args:
        env: as of :class:`OnSchedule`.
        aim: as of :class:`OnSchedule`.
        survey: of the same episode, driven before.
        slowest: lower limit of the speed, m/s.
        fastest: upper limit of the speed, m/s.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], aim: float, survey: Survey, slowest: float, fastest: float = _FASTEST) -> None:
        super().__init__(env, aim)
        self._survey, self._limits = survey, (slowest, fastest)
        self._grid = np.arange(0.0, self._way, _STEP)
        self._plan: Floats | None = None

    def _begin(self) -> None:
        super()._begin()
        self._plan = None

    def _speed(self, gone: float, time_left: float, target: float) -> float:
        if self._plan is None:
            self._plan = self._planned(time_left)
        place = min(int((gone + _LOOK) / _STEP), len(self._plan) - 1)
        # What is behind the plan or ahead of it is made up for on the rest of the way.
        correction = float((_STEP / self._plan[max(int(gone / _STEP), 0) :]).sum()) / time_left
        return float(self._plan[place]) * min(max(correction, 0.5), 2.0)

    def _planned(self, seconds: float) -> Floats:
        """Speeds over the grid with which the way takes so long."""
        turning = self._survey.turning(self._grid) + _SMALLEST_TURNING

        def speeds(scale: float) -> Floats:
            return np.clip(scale / turning, *self._limits)

        low, high = 1e-6, 1e3
        for _ in range(60):
            middle = float(np.sqrt(low * high))
            if (_STEP / speeds(middle)).sum() > seconds:
                low = middle
            else:
                high = middle
        return speeds(high)


def drivers(env: gymnasium.Env[Any, Any]) -> list[Policy]:
    """The drivers of the oracle of a registered task.

    Raises:
        InputError: the task has none.
    """
    task = rover_of(env).setup.task.name
    if task in ON_SCHEDULE:
        return [OnSchedule(env)]
    if task == "RockTraverse":
        # The first drive is the survey of the others.
        survey = Survey()
        gentle = [Gentle(env, aim, survey, slowest) for aim, slowest in ((0.99, 0.04), (0.97, 0.03), (0.97, 0.08), (0.97, 0.12))]
        return [OnSchedule(env, 0.97, survey), *gentle]
    kinds: dict[str, Sequence[tuple[str, float]]] = {
        # The speed is the target's there.
        "SpeedHold": (("slip", 0.25), ("rtc_speed", 0.25), ("velocity", 0.25)),
        "DitchCrossing": (("rtc_speed", 0.28), ("equal_torque", 0.2), ("velocity", 0.25), ("equal_torque", 0.25)),
        "SlipLimited": (("slip", 0.25), ("velocity", 0.25), ("velocity", 0.15)),
    }
    if task not in kinds:
        raise InputError(f"task {task!r} has no oracle; expected one of {', '.join((*kinds, *ON_SCHEDULE, 'RockTraverse'))}")
    return [ControllerPolicy(env, kind, speed) for kind, speed in kinds[task]]


def evaluate(env: gymnasium.Env[Any, Any], seeds: Iterable[int]) -> Evaluation:
    """One episode a seed by the first driver that succeeds on it, or else by the one with the highest return."""
    results = [_best(env, int(seed)) for seed in seeds]
    if not results:
        raise InputError("seeds: expected at least one")
    joined = {name: np.concatenate([getattr(r, name) for r in results]) for name in ("returns", "success", "energy", "distance", "steps")}
    return Evaluation(**joined, status=[status for r in results for status in r.status])


def _best(env: gymnasium.Env[Any, Any], seed: int) -> Evaluation:
    tried: list[Evaluation] = []
    for driver in drivers(env):
        tried.append(evaluate_policy(env, driver, [seed]))
        if tried[-1].success[0]:
            return tried[-1]
    return max(tried, key=lambda result: float(result.returns[0]))
