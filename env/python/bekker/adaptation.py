"""How fast a policy adapts: some episodes in each of several worlds, whose soil and hidden effect it is not told.

Between two episodes of a world a policy may learn from the record of the last one, its :class:`Log`::

    env = gymnasium.make("bekker/BlindSlope-v0")
    result = bekker.adaptation.evaluate(env, bekker.learners.Diagnosing, bekker.worlds.SPLITS["test"].worlds(42))
    print(result.success.mean(axis=0))      # share of successes in the first, second, .. episode of a world
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import radians
from typing import Any, TypeAlias
from zlib import crc32

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ._bekker import Ahead
from .baselines import Policy, rover_of
from .errors import InputError
from .experiment import MeasuredRun
from .mechanics import Mechanics
from .simulation import whole
from .worlds import World

__all__ = ["Adaptation", "Log", "NOISE", "evaluate", "interquartile_mean"]

Floats: TypeAlias = NDArray[np.float64]

ROWS_PERIOD = 0.1
"""Time between two rows of a log, s."""

NOISE = {"x": 0.005, "pitch": radians(0.2), "wheel.torque": 0.01, "wheel.speed": 0.001}
"""Standard deviations of the noise of a log: of the surveyed track as a total station has it (m), of an inclinometer (rad), of the
torque as a share of that which lifts the wheel's load at its rim, and of the speed of a wheel (rad/s) as an encoder on the motor's side of
the gear counts it over 0.1 s."""

_START = 5
"""Rows in which the wheels speed up."""

_MARGIN, _GRID = 1.0, 0.05
"""The ground is surveyed so far beyond the places where the rover has been, in steps of the second, m."""


@dataclass(frozen=True, eq=False)
class Log:
    """Record of an episode: what the rover has measured, and a survey of its track and of the ground."""

    target_velocity: float
    """Speed that was asked for, m/s."""
    way: float
    """Distance along x that the task asks for, m."""
    distance: float
    """Distance along x that was made, m."""
    seconds: float
    """Length of the episode, s."""
    total: float
    """Its return."""
    success: bool
    """Whether it was one, as the task has it."""
    run: MeasuredRun
    """The drive as a traverse (:class:`bekker.Experiment`): a row every 0.1 s with the commands, and with ``x``, ``pitch``,
    ``wheel[k].torque`` and ``wheel[k].speed`` with their noise. Of commands that change within 0.1 s it has the first;
    :meth:`by_measured_speeds` does without them."""
    noise: dict[str, float]
    """Standard deviation of this noise by signal, SI units."""

    def by_measured_speeds(self) -> tuple[MeasuredRun, dict[str, float]]:
        """The drive without its commands, so that the measured speeds of the wheels drive a model (whose control is ``speed``), and
        the noise of what is compared then.

        It begins in motion: the first half second is left out, in which the wheels speed up between two rows.

        Raises:
            InputError: the episode is no longer than that.
        """
        rows = len(self.run.data["time"])
        if rows <= _START:
            raise InputError(f"a log of {rows} rows: expected more than {_START}, in which the wheels speed up")
        kept = {name: column[_START:] for name, column in self.run.data.items() if not name.endswith("_command")}
        run = replace(self.run, data=kept, x0=float(kept["x"][0]))
        return run, {name: value for name, value in self.noise.items() if not name.endswith("].speed")}


@dataclass(frozen=True, eq=False)
class Adaptation:
    """What a policy reaches in worlds that it has not met; one row a world, one column an episode."""

    worlds: list[World]
    returns: Floats
    success: NDArray[np.bool_]
    seconds: Floats
    """Length of the episodes, s."""
    notes: list[list[str]] = field(default_factory=list)
    """The policy's attribute ``note`` when it has learned from an episode; empty after the last one."""

    def first(self, episodes: int) -> Floats:
        """Mean return of the first episodes in each world.

        Raises:
            InputError: there are fewer.
        """
        if not 1 <= episodes <= self.returns.shape[1]:
            raise InputError(f"episodes = {episodes}: expected a number within 1 .. {self.returns.shape[1]}")
        mean: Floats = self.returns[:, :episodes].mean(axis=1)
        return mean

    def interval(self, values: Floats, statistic: Callable[[Floats], Floats] | None = None, draws: int = 2000) -> tuple[float, float]:
        """95 % interval of a statistic of one value a world, the interquartile mean where None: percentiles of a bootstrap that draws
        worlds of each effect among themselves (Agarwal et al. 2021, stratified).

        Args:
            values: one value a world.
            statistic: takes an array whose last axis is the worlds.
            draws: samples of the bootstrap.

        With n worlds of each effect the interval is too narrow by a factor of about sqrt(1 - 1/n), which holds for a mean: by 29 % with two.

        Raises:
            InputError: an effect has one world only, which tells nothing of the scatter between worlds.
        """
        random = np.random.default_rng(0)
        groups: dict[str, list[int]] = {}
        for k, world in enumerate(self.worlds):
            groups.setdefault(world.effect, []).append(k)
        for effect, group in groups.items():
            if len(group) == 1:
                raise InputError(f"effect `{effect}` has one world: expected two at least for an interval")
        chosen = [np.array(group)[random.integers(len(group), size=(draws, len(group)))] for group in groups.values()]
        found = (statistic or interquartile_mean)(np.asarray(values, np.float64)[np.concatenate(chosen, axis=1)])
        low, high = np.quantile(found, [0.025, 0.975])
        return float(low), float(high)


