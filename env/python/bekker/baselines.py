# mypy: disable-error-code="import-untyped,import-not-found"
"""Policies to compare with, behind one interface: ``action, state = policy.predict(observation)``.

It is that of stable-baselines3, so whatever takes its models takes these too, and the other way round::

    env = gymnasium.make("bekker/SpeedHold-v0")
    policy = bekker.baselines.velocity(env)
    result = bekker.baselines.evaluate(env, policy, seeds=range(20))

The controllers are those of the core. They see what a learned policy sees, the observation, and know the data sheet of
the vehicle (``env.unwrapped.setup.model``), not what was drawn for the episode.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ._bekker import Controller
from .env import RoverEnv
from .errors import InputError

__all__ = [
    "CONTROLLERS",
    "CarefulSpeeds",
    "Constant",
    "ControllerPolicy",
    "Evaluation",
    "Policy",
    "WheelSpeeds",
    "constant",
    "evaluate",
    "rtc",
    "rtc_speed",
    "slip_control",
    "trained",
    "velocity",
]

Floats = NDArray[np.float64]
Actions = NDArray[np.float32]
State = tuple[Any, ...] | None

CONTROLLERS = ("velocity", "velocity_tuned", "rtc", "rtc_speed", "equal_torque", "slip")
"""Kinds of controllers, as in a model file."""

_NEEDED = ("pitch", "pitch_rate", "velocity")
_WHEEL = ("speed", "torque", "contact_angle")

# Share of the schedule by which CarefulSpeeds aims to be early.
_EARLY = 0.05

# Speed of a wheel's centre below which slip says nothing, m/s, as slip control has it.
_SLOWEST = 0.02


class Policy(Protocol):
    """What maps observations to actions."""

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Any, State]:
        """The action for an observation of one environment. ``episode_start`` is true where an episode has just begun."""


@dataclass
class Constant:
    """Always the same action."""

    action: Actions

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Any, State]:
        """The action, for one observation or a row of it for each."""
        rows = np.asarray(observation).shape[:-1]
        return np.broadcast_to(self.action, (*rows, len(self.action))).copy(), state


def constant(env: gymnasium.Env[Any, Any], action: float = 0.3) -> Constant:
    """The same share of the scale on every wheel."""
    return Constant(np.full(rover_of(env).action_space.shape or (), action, dtype=np.float32))


class ControllerPolicy:
    """A controller of the core that reads the observation and commands torques.

    Args:
        env: the environment, whose actions must be torques and whose observation must have the default signals.
        kind: one of :data:`CONTROLLERS`.
        speed: the speed to hold, m/s; where the observation has ``target_velocity``, that is held instead.

    A call with ``episode_start`` true, and the first one, start the controller anew. Slip control is given the slip that
    the measured speeds say, 1 - v/(r omega), as no rover knows the true one.

    Raises:
        InputError: actions are no torques, or the observation lacks what a rover's sensors tell.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], kind: str, speed: float = 0.25) -> None:
        setup = rover_of(env).setup
        self._model, self._observer = setup.model, setup.observer
        if self._model.control != "torque":
            raise InputError(f"a controller commands torques, this environment's actions are {self._model.control!r}")
        names = self._observer.names
        wheels = range(1, self._model.wheels + 1)
        missing = [name for name in (*_NEEDED, *(f"wheel[{k}].{s}" for k in wheels for s in _WHEEL)) if name not in names]
        missing += [f"link[{k}].angle" for k in range(1, self._model.links + 1) if f"link[{k}].angle" not in names]
        if missing:
            raise InputError(f"a controller needs {', '.join(missing)} in the observation (observe=)")
        self._body = [names.index(name) for name in _NEEDED]
        self._wheels = np.array([[names.index(f"wheel[{k}].{s}") for s in _WHEEL] for k in wheels])
        self._links = [names.index(f"link[{k}].angle") for k in range(1, self._model.links + 1)]
        self._target = names.index("target_velocity") if "target_velocity" in names else None
        self._radius = self._model.get("wheel.radius")
        self._scale, self._period, self._kind, self._speed = setup.action_scale, setup.period, kind, speed
        self._raw = not np.all(self._observer.limit == 1.0)
        self._start()

    def _start(self) -> None:
        self._controller = Controller(self._model, self._kind, self._period)
        self._angles: Floats | None = None

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Actions, State]:
        """The action for one observation."""
        if episode_start is not None and np.any(episode_start):
            self._start()
        seen = np.asarray(observation, dtype=np.float64)
        if seen.ndim != 1:
            raise InputError(f"observation of shape {seen.shape}: a controller drives one rover, make one for each")
        values = seen if self._raw else seen * self._observer.scales
        goal = self._speed if self._target is None else float(values[self._target])
        pitch, rate, velocity = (float(values[k]) for k in self._body)
        angles = values[self._links]
        rates = np.zeros_like(angles) if self._angles is None else (angles - self._angles) / self._period
        self._angles = angles
        wheels = values[self._wheels]
        slip = self._slip(velocity, wheels[:, 0] - rate)
        links = np.stack([angles, rates], axis=1)
        torques = self._controller.decide(goal, [pitch, rate, velocity], wheels, links, slip)
        return np.clip(torques / self._scale, -1.0, 1.0).astype(np.float32), state

    def _slip(self, velocity: float, turning: Floats) -> Floats:
        """Slip by odometry: driving 1 - v/(r omega), braking r omega/v - 1, nothing near standstill."""
        rim = self._radius * turning
        largest = np.maximum(np.abs(rim), abs(velocity))
        slip = np.where(np.abs(rim) >= abs(velocity), 1.0 - velocity / np.where(rim == 0.0, 1.0, rim), rim / (velocity or 1.0) - 1.0)
        return np.clip(np.where(largest < _SLOWEST, 0.0, slip), -1.0, 1.0)


