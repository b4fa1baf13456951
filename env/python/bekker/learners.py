"""Policies for `bekker/BlindSlope-v0` that plan a drive with a model before it begins, and learn from it for the next.

All of them command one wheel speed for the whole drive, the one with which a model comes to the goal on time. They differ in the
model: :class:`Nominal` has the data sheet's; :class:`Robust` takes what suits most worlds of the training split; :class:`Rescaling` and
:class:`SlipCurve` multiply the data sheet's speed by a factor that former drives have needed, a constant or one that grows with the
slope; :class:`Calibrating` fits the soil to all drives so far (:func:`bekker.calibrate`); :class:`Diagnosing` takes the best-fitting model of
a diagnosis of all drives so far (:func:`bekker.diagnose`), which may have a hidden effect. :class:`Informed` is an oracle, which is told
the world.
"""

from math import radians
from typing import Any

import gymnasium
import numpy as np

from ._bekker import Model
from .adaptation import Log
from .baselines import Actions, State, rover_of
from .comparison import calibrate
from .diagnosis import diagnose
from .errors import InputError, SimulationError
from .experiment import Experiment, MeasuredRun
from .goals import ReachOnSchedule
from .simulation import simulate
from .worlds import SPLITS, World

__all__ = ["Calibrating", "Diagnosing", "Informed", "Nominal", "Rescaling", "Robust", "SlipCurve", "wheel_speed_for"]

_PERIOD = 0.1
"""Period of the inputs of a planned drive, s."""

_TRIES = 8
"""Simulated drives that a plan takes at most."""

_CLOSE = 0.005
"""A plan that comes so close to the goal, over the way, is good enough: the schedule allows ten times that."""

_FIRST_RATIO, _MOST_RATIO = 1.2, 5.0
"""Speed of the rims over that of the rover in the first drive of a plan, and at most."""

PRIORS = {
    "soil.cohesion": (1000.0, 500.0),
    "soil.friction_angle": (radians(30.0), radians(3.0)),
    "soil.shear_modulus": (0.01, 0.002),
}
"""What a fit is told of the sand besides the data sheet: means and standard deviations. The soils of all splits (`bekker.worlds`) lie within
two and a half of these deviations, and all of them have the shear modulus of the mean."""


def wheel_speed_for(model: Model, slope: float, way: float, seconds: float) -> float:
    """The wheel speed with which a model comes ``way`` (m) up a plane in ``seconds``, rad/s.

    Where no speed up to five times that of rolling without slip does, the one that comes closest of those tried.

    Args:
        model: a rover whose inputs are wheel speeds and whose ground is a plane.
        slope: of the plane, rad, uphill positive.
        way: along x.
        seconds: from rest; rounded to 0.1 s.
    """
    ground = model.copy()
    ground.set("terrain.slope", slope)
    seconds = max(round(seconds / _PERIOD), 1) * _PERIOD
    rolling = way / (seconds * model.get("wheel.radius"))
    speed, best, missed = _FIRST_RATIO * rolling, _FIRST_RATIO * rolling, np.inf
    for _ in range(_TRIES):
        made = _distance(ground, speed, seconds)
        if abs(made - way) < missed:
            best, missed = speed, abs(made - way)
        if missed <= _CLOSE * way:
            break
        speed = min(speed * min(max(way / max(made, 1e-3 * way), 0.5), 2.0), _MOST_RATIO * rolling)
    return best


def _distance(model: Model, speed: float, seconds: float) -> float:
    """How far a model comes at a constant wheel speed, m; 0 where it cannot start."""
    inputs = {variable["name"]: speed for variable in model.inputs()}
    try:
        x = simulate(model, seconds, inputs=inputs, period=_PERIOD)["x"]
    except SimulationError:
        return 0.0
    return float(x[-1] - x[0])


class Nominal:
    """Plans with the environment's model, the data sheet, in every episode.

    Raises:
        InputError: the ground is no plane, the actions are no wheel speeds, the goal is not at a distance, or the observation lacks the speed
            asked for or the pitch.
    """

    note = ""
    """A line about what it has learned from the last episode."""

    def __init__(self, env: gymnasium.Env[Any, Any], world: World) -> None:
        setup = rover_of(env).setup
        names = setup.observer.names
        plane = any(variable["name"] == "terrain.slope" for variable in setup.model.parameters())
        needed = plane and setup.model.control in ("speed", "speed_loop") and setup.goal.way() > 0.0
        if not needed or not {"target_velocity", "pitch"} <= set(names):
            raise InputError(
                "a learner needs a plane as ground, wheel speeds as actions, a goal at a distance, and `target_velocity` and `pitch` in the "
                "observation"
            )
        self._target, self._pitch = names.index("target_velocity"), names.index("pitch")
        self._scales = setup.observer.scales if np.all(setup.observer.limit == 1.0) else np.ones(len(names))
        self._way, self._scale, self._wheels = setup.goal.way(), setup.action_scale, setup.model.wheels
        self.model = setup.model
        """The model with which it plans."""
        self._action = np.zeros(self._wheels, np.float32)

    def plan(self, slope: float, seconds: float) -> float:
        """The wheel speed for a drive, rad/s."""
        return wheel_speed_for(self.model, slope, self._way, seconds)

    def predict(
        self, observation: Any, state: State = None, episode_start: Any = None, deterministic: bool = False
    ) -> tuple[Actions, State]:
        """The action for one observation; planned where ``episode_start`` is true, from the pitch at rest and the speed asked for."""
        if episode_start is not None and np.any(episode_start):
            seen = np.asarray(observation, np.float64) * self._scales
            speed = self.plan(float(seen[self._pitch]), self._way / float(seen[self._target]))
            self._action = np.full(self._wheels, np.clip(speed / self._scale, -1.0, 1.0), np.float32)
        return self._action, state