def interquartile_mean(values: Floats) -> Floats:
    """Mean of the middle half along the last axis: a quarter of the values, rounded down, is left out at each end."""
    ordered = np.sort(np.asarray(values, np.float64), axis=-1)
    cut = ordered.shape[-1] // 4
    mean: Floats = ordered[..., cut : ordered.shape[-1] - cut].mean(axis=-1)
    return mean


def evaluate(
    env: gymnasium.Env[Any, Any],
    policy: Callable[[gymnasium.Env[Any, Any], World], Policy],
    worlds: Sequence[World],
    episodes: int = 4,
    seed: int = 0,
) -> Adaptation:
    """Drives some episodes in each world, each with a new policy, which learns between them.

    Seeds of the episodes follow from ``seed``, the world and the episode: slopes and speeds are the same for all policies, and other ones
    in each split.

    Args:
        env: a task of bekker.
        policy: makes the policy of a world: ``policy(env, world)``. Only oracles may look at the world. If it has a method ``learn``,
            this is called between two episodes with the :class:`Log` of the first. The state that ``predict`` returns is handed on from one
            episode of a world to the next.
        worlds: the worlds, for example the first ones of a :class:`bekker.worlds.Split`.
        episodes: episodes in each.
        seed: another one gives other episodes.

    Raises:
        InputError: there is no world or no episode, or 0.1 s, after which a log has a row, is no whole number of control periods.
    """
    if not worlds or episodes < 1:
        raise InputError(f"{len(worlds)} worlds of {episodes} episodes: expected one of each at least")
    shape = (len(worlds), episodes)
    returns, seconds, success = np.zeros(shape), np.zeros(shape), np.zeros(shape, np.bool_)
    notes: list[list[str]] = []
    for row, world in enumerate(worlds):
        driver, state = policy(env, world), None
        learn = getattr(driver, "learn", None)
        notes.append([])
        for column in range(episodes):
            own = int(np.random.SeedSequence([seed, crc32(world.split.encode()), world.number, column]).generate_state(1)[0])
            log, state = _drive(env, driver, state, own, world)
            returns[row, column], seconds[row, column], success[row, column] = log.total, log.seconds, log.success
            note = ""
            if learn is not None and column + 1 < episodes:
                learn(log)
                note = str(getattr(driver, "note", ""))
            notes[-1].append(note)
    return Adaptation(list(worlds), returns, success, seconds, notes)