class WheelSpeeds:
    """Every wheel at the speed that rolls without slip at ``speed``, where the actions are wheel speeds: individual-wheel
    velocity control, whose loops are inside the environment then."""

    def __init__(self, env: gymnasium.Env[Any, Any], speed: float = 0.25) -> None:
        setup = rover_of(env).setup
        if setup.model.control not in ("speed", "speed_loop"):
            raise InputError(f"expected wheel speeds as actions, this environment's are {setup.model.control!r}")
        names = setup.observer.names
        self._target = names.index("target_velocity") if "target_velocity" in names else None
        self._scale = setup.observer.scales if np.all(setup.observer.limit == 1.0) else np.ones(len(names))
        self._per_speed = 1.0 / (setup.model.get("wheel.radius") * setup.action_scale)
        self._speed, self._wheels = speed, setup.model.wheels

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Actions, State]:
        """The action for one observation."""
        goal = self._speed if self._target is None else float(observation[self._target] * self._scale[self._target])
        return np.full(self._wheels, np.clip(goal * self._per_speed, -1.0, 1.0), dtype=np.float32), state


class CarefulSpeeds:
    """Equal wheel speeds that aim to reach a goal on schedule and are lower where a map shows steep ground near a wheel.

    The map is `height_ahead` of the observation. Near a wheel means up to one radius of a wheel behind its axle and two radii before it.
    Where the slope between neighbouring cells there is above ``steep``, the wheels turn for ``slow`` times the speed that is needed to
    arrive 5 % of the schedule early, otherwise for ``fast`` times that speed.

    Args:
        env: the environment, whose actions must be wheel speeds, and whose observation must have `target_velocity`, `goal_distance`,
            `time_left`, `height_ahead` and `seen_ahead`.
        steep: the slope from which ground is steep.
        slow: factor on the speed near steep ground.
        fast: factor on the speed elsewhere.
        slip: slip for which the wheels turn faster than they would roll.

    Raises:
        InputError: the actions are no wheel speeds, the observation lacks something of these, or a number is out of its range.
    """

    def __init__(
        self, env: gymnasium.Env[Any, Any], steep: float = 0.2, slow: float = 0.5, fast: float = 2.0, slip: float = 0.1
    ) -> None:
        setup = rover_of(env).setup
        observer, model, ahead = setup.observer, setup.model, setup.ahead
        needed = ("target_velocity", "goal_distance", "time_left", "height_ahead[1]", "seen_ahead[1]")
        missing = [name for name in needed if name not in observer.names]
        if model.control not in ("speed", "speed_loop") or ahead is None or missing:
            lacks = f", which lacks {', '.join(missing)}" if missing else ""
            raise InputError(f"expected wheel speeds as actions and a map of the ground ahead in the observation{lacks}")
        if not (steep > 0.0 and 0.0 < slow <= fast and 0.0 <= slip < 1.0):
            raise InputError(f"steep = {steep}, slow = {slow}, fast = {fast}, slip = {slip}: expected steep > 0, 0 < slow <= fast, 0 <= slip < 1")
        distances = np.array(ahead.distances)
        self._order = np.argsort(distances)
        self._distances = distances[self._order]
        self._scale = observer.scales if np.all(observer.limit == 1.0) else np.ones(len(observer.names))
        self._names = [observer.names.index(name) for name in needed[:3]]
        self._heights, self._seen = (
            np.array([observer.names.index(f"{kind}[{k + 1}]") for k in self._order]) for kind in ("height_ahead", "seen_ahead")
        )
        radius = model.get("wheel.radius")
        self._wheels = np.array([model.get(f"wheel[{k}].x") for k in range(1, model.wheels + 1)])
        self._reach = (-radius, 2.0 * radius)
        self._per_speed = 1.0 / ((1.0 - slip) * radius * setup.action_scale)
        self._steep, self._slow, self._fast = steep, slow, fast

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Actions, State]:
        """The action for one observation."""
        values = np.asarray(observation, dtype=np.float64) * self._scale
        target, way, time = (float(values[k]) for k in self._names)
        # Time left is a share of the schedule, the way left one of the way. A little early, and never at rest before the goal.
        needed = target * min(max(way, 0.02) / max(time - _EARLY, 0.02), 2.0)
        speed = (self._slow if self._is_steep(values) else self._fast) * needed
        return np.full(len(self._wheels), np.clip(speed * self._per_speed, 0.0, 1.0), dtype=np.float32), state

    def _is_steep(self, values: Floats) -> bool:
        there = values[self._seen] > 0.5
        x, z = self._distances[there], values[self._heights][there]
        if len(x) < 2:
            return False
        slopes, middles = np.abs(np.diff(z) / np.diff(x)), 0.5 * (x[1:] + x[:-1])
        apart = middles[:, np.newaxis] - self._wheels
        near = np.any((apart > self._reach[0]) & (apart < self._reach[1]), axis=1)
        return bool(np.any(slopes[near] > self._steep))