class Informed(Nominal):
    """An oracle: its model is the world's."""

    def __init__(self, env: gymnasium.Env[Any, Any], world: World) -> None:
        super().__init__(env, world)
        self.model = world.on(self.model)


class Robust(Nominal):
    """Takes the speed that is on time in most of the first worlds of the training split.

    Raises:
        InputError: as :class:`Nominal`, or the goal has no schedule.
    """

    WORLDS = 24

    def __init__(self, env: gymnasium.Env[Any, Any], world: World) -> None:
        super().__init__(env, world)
        goal = rover_of(env).setup.goal
        if not isinstance(goal, ReachOnSchedule) or goal.early <= 0.0:
            raise InputError("a robust plan needs a goal with an earliest and a latest arrival (bekker.goals.ReachOnSchedule)")
        # Speed and time of arrival are nearly inverse, so that this ratio holds for both.
        self._allowed = float(np.log(goal.late / goal.early))
        self._models = [drawn.on(self.model) for drawn in SPLITS["train"].worlds(self.WORLDS)]

    def plan(self, slope: float, seconds: float) -> float:
        """The middle of the range, as wide as the schedule allows, that holds most of the worlds' speeds."""
        speeds = np.log(sorted(wheel_speed_for(model, slope, self._way, seconds) for model in self._models))
        inside = [np.flatnonzero((speeds >= low) & (speeds <= low + self._allowed)) for low in speeds]
        most = max(inside, key=len)
        return float(np.exp(0.5 * (speeds[most[0]] + speeds[most[-1]])))


class Rescaling(Nominal):
    """Multiplies the speed of the data sheet's plan by the factor that the drives so far have needed: no model of what is hidden.

    The factor is the geometric mean over these drives.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], world: World) -> None:
        super().__init__(env, world)
        self._factor = 1.0
        self._needed: list[float] = []

    def plan(self, slope: float, seconds: float) -> float:
        """The data sheet's plan, corrected."""
        return self._factor * super().plan(slope, seconds)

    def learn(self, log: Log) -> None:
        """What the drive needed is its factor, times how late it was. Of a drive that did not arrive the time for the whole way is
        taken, at its mean speed."""
        made = max(log.distance, 0.05 * log.way)
        late = log.seconds * (log.way / made) * log.target_velocity / log.way
        self._needed.append(self._factor * late)
        self._factor = float(np.exp(np.mean(np.log(self._needed))))
        self.note = f"factor {self._factor:.3f}"


class SlipCurve(Rescaling):
    """The same with a factor that depends on the slope, as slip is plotted against slope in the operation of rovers: a line through the
    logarithms of the factors that the drives so far have needed, by least squares with a prior."""

    PRIOR = (0.2, 1.5)
    """Standard deviations of the logarithm on level ground and of its growth with the sine of the slope."""

    SCATTER = 0.02
    """Standard deviation of the logarithms about the line."""

    def __init__(self, env: gymnasium.Env[Any, Any], world: World) -> None:
        super().__init__(env, world)
        self._slopes: list[float] = []
        self._planned = 0.0
        self._line = np.zeros(2)

    def plan(self, slope: float, seconds: float) -> float:
        """The data sheet's plan, corrected for this slope."""
        self._planned = float(np.sin(slope))
        self._factor = float(np.exp(self._line @ (1.0, self._planned)))
        return super().plan(slope, seconds)

    def learn(self, log: Log) -> None:
        """Fits the line anew."""
        super().learn(log)
        self._slopes.append(self._planned)
        matrix = np.stack([np.ones(len(self._needed)), self._slopes], axis=1) / self.SCATTER
        normal = matrix.T @ matrix + np.diag(np.power(self.PRIOR, -2.0))
        self._line = np.linalg.solve(normal, matrix.T @ np.log(self._needed) / self.SCATTER)
        self.note = f"factor {np.exp(self._line[0]):.3f}, growth {self._line[1]:.2f}"


class Calibrating(Nominal):
    """Fits the soil to all drives of the world so far.

    The measured speeds of the wheels drive the model, without the commands: then neither the motors nor their controller matter, and a
    calibration to four drives took 5 s in place of 60 s (one measurement of each).
    """

    def __init__(self, env: gymnasium.Env[Any, Any], world: World) -> None:
        super().__init__(env, world)
        self._runs: list[MeasuredRun] = []
        self._sheet = self.model.copy()
        self._sheet.set_control("speed")

    def learn(self, log: Log) -> None:
        """A fit that fails leaves the model as it is, and the note says why."""
        try:
            run, noise = log.by_measured_speeds()
            experiment = Experiment("traverse", [*self._runs, run], priors=PRIORS, noise=noise)
            self._runs.append(run)
            self.model, self.note = self._fit(experiment)
        except (InputError, SimulationError) as error:
            self.note = f"no fit: {error}"

    def _fit(self, experiment: Experiment) -> tuple[Model, str]:
        return calibrate(experiment, self._sheet).model, "calibrated"


class Diagnosing(Calibrating):
    """Diagnoses all drives of the world so far, and plans with the best-fitting model (:attr:`bekker.Diagnosis.improved`), which may contain an
    effect that the verdict leaves open."""

    def _fit(self, experiment: Experiment) -> tuple[Model, str]:
        found = diagnose(experiment, self._sheet)
        return found.improved, " ".join([found.verdict, *(found.effects or found.tied)])
