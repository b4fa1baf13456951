"""Arguments that the single and the vector environment share, and what follows from them once."""

import json
import pickle
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np
from numpy.random import Generator

from ._bekker import Ahead, Model
from .checked import finite, real
from .costs import Cost, Costs, costs
from .errors import InputError
from .goals import Goal
from .models import ModelLike, as_model
from .randomise import Distribution, Randomise, distribution
from .soil import Soil, as_soil
from .rewards import Term, Terms, terms
from .scales import AHEAD, Observer, action_scale
from .simulation import whole
from .tasks import PERIOD, TARGET, TERRAIN_SEED, Task, task_of
from .vocabulary import unknown
from .worlds import Split, split_of

__all__ = ["Arguments", "Draw", "Levelled", "Options", "Setup", "assign"]

_SEEDS = 2**32

# Wheel speeds that are followed exactly: no motor is in between, and none has parameters.
IDEAL = "speed"


class Arguments(TypedDict, total=False):
    """Arguments by name; those that are left out are the task's."""

    period: float
    """Control period, s, a whole number of the model's inner steps; default 0.02."""
    control: str
    """What the actions command: "torque", "speed" or "speed_loop" of the wheels, or the velocity of a kind of controller."""
    terrain: Mapping[str, Any]
    """The ground, as in the section ``[terrain]`` of a model file."""
    parameters: Mapping[str, float]
    """Values by the vocabulary's names: soil, vehicle, effects, ``sensor.*``, ``terrain.*``, ``terrain.seed``, ``x0``."""
    randomise: Randomise
    """Distributions by name, drawn at every reset; they replace the task's. ``"soil"`` names a known soil (:class:`bekker.Soil`, or the
    path of its file), whose parameters are drawn together."""
    worlds: str | Split
    """A split of worlds (`bekker.worlds.SPLITS`) by its name, or as a `bekker.worlds.Split`: every reset draws another of its worlds, whose
    soil and effect take the place of what the task draws of them, at every level of the curriculum. Meant for the tasks on the two-wheeled
    rover's sand."""
    level: float
    """Level of the curriculum, 0 to 1; default 1."""
    target_velocity: float
    """Speed that the task asks for, m/s."""
    slip_limit: float
    """Slip that the task allows."""
    goal: Goal
    """The criterion of success, see `bekker.goals`."""
    observe: Sequence[str]
    """Signals of the observation; a name such as `wheel.slip` stands for that signal of every wheel."""
    observation_scales: Mapping[str, float]
    """The SI value that an observation of 1 stands for, by the same names. Default: that of the task, where it has one for its own
    map of the ground, or else the natural scale."""
    ahead: Ahead
    """The map of the ground ahead of which `observe` names `height_ahead`, `seen_ahead` or `soil_ahead`: where its cells are, their noise,
    how often one is missing (`bekker.Ahead`). Default: that of the task, where it has one."""
    raw: bool
    """Observations in SI units, clipped at ten scales; default false: normalised, within -1 to 1."""
    measured: bool
    """Observations from the sensors, with their noise, bias, resolution and period (``sensor.*``), in place of the true
    signals; default false."""
    action_scale: float
    """What an action of 1 commands, N m, rad/s or m/s."""
    rewards: Terms
    """Terms of the reward, by name (`bekker.rewards.TERMS`) or as objects."""
    reward_weights: Mapping[str, float]
    """Weights of the terms, by name; terms that are left out keep their default weight."""
    costs: Costs
    """Costs of safety in ``info``, by name (`bekker.costs.COSTS`), with their limits, or as objects; True for all, default none."""


@dataclass(frozen=True)
class Draw:
    """What a reset has decided."""

    model: Model
    drawn: dict[str, float]
    target_velocity: float