def velocity(env: gymnasium.Env[Any, Any], speed: float = 0.25) -> ControllerPolicy | WheelSpeeds:
    """Individual-wheel velocity control, the thesis's baseline: by torques or, where the actions are wheel speeds, by
    those."""
    if rover_of(env).setup.model.control in ("speed", "speed_loop"):
        return WheelSpeeds(env, speed)
    return ControllerPolicy(env, "velocity", speed)


def rtc(env: gymnasium.Env[Any, Any], speed: float = 0.25) -> ControllerPolicy:
    """Rough-terrain control (Iagnemma 2001, chapter 4)."""
    return ControllerPolicy(env, "rtc", speed)


def rtc_speed(env: gymnasium.Env[Any, Any], speed: float = 0.25) -> ControllerPolicy:
    """Rough-terrain control with wheel-speed loops: the same force distribution, turned into slips and wheel speeds."""
    return ControllerPolicy(env, "rtc_speed", speed)


def slip_control(env: gymnasium.Env[Any, Any], speed: float = 0.25) -> ControllerPolicy:
    """The same slip at all wheels, by odometry."""
    return ControllerPolicy(env, "slip", speed)


def trained(path: str | Path, algorithm: str = "PPO") -> Policy:
    """A policy that stable-baselines3 has saved; needs stable-baselines3.

    Raises:
        ImportError: the library is not installed.
        InputError: there is no such algorithm.
    """
    try:
        import stable_baselines3
    except ImportError as missing:
        raise ImportError("bekker.baselines.trained needs stable-baselines3 (pip install stable-baselines3)") from missing
    known = ("A2C", "DDPG", "PPO", "SAC", "TD3")
    if algorithm not in known:
        raise InputError(f"algorithm = {algorithm!r}: expected one of {', '.join(known)}")
    loaded: Policy = getattr(stable_baselines3, algorithm).load(path, device="cpu")
    return loaded


@dataclass
class Evaluation:
    """Episodes of one policy, one entry a seed."""

    returns: Floats
    success: NDArray[np.bool_]
    energy: Floats
    """Electrical, J."""
    distance: Floats
    """Along x, m."""
    steps: NDArray[np.int64]
    status: list[str]

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the mean return: bootstrap over the seeds, by percentiles."""
        random = np.random.default_rng(0)
        n = len(self.returns)
        means = self.returns[random.integers(n, size=(10_000, n))].mean(axis=1)
        low, high = np.quantile(means, [0.025, 0.975])
        return float(low), float(high)


def evaluate(env: gymnasium.Env[Any, Any], policy: Policy, seeds: Iterable[int]) -> Evaluation:
    """Drives one episode a seed, to its end. The same seeds give all policies the same soils and grounds."""
    returns, success, energy, distance, steps, status = [], [], [], [], [], []
    for seed in seeds:
        observation, info = env.reset(seed=int(seed))
        total, count, over, state = 0.0, 0, False, None
        start: Any = np.ones(1, dtype=np.bool_)
        while not over:
            action, state = policy.predict(observation, state=state, episode_start=start, deterministic=True)
            start = np.zeros(1, dtype=np.bool_)
            observation, reward, terminated, truncated, info = env.step(action)
            total, count, over = total + float(reward), count + 1, terminated or truncated
        returns.append(total)
        success.append(bool(info["success"]))
        energy.append(float(info["electrical_energy"]))
        distance.append(float(info["distance"]))
        steps.append(count)
        status.append(str(info["status"]))
    if not returns:
        raise InputError("seeds: expected at least one")
    return Evaluation(
        np.array(returns), np.array(success), np.array(energy), np.array(distance), np.array(steps), status
    )


def rover_of(env: gymnasium.Env[Any, Any]) -> RoverEnv:
    """The rover inside the wrappers of an environment.

    Raises:
        InputError: it is not one of bekker's.
    """
    inner = env.unwrapped
    if not isinstance(inner, RoverEnv):
        raise InputError(f"env: expected an environment of bekker, found {type(inner).__name__}")
    return inner
