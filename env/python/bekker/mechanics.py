"""Rovers in motion and what they are worth: the inside of the single and the vector environment alike."""

import copy
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from ._bekker import Batch, Model, Run
from .arguments import Options, Setup
from .errors import InputError, SimulationError
from .goals import Way
from .rewards import Step
from .scales import AHEAD
from .state import GOAL, STATUSES, MechanicsState, Numbers

__all__ = ["Mechanics", "MechanicsState", "as_array"]

Floats: TypeAlias = NDArray[np.float64]
Bools: TypeAlias = NDArray[np.bool_]

TRIES = 10
"""Draws of a model that finds no rest (a soil that does not carry the rover) before a reset gives up."""

def as_array(actions: ArrayLike) -> NDArray[Any]:
    """Actions as an array, of whatever type they are.

    Raises:
        InputError: rows of different lengths.
    """
    try:
        values: NDArray[Any] = np.asarray(actions)
    except ValueError:
        raise InputError("the actions have rows of different lengths: expected one length") from None
    return values


class Mechanics:
    """Some rovers of one setup, each in an episode of its own.

    All arithmetic is entry by entry, so that what happens to a rover depends neither on the others nor on their number.
    """

    def __init__(self, setup: Setup, count: int, threads: int = 1) -> None:
        self.setup = setup
        self.count = count
        self.threads = threads
        model = setup.model
        names = [variable["name"] for variable in model.signals()]
        self.places = {name: k for k, name in enumerate(names)}
        wheels = range(1, model.wheels + 1)
        self._slip = np.array([self.places[f"wheel[{k}].slip"] for k in wheels])
        self._sinkage = np.array([self.places[f"wheel[{k}].sinkage"] for k in wheels])
        self._x, self._energy = self.places["x"], self.places["electrical_energy"]
        self._zeros = np.zeros(count)
        self._all = np.ones(count, np.bool_)
        self._keys = [f"reward_{term.name}" for term in setup.terms]
        self._cost_keys = [f"cost_{cost.name}" for cost in setup.costs]
        self._models = [model] * count
        self._batch: Batch | None = None
        self.inputs = np.zeros((count, len(model.inputs())))
        self._before = np.zeros((count, len(names)))
        self._numbers = Numbers.fresh(count, len(names), len(setup.terms), len(setup.costs))
        read = self._begun(model).measured_names if setup.measured else []
        if setup.measured:
            for name in set(setup.observer.names) & set(names) - set(read):
                raise InputError(f"observe `{name}`: no sensor reads it; expected {', '.join(sorted(read))}")
        cells = 0 if setup.ahead is None else len(setup.ahead.distances)
        self._sight = np.zeros((count, len(AHEAD) * cells))
        self._observed = setup.observer.signals([self.places[name] for name in read])

    # Episodes

    def start(self, index: int, random: Generator, seed: int | None = None, options: Options | None = None) -> None:
        """Starts an episode of one rover. ``seed`` decides the noise of its sensors, which is drawn where it is None.

        Raises:
            ModelError: a value is refused.
            SimulationError: the rover finds no rest on the ground, in any of some draws.
        """
        chosen = options or Options({}, None, {})
        level = self.setup.level if chosen.level is None else chosen.level
        randomise = self.setup.randomise | chosen.randomise
        for attempt in range(TRIES):
            draw = self.setup.draw(random, seed, chosen, level, randomise)
            try:
                run = self._begun(draw.model)
                break
            except SimulationError:
                scattered = randomise or self.setup.soil or chosen.soil or (self.setup.worlds and chosen.worlds)
                if not scattered or attempt == TRIES - 1:
                    raise
        self._put(index, run)
        numbers = self._numbers
        self._models[index] = draw.model
        numbers.states[index] = numbers.codes[index]
        numbers.steps[index] = 0
        numbers.tally[index] = 0.0
        numbers.start_x[index] = numbers.signals[index, self._x]
        numbers.weight[index] = draw.model.total_mass * draw.model.get("gravity")
        numbers.radius[index] = draw.model.get("wheel.radius")
        numbers.target_velocity[index] = draw.target_velocity
        numbers.success[index] = False
        numbers.rewards[:, index] = 0.0
        numbers.costs[:, index] = 0.0
        numbers.started[index] = True
        for _, mask in numbers.drawn.values():
            mask[index] = False
        for name, value in draw.drawn.items():
            values, mask = numbers.drawn.setdefault(name, (np.zeros(self.count), np.zeros(self.count, np.bool_)))
            values[index], mask[index] = value, True

    def _begun(self, model: Model) -> Run:
        run = model.start()
        if self.setup.measured:
            run.sense_every(self.setup.period)
        return run

    def _put(self, index: int, run: Run) -> None:
        if self._batch is None:
            self._bind([run] * self.count)
        else:
            self._batch.replace(index, run)

    def _bind(self, runs: list[Run]) -> None:
        numbers = self._numbers
        self._batch = Batch(runs, self.inputs, numbers.signals, numbers.codes, self.threads)

    def step(self, actions: ArrayLike, active: Bools | None = None) -> None:
        """Holds a row of ``actions`` in each rover for one period, or in those that are ``active``.

        Raises:
            InputError: the actions have the wrong shape or one is NaN or beyond -1..1; nothing has moved then.
            SimulationError: another thread steps these rovers.
        """
        batch, numbers, setup = self.batch, self._numbers, self.setup
        values, moving = self._checked(actions, active), True if active is None else active[:, np.newaxis]
        # In double precision whatever the precision of the actions, without an array in between.
        np.multiply(values, setup.action_scale, out=self.inputs, where=moving, dtype=np.float64)
        np.copyto(self._before, numbers.signals)
        batch.step(setup.steps, active)
        moved = self._all if active is None else active
        numbers.steps += moved
        self._judge(moved)

    def _judge(self, moved: Bools) -> None:
        """Rewards, success, and whether the episodes go on."""
        numbers, setup = self._numbers, self.setup
        ended = numbers.codes != 0
        if moved is not self._all:
            ended &= moved
        step = Step(
            before=self._before,
            after=numbers.signals,
            places=self.places,
            wheels=setup.model.wheels,
            seconds=setup.period,
            weight=numbers.weight,
            target_velocity=numbers.target_velocity,
            radius=numbers.radius,
            slip_limit=setup.slip_limit,
            codes=numbers.codes,
            ended=ended,
            reached=ended,
            success=ended,
        )
        way = Way(self.distance, numbers.steps, numbers.tally)
        step.reached, success = setup.goal.judge(step, way, moved)
        step.success = success
        np.copyto(numbers.success, success, where=moved)
        np.copyto(numbers.states, numbers.codes, where=moved)
        numbers.states[step.reached] = GOAL
        for row, term in zip(numbers.rewards, setup.terms, strict=True):
            np.multiply(term.value(step), term.weight, out=row)
        for row, cost in zip(numbers.costs, setup.costs, strict=True):
            np.copyto(row, cost.exceeded(step, cost.limit))
        if moved is not self._all:
            numbers.rewards[:, ~moved] = 0.0
            numbers.costs[:, ~moved] = 0.0

    def _checked(self, actions: ArrayLike, active: Bools | None) -> NDArray[np.floating[Any]]:
        """The actions as an array of floating-point numbers: the caller's own where it is one."""
        values: NDArray[np.floating[Any]] = as_array(actions)
        if values.dtype.kind not in "biuf":
            raise InputError(f"the action is of type {values.dtype}: expected real numbers")
        if values.dtype.kind != "f":
            values = values.astype(np.float64)
        if values.shape != self.inputs.shape:
            raise InputError(f"the actions have shape {values.shape}, expected {self.inputs.shape}: a row for each rover")
        sizes, moving = np.abs(values), True if active is None else active[:, np.newaxis]
        # Written so that NaN fails too.
        if not sizes.max(initial=0.0, where=moving) <= 1.0:
            i, k = (int(place[0]) for place in np.nonzero(~(sizes <= 1.0) & moving))
            where = f"action[{k}]" if self.count == 1 else f"action[{i}, {k}]"
            raise InputError(f"{where} = {float(values[i, k])}: expected a number within -1 .. 1")
        return values

    # What is seen

    @property
    def batch(self) -> Batch:
        """The runs; there are none before the first reset."""
        if self._batch is None:
            raise SimulationError("there is no episode yet: call reset()")
        return self._batch

    @property
    def started(self) -> Bools:
        """Whether a rover has ever been reset."""
        return self._numbers.started

    @property
    def signals(self) -> Floats:
        """True signals, a row a rover, in the vocabulary's order."""
        return self._numbers.signals

    @property
    def distance(self) -> Floats:
        """Way along x since the start, m."""
        return self._numbers.signals[:, self._x] - self._numbers.start_x

    @property
    def terminated(self) -> Bools:
        """Whether an event or the goal has ended the episode."""
        ended: Bools = self._numbers.states != 0
        return ended

    @property
    def elapsed(self) -> NDArray[np.int64]:
        """Steps since the start."""
        return self._numbers.steps

    @property
    def models(self) -> list[Model]:
        """The models of the present episodes."""
        return self._models

    def status(self, index: int) -> str:
        """"running", the id of the event that ended the episode, "goal" or "failed"."""
        return str(STATUSES[self._numbers.states[index]])

    def rewards(self) -> Floats:
        """Sums of the terms of the last step."""
        first, *others = self._numbers.rewards
        total: Floats = first.copy()
        for row in others:
            total += row
        return total

    def observations(self, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """A row a rover, in ``out`` or in a new array."""
        numbers, observer = self._numbers, self.setup.observer
        seen = np.empty((self.count, len(observer.names)), np.float32) if out is None else out
        self.batch.observe(self._observed, seen)
        goal = self.setup.goal.way()
        left = 1.0 - self.distance / goal if goal > 0.0 else self._zeros
        time = numbers.steps * (self.setup.period / goal) if goal > 0.0 else self._zeros
        time_left = 1.0 - time * numbers.target_velocity
        if (ahead := self.setup.ahead) is not None:
            self.batch.look_ahead(ahead, self._sight)
            observer.add_ahead(seen, self._sight)
        observer.add_extras(seen, target_velocity=numbers.target_velocity, goal_distance=left, time_left=time_left)
        return seen

    def columns(self) -> dict[str, NDArray[Any]]:
        """What ``info`` has but for the values drawn, one entry or row a rover, new arrays."""
        numbers = self._numbers
        return {
            "time": self.batch.times(),
            "x": numbers.signals[:, self._x].copy(),
            "distance": self.distance,
            "status": STATUSES[numbers.states],
            "success": numbers.success.copy(),
            "electrical_energy": numbers.signals[:, self._energy].copy(),
            "slip": numbers.signals[:, self._slip],
            "sinkage": numbers.signals[:, self._sinkage],
            "target_velocity": numbers.target_velocity.copy(),
            **{key: row.copy() for key, row in zip(self._keys, numbers.rewards, strict=True)},
            **self._costs(numbers.costs),
        }

    def _costs(self, costs: Floats) -> dict[str, Floats]:
        """What a step costs, and the sum; nothing where no costs are asked for."""
        if not self._cost_keys:
            return {}
        # Zeros and ones: their sum does not depend on the order.
        return {"cost": costs.sum(axis=0), **{key: row.copy() for key, row in zip(self._cost_keys, costs, strict=True)}}

    def info(self, index: int) -> dict[str, Any]:
        """``info`` of one rover: the same as numbers."""
        numbers = self._numbers
        row = numbers.signals[index]
        x = float(row[self._x])
        info = {
            "time": self.batch.time(index),
            "x": x,
            "distance": x - float(numbers.start_x[index]),
            "status": self.status(index),
            "success": bool(numbers.success[index]),
            "electrical_energy": float(row[self._energy]),
            "slip": row[self._slip],
            "sinkage": row[self._sinkage],
            "target_velocity": float(numbers.target_velocity[index]),
        }
        for key, value in zip(self._keys, numbers.rewards[:, index].tolist(), strict=True):
            info[key] = value
        info |= {key: float(row) for key, row in self._costs(numbers.costs[:, index]).items()}
        info["drawn"] = {name: float(values[index]) for name, (values, mask) in numbers.drawn.items() if mask[index]}
        return info

    def asked(self, index: int) -> dict[str, float]:
        """What a picture shows of the task: the goal's place along x (m), the speed asked for (m/s), the reward of the step."""
        numbers, way = self._numbers, self.setup.goal.way()
        shown = {"reward": float(self.rewards()[index])}
        if way > 0.0:
            shown["goal"] = float(numbers.start_x[index]) + way
        if numbers.target_velocity[index] != 0.0:
            shown["target"] = float(numbers.target_velocity[index])
        return shown

    @property
    def drawn(self) -> Mapping[str, tuple[Floats, Bools]]:
        """Values drawn at the resets by name, and for which rovers."""
        return self._numbers.drawn

    # Copies

    def snapshot(self) -> MechanicsState:
        """Everything that moves; independent of what happens later."""
        runs = [self.batch.run(k) for k in range(self.count)]
        return MechanicsState(runs, list(self._models), copy.deepcopy(self._numbers))

    def restore(self, state: MechanicsState) -> None:
        """Goes on from a snapshot to the same bits."""
        if len(state.runs) != self.count:
            raise InputError(f"the snapshot has {len(state.runs)} rovers, expected {self.count}")
        self._models = list(state.models)
        self._numbers = copy.deepcopy(state.numbers)
        codes = self._numbers.codes.copy()
        self._bind(list(state.runs))
        # A run that failed does not tell.
        self._numbers.codes[:] = codes

    def __deepcopy__(self, memo: dict[int, Any]) -> "Mechanics":
        twin = object.__new__(type(self))
        memo[id(self)] = twin
        for name, value in self.__dict__.items():
            twin.__dict__[name] = None if name == "_batch" else copy.deepcopy(value, memo)
        if self._batch is not None:
            twin.restore(self.snapshot())
        return twin

    def __getstate__(self) -> dict[str, Any]:
        state = self.__dict__ | {"_batch": None}
        if self._batch is not None:
            state["runs"] = [self._batch.run(k).snapshot() for k in range(self.count)]
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        saved: list[bytes] | None = state.pop("runs", None)
        self.__dict__.update(state)
        if saved is None:
            return
        runs = []
        for model, what in zip(self._models, saved, strict=True):
            run = self._begun(model)
            run.restore(what)
            runs.append(run)
        self.restore(MechanicsState(runs, self._models, self._numbers))