class Setup:
    """All that does not change from episode to episode, checked.

    Attributes:
        level: level of the curriculum, 0 to 1, which the next resets use.
    """

    def __init__(self, task: str | Task, model: ModelLike | None, given: Arguments) -> None:
        self.task = task_of(task)
        known = Arguments.__annotations__
        for name in given:
            if name not in known:
                raise unknown("argument", name, known)
        self.model = self._model(model, given)
        self.period = given.get("period", PERIOD)
        self.steps = whole("period", self.period, "inner steps", self.model.step_size)
        self.target_velocity = finite("target_velocity", given.get("target_velocity", self.task.target_velocity))
        self.slip_limit = finite("slip_limit", given.get("slip_limit", self.task.slip_limit), above=0.0)
        self.goal = given.get("goal", self.task.goal)
        if not isinstance(self.goal, Goal):
            raise InputError(f"goal = {self.goal!r}: expected a goal of bekker.goals, such as Reach(3.0)")
        self.measured = bool(given.get("measured", False))
        self.terms: tuple[Term, ...] = terms(given.get("rewards", self.task.rewards), given.get("reward_weights", {}))
        self.costs: tuple[Cost, ...] = costs(given.get("costs", ()), self.slip_limit)
        own_scale = self._own_scale(model, given)
        self.action_scale = finite("action_scale", given.get("action_scale", own_scale), above=0.0)
        observed = given.get("observe", self.task.observe)
        # The task's scales are chosen for its own map.
        own_scales = {} if "ahead" in given else self.task.observation_scales
        scales = {**own_scales, **given.get("observation_scales", {})}
        sees = any(name in AHEAD for name in observed)
        self.ahead = given.get("ahead", self.task.ahead if sees else None)
        self.observer = Observer(self.model, observed, scales, raw=given.get("raw", False), ahead=self.ahead)
        self._scatter(given)
        self.level = given.get("level", 1.0)

    def _model(self, model: ModelLike | None, given: Arguments) -> Model:
        own = as_model(self.task.model if model is None else model)
        control = given.get("control", self.task.control)
        if control is not None:
            own.set_control(control)
        terrain = given.get("terrain", self.task.terrain)
        if terrain is not None:
            if not isinstance(terrain, Mapping):
                keys = '{"preset": "slope", "slope": 0.1}'
                raise InputError(f"terrain = {terrain!r}: expected the keys of the section [terrain] of a model file, such as {keys}")
            own.set_terrain(json.dumps(_plain(terrain)))
        # The task's values belong to its own vehicle.
        task = {} if model is not None else self.task.parameters if own.control == IDEAL else {**self.task.parameters, **self.task.drive}
        for name, value in {**task, **given.get("parameters", {})}.items():
            assign(own, name, value)
        # As a file keeps it, without numbers that nothing reads: then a pickle is the same model in all of its parts.
        kept: Model = pickle.loads(pickle.dumps(own))
        return kept

    def _own_scale(self, model: ModelLike | None, given: Arguments) -> float:
        own = self.task.action_scale
        # The task's number belongs to its own vehicle and drive.
        return action_scale(self.model) if own is None or model is not None or "control" in given else own

    def _scatter(self, given: Arguments) -> None:
        # What the user has decided is not the task's to change.
        set_by_user = set(given.get("parameters", ())) | ({"target_velocity"} & set(given))

        def kept(name: str) -> bool:
            return name not in set_by_user and not (name.startswith("terrain.") and "terrain" in given)

        self.grades = {name: ends for name, ends in self.task.grades.items() if kept(name)}
        if "randomise" in given:
            self.randomise, self.soil = parted(given["randomise"])
        else:
            self.soil = None
            self.randomise = {name: d for name, d in self.task.randomise.items() if kept(name)}
        self.worlds = split_of(given["worlds"]) if "worlds" in given else None
        if self.worlds is not None:
            of_worlds = {name for name, _ in self.worlds.distributions}
            self.refuse_of_worlds({*set_by_user, *given.get("randomise", ())})
            self.randomise = {name: d for name, d in self.randomise.items() if name not in of_worlds}
            self._check_values(self.worlds.distributions)
        trial = self.model.copy()
        for name, ends in self.grades.items():
            for value in ends:
                assign(trial, name, value)
        self.check_ends(self.randomise)

    def check_ends(self, randomise: Mapping[str, Distribution]) -> None:
        """Refuses distributions whose values the model does not take."""
        self._check_values(randomise.items())

    def refuse_of_worlds(self, names: Iterable[str]) -> None:
        """Refuses distributions and values besides those of the worlds."""
        if self.worlds is None:
            return
        of_worlds = {name for name, _ in self.worlds.distributions} | {"soil"}
        for name in names:
            if name in of_worlds:
                raise InputError(f"`{name}` is drawn with the worlds `{self.worlds.name}`: expected it not to be given besides")

    def _check_values(self, scattered: Iterable[tuple[str, Distribution]]) -> None:
        trial = self.model.copy()
        for name, scatter in scattered:
            for value in scatter.ends():
                if name != TARGET:
                    assign(trial, name, value)

    @property
    def level(self) -> float:
        return self._level

    @level.setter
    def level(self, level: float) -> None:
        self._level = checked_level(level)

    def draw(
        self, random: Generator, seed: int | None, options: "Options", level: float, randomise: Mapping[str, Distribution]
    ) -> Draw:
        """A model for the next episode. Always as many draws, so that options do not shift the sequence."""
        model = self.model.copy()
        nominal: dict[str, float] = {TARGET: self.target_velocity}
        for name, (easy, hard) in self.grades.items():
            nominal[name] = easy + level * (hard - easy)
            assign(model, name, nominal[name])
        soil = options.soil or self.soil
        drawn = {} if soil is None else soil.draw(random, model, level)
        if self.worlds is not None:
            # Drawn also where it is not used, so that an option does not shift the sequence.
            world = self.worlds.world(int(random.integers(_SEEDS)))
            drawn |= world.parameters if options.worlds else {}
        for name, scatter in randomise.items():
            if name != TERRAIN_SEED:
                own = nominal.get(name)
                scatter = scatter.at(level, _value(model, name) if own is None else own)
            value = scatter.draw(random)
            # The seed of a ground is a whole number.
            drawn[name] = float(int(value)) if name == TERRAIN_SEED else value
        model.seed = int(random.integers(_SEEDS)) if seed is None else seed % _SEEDS
        values = drawn | options.parameters
        target = values.pop(TARGET, self.target_velocity)
        for name, value in values.items():
            assign(model, name, value)
        return Draw(model, drawn, target)