def _drive(env: gymnasium.Env[Any, Any], policy: Policy, state: Any, seed: int, world: World) -> tuple[Log, Any]:
    """One episode."""
    observation, info = env.reset(seed=seed, options=world.options)
    mechanics = rover_of(env).mechanics
    recorder = _Recorder(mechanics, seed)
    total, over = 0.0, False
    start: Any = np.ones(1, dtype=np.bool_)
    while not over:
        action, state = policy.predict(observation, state=state, episode_start=start, deterministic=True)
        start = np.zeros(1, dtype=np.bool_)
        recorder.before()
        observation, reward, terminated, truncated, info = env.step(action)
        recorder.after()
        total, over = total + float(reward), terminated or truncated
    return recorder.log(info, total), state


class _Recorder:
    """Writes rows while an episode goes on."""

    def __init__(self, mechanics: Mechanics, seed: int) -> None:
        self._mechanics, self._seed = mechanics, seed
        setup = mechanics.setup
        self._every = whole("time between two rows of a log", ROWS_PERIOD, "control periods", setup.period)
        wheels = range(1, setup.model.wheels + 1)
        weight = setup.model.total_mass * setup.model.get("gravity")
        lift = weight * setup.model.get("wheel.radius") / setup.model.wheels
        self.noise = {"x": NOISE["x"], "pitch": NOISE["pitch"]}
        self.noise |= {f"wheel[{k}].torque": NOISE["wheel.torque"] * lift for k in wheels}
        self.noise |= {f"wheel[{k}].speed": NOISE["wheel.speed"] for k in wheels}
        self._commands = [variable["name"] for variable in setup.model.inputs()]
        self._places = [mechanics.places[name] for name in self.noise]
        self._rows: list[Floats] = []
        self._inputs: list[Floats] = []
        self._x = mechanics.places["x"]
        self._track = [float(mechanics.signals[0, self._x])]

    def _survey(self) -> tuple[Floats, Floats]:
        """The ground where the rover has been; heights above that where it is now, since a log has no heights."""
        now = float(self._mechanics.signals[0, self._x])
        distances = np.arange(min(self._track) - _MARGIN, max(self._track) + _MARGIN + _GRID, _GRID) - now
        seen = np.zeros((self._mechanics.count, 3 * len(distances)))
        self._mechanics.batch.look_ahead(Ahead(distances), seen)
        return now + distances, seen[0, : len(distances)]

    def before(self) -> None:
        """A row at the start of a step, where one is due."""
        if self._mechanics.elapsed[0] % self._every == 0:
            self._rows.append(self._mechanics.signals[0, self._places])
            self._track.append(float(self._mechanics.signals[0, self._x]))

    def after(self) -> None:
        """The commands of that row, as the rover has got them."""
        if len(self._inputs) < len(self._rows):
            self._inputs.append(self._mechanics.inputs[0].copy())

    def log(self, info: dict[str, Any], total: float) -> Log:
        """The log of the episode that has ended."""
        rows, inputs = np.array(self._rows), np.array(self._inputs)
        columns: dict[str, Floats] = {"time": np.asarray(ROWS_PERIOD * np.arange(len(rows)), np.float64)}
        columns |= {name: inputs[:, k] for k, name in enumerate(self._commands)}
        for k, (name, deviation) in enumerate(self.noise.items()):
            # A generator of each channel's own, so that its noise does not depend on how long the others are.
            columns[name] = rows[:, k] + deviation * np.random.default_rng([self._seed, k]).standard_normal(len(rows))
        return Log(
            target_velocity=float(info["target_velocity"]),
            way=self._mechanics.setup.goal.way(),
            distance=float(info["distance"]),
            seconds=float(info["time"]),
            total=total,
            success=bool(info["success"]),
            run=MeasuredRun(columns, terrain=self._survey(), x0=self._track[0]),
            noise=dict(self.noise),
        )
