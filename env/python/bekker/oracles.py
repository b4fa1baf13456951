"""Drivers that know more than a policy may: they show that every episode of a task can be solved.

An oracle is a list of drivers, tried one after the other on the very episode that counts, the same soil and the same ground.
What the best of them reaches is what somebody reaches who knows the ground before the drive::

    env = gymnasium.make("bekker/SlopeClimb-v0")
    result = bekker.oracles.evaluate(env, range(20))
"""

from collections.abc import Iterable, Sequence
from typing import Any

import gymnasium
import numpy as np

from .baselines import Actions, ControllerPolicy, Evaluation, Policy, State, rover_of
from .baselines import evaluate as evaluate_policy
from .errors import InputError

__all__ = ["OnSchedule", "drivers", "evaluate"]

ON_SCHEDULE = ("SlopeClimb", "BlindSlope", "EnergyTraverse")
"""Tasks whose oracle is :class:`OnSchedule`."""

_FIRST_RATIO = 1.25
"""Speed of the rims over that of the rover before it has been seen to move: 20 % slip."""

_MOST_RATIO = 5.0
"""Largest such ratio that is believed: 80 % slip. A rover that starts has any."""

_SMOOTHING = 0.5
"""Time over which the ratio is smoothed, s."""


class OnSchedule:
    """Wheel speeds with which a rover comes to its goal on time: the way left over the time left, and as much more as the
    wheels slip. It reads the true speed, of body and wheels, and the clock of the episode.

    Args:
        env: the environment, whose actions must be wheel speeds, and whose goal a distance.
        aim: time of arrival over that of the schedule, which is the way at the speed asked for.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], aim: float = 1.0) -> None:
        self._rover = rover_of(env)
        setup = self._rover.setup
        if setup.model.control not in ("speed", "speed_loop") or setup.goal.way() <= 0.0:
            raise InputError("a driver on schedule needs wheel speeds as actions and a goal at a distance")
        self._aim, self._way, self._period = aim, setup.goal.way(), setup.period
        self._per_speed = 1.0 / (setup.model.get("wheel.radius") * setup.action_scale)
        self._ratio, self._command = _FIRST_RATIO, 0.0

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Actions, State]:
        """The action for the present state of the environment; what is observed is not looked at."""
        mechanics = self._rover.mechanics
        if episode_start is not None and np.any(episode_start):
            self._ratio, self._command = _FIRST_RATIO, 0.0
        velocity = float(mechanics.signals[0, mechanics.places["velocity"]])
        if self._command > 0.0:
            seen = min(max(self._command / max(velocity, 1e-6), 1.0), _MOST_RATIO)
            self._ratio += (seen - self._ratio) * min(self._period / _SMOOTHING, 1.0)
        target = float(mechanics.info(0)["target_velocity"])
        time_left = self._aim * self._way / target - float(mechanics.elapsed[0]) * self._period
        way_left = self._way - float(mechanics.distance[0])
        # At the end, when both are short, no faster than twice the speed asked for.
        speed = min(way_left / max(time_left, self._period), 2.0 * target)
        self._command = speed * self._ratio
        action = np.clip(self._command * self._per_speed, 0.0, 1.0)
        return np.full(mechanics.inputs.shape[1], action, dtype=np.float32), state


def drivers(env: gymnasium.Env[Any, Any]) -> list[Policy]:
    """The drivers of the oracle of a registered task.

    Raises:
        InputError: the task has none.
    """
    task = rover_of(env).setup.task.name
    if task in ON_SCHEDULE:
        return [OnSchedule(env)]
    kinds: dict[str, Sequence[tuple[str, float]]] = {
        # The speed is the target's there.
        "SpeedHold": (("slip", 0.25), ("rtc_speed", 0.25), ("velocity", 0.25)),
        "DitchCrossing": (("rtc_speed", 0.28), ("equal_torque", 0.2), ("velocity", 0.25), ("equal_torque", 0.25)),
        "SlipLimited": (("slip", 0.25), ("velocity", 0.25), ("velocity", 0.15)),
    }
    if task not in kinds:
        raise InputError(f"task {task!r} has no oracle; expected one of {', '.join((*kinds, *ON_SCHEDULE))}")
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