@dataclass(frozen=True)
class Options:
    """Options of a reset: for that episode only, after the drawing."""

    parameters: dict[str, float]
    level: float | None
    randomise: dict[str, Distribution]
    soil: Soil | None = None
    worlds: bool = True
    """Whether a world is drawn, where the environment has any."""

    @classmethod
    def of(cls, options: Mapping[str, Any] | None, setup: Setup) -> "Options":
        """Checked options; values of parameters are checked when they are set."""
        given, known = options or {}, ("parameters", "x0", "level", "randomise", "worlds", TARGET)
        for name in given:
            if name not in known:
                raise unknown("option", name, known)
        direct = {name: given[name] for name in ("x0", TARGET) if name in given}
        level = given.get("level")
        drawn, worlds = given.get("randomise", {}), given.get("worlds", True)
        if not isinstance(worlds, bool):
            raise InputError(f"option worlds = {worlds!r}: expected True or False")
        if worlds:
            setup.refuse_of_worlds(drawn)
        scatter, soil = parted(drawn)
        setup.check_ends(scatter)
        level = None if level is None else checked_level(level)
        return cls(dict(given.get("parameters", {})) | direct, level, scatter, soil, worlds)


def parted(randomise: Randomise) -> tuple[dict[str, Distribution], Soil | None]:
    """Distributions of single parameters, and the known soil whose parameters are drawn together."""
    soil = randomise.get("soil")
    single = {name: distribution(name, d) for name, d in randomise.items() if name != "soil"}
    return single, None if soil is None else as_soil(soil)


class Levelled:
    """What environments have of the curriculum."""

    setup: Setup

    @property
    def level(self) -> float:
        """Level of the curriculum, 0 to 1, from the next reset on."""
        return self.setup.level

    @level.setter
    def level(self, level: float) -> None:
        self.setup.level = level


def checked_level(level: float) -> float:
    """A level of the curriculum."""
    value = real("level", level)
    if not 0.0 <= value <= 1.0:
        raise InputError(f"level = {level}: expected a number within 0 .. 1")
    return value


def assign(model: Model, name: str, value: float) -> None:
    """Sets a parameter, a number of a sensor, whether or not a controller reads it, or the seed of random ground."""
    value = real(name, value)
    if name == TERRAIN_SEED:
        model.reseed_terrain(int(value))
    elif name.startswith("sensor."):
        model.set_sensor(name, value)
    else:
        model.set(name, value)


def _value(model: Model, name: str) -> float:
    if name.startswith("sensor."):
        return next(sensor["value"] for sensor in model.sensors() if sensor["name"] == name)
    return model.get(name)


def _plain(data: Any) -> Any:
    """Lists and numbers for JSON, from numpy's too."""
    if isinstance(data, Mapping):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, str):
        return data
    if isinstance(data, np.ndarray | Sequence):
        return [_plain(value) for value in data]
    return data.item() if isinstance(data, np.generic) else data
