"""The gymnasium environment ``bekker/Rover-v0``."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from ._bekker import Run
from .errors import InputError
from .models import ModelLike, as_model
from .scales import OBSERVED, Observer, action_scale, indices
from .simulation import whole
from .vocabulary import unknown

__all__ = ["RoverEnv"]

Observation: TypeAlias = NDArray[np.float32]
Action: TypeAlias = NDArray[np.float32]

REWARD_WEIGHTS = {"progress": 1.0, "energy": 0.2, "end": 1.0}
"""Terms of the reward and their default weights."""


class RoverEnv(gymnasium.Env[Observation, Action]):
    """## Description

    A rover drives over deformable soil: every wheel sinks, slips and pulls as the stresses under it say. The goal is
    to get far along x with little energy, without getting stuck or tipping over. The physics is that of
    `bekker.simulate` to the last bit; a step holds the action for `period`.

    ## Action Space

    `Box(-1, 1, (n,), float32)`. What one action means follows from what drives the model's wheels:

    | `model.control` | Num | Action | One means (default) | Unit |
    |---|---|---|---|---|
    | `torque` | wheel, rear to front | torque of the motor, wheel side | m g r/(2 n) | N m |
    | `speed` | wheel, rear to front | wheel speed, followed exactly | sqrt(g/r)/2 | rad/s |
    | `speed_loop` | wheel, rear to front | wheel speed for the loop of each drive | sqrt(g/r)/2 | rad/s |
    | `velocity`, `rtc` | 0 | velocity for the controller inside | sqrt(g r)/2 | m/s |

    with mass m, gravity g, wheel radius r and n wheels; `action_scale` gives the number, the argument changes it.

    ## Observation Space

    `Box(-1, 1, (3 + 3 n,), float32)` by default: true signals, each divided by its scale and clipped. `observer.names`
    and `observer.scales` list them; L is the distance between the outer wheels.

    | Num | Observation | Min | Max | One means | Unit |
    |---|---|---|---|---|---|
    | 0 | `pitch`, nose up | -1 | 1 | pi/2 | rad |
    | 1 | `pitch_rate` | -1 | 1 | sqrt(g/L) | rad/s |
    | 2 | `velocity` along the path | -1 | 1 | sqrt(g r) | m/s |
    | 3 .. 2+n | `wheel[k].speed`, rear to front | -1 | 1 | sqrt(g/r) | rad/s |
    | 3+n .. 2+2n | `wheel[k].torque`, wheel side | -1 | 1 | m g r/n | N m |
    | 3+2n .. 2+3n | `wheel[k].contact_angle`, uphill | -1 | 1 | pi/2 | rad |

    `observe` chooses others; `bekker.scales` has the whole table. Scales are those of the model as it was given:
    values drawn or set at a reset do not change them.

    ## Reward

    The sum of three terms, which `info` lists as `reward_<term>`, weights included:

    - `progress`: metres gained along x (weight 1).
    - `energy`: minus the electrical energy drawn, over the rover's weight m g, so in metres too (weight 0.2). It is
      positive where the drives feed energy back.
    - `end`: minus one on the step that terminates (weight 1).

    ## Starting State

    At rest, settled on the soil, the reference point above x = `x0`. The same at every reset, unless `vary` draws
    parameters: each uniformly between its two values, from the environment's seeded generator.
    `reset(options={"parameters": {...}, "x0": ...})` sets parameters by name for that episode, after the drawing.
    `reset(seed=s)` also seeds the noise of the sensors inside the model with s
    (its last 32 bits); a reset without a seed draws one.

    ## Episode End

    Terminated when the run ends by an event, named in `info["status"]`: `stuck`, `tipped_over`, `belly_contact`,
    `left_terrain`, `sunk_to_axle`. Never truncated by itself: `gymnasium.make` adds a time limit of 1000 steps, 20 s.

    `info` has the same keys after every reset and step: `time` (s), `x` (m), `status`, `electrical_energy` (J), `slip`
    and `sinkage` (m; one entry a wheel), `reward_progress`, `reward_energy`, `reward_end`, and `drawn`, the values
    that `vary` drew.

    ## Arguments

    - `model`: a `bekker.Model`, the name of a preset, TOML text, or the path of a TOML file; default `two_wheeled`.
    - `period`: control period, s, a whole number of the model's inner steps; default 0.02.
    - `parameters`: values by name that replace the model's.
    - `vary`: pairs (low, high) by name, drawn at every reset; default none.
    - `observe`: signals of the observation; a name such as `wheel.slip` stands for that signal of every wheel.
    - `observation_scales`: SI values of one, by the same names.
    - `action_scale`: what an action of one commands, N m, rad/s or m/s.
    - `reward_weights`: weights of the terms, by name; those left out keep their defaults.

    A wrong argument is a `bekker.errors.UnknownNameError`, `ModelError` or `InputError` that names it.

    ## Version History

    - v0: first version.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        model: ModelLike = "two_wheeled",
        *,
        period: float = 0.02,
        parameters: Mapping[str, float] | None = None,
        vary: Mapping[str, Sequence[float]] | None = None,
        observe: Sequence[str] = OBSERVED,
        observation_scales: Mapping[str, float] | None = None,
        action_scale: float | None = None,
        reward_weights: Mapping[str, float] | None = None,
    ) -> None:
        self._model = as_model(model, parameters)
        self._steps = whole("period", period, "inner steps", self._model.step_size)
        self._vary = self._checked_ranges(vary or {})
        self.observer = Observer(self._model, observe, observation_scales or {})
        self.action_scale = self._checked_scale(action_scale)
        self._weights = _checked_weights(reward_weights or {})
        self._prepare_buffers()
        self.observation_space = spaces.Box(-1.0, 1.0, (len(self.observer.names),), np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, self._inputs.shape, np.float32)
        self.render_mode = None

    def _prepare_buffers(self) -> None:
        model = self._model
        self._run: Run | None = None
        self._inputs = np.zeros(len(model.inputs()))
        self._signals = np.zeros(len(model.signals()))
        wheels = range(1, model.wheels + 1)
        self._slip = indices(model, [f"wheel[{k}].slip" for k in wheels])
        self._sinkage = indices(model, [f"wheel[{k}].sinkage" for k in wheels])
        self._x, self._energy = (int(k) for k in indices(model, ["x", "electrical_energy"]))
        self._drawn: dict[str, float] = {}
        self._weight = 0.0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts an episode; see the class for seeds and options."""
        super().reset(seed=seed)
        model = self._model.copy()
        # Always as many draws, so that options do not shift the sequence.
        self._drawn = {name: float(self.np_random.uniform(low, high)) for name, (low, high) in self._vary.items()}
        model.seed = int(self.np_random.integers(2**32)) if seed is None else seed % 2**32
        for name, value in (self._drawn | _checked_options(options or {})).items():
            model.set(name, value)
        self._weight = model.total_mass * model.get("gravity")
        self._run = model.start()
        self._run.read(self._signals)
        terms = dict.fromkeys(REWARD_WEIGHTS, 0.0)
        return self.observer(self._signals), self._info(self._run, terms)

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Holds ``action`` for one period.

        Raises:
            InputError: the action has the wrong length, is NaN or beyond -1..1; nothing has moved then.
            gymnasium.error.ResetNeeded: there is no episode, or it has terminated.
        """
        run = self._running()
        np.multiply(self._checked_action(action), self.action_scale, out=self._inputs)
        x, energy = self._signals[self._x], self._signals[self._energy]
        terminated = run.step(self._inputs, self._steps, self._signals) != "running"
        terms = {
            "progress": self._weights["progress"] * float(self._signals[self._x] - x),
            "energy": -self._weights["energy"] * float(self._signals[self._energy] - energy) / self._weight,
            "end": -self._weights["end"] * terminated,
        }
        return self.observer(self._signals), sum(terms.values()), terminated, False, self._info(run, terms)

    def _running(self) -> Run:
        if self._run is None:
            raise gymnasium.error.ResetNeeded("there is no episode yet: call reset()")
        if self._run.status != "running":
            raise gymnasium.error.ResetNeeded(f"the episode has ended, {self._run.event}: call reset()")
        return self._run

    def _info(self, run: Run, terms: Mapping[str, float]) -> dict[str, Any]:
        return {
            "time": run.time,
            "x": float(self._signals[self._x]),
            "status": run.status,
            "electrical_energy": float(self._signals[self._energy]),
            "slip": self._signals[self._slip],
            "sinkage": self._signals[self._sinkage],
            **{f"reward_{name}": value for name, value in terms.items()},
            "drawn": dict(self._drawn),
        }

    def _checked_action(self, action: ArrayLike) -> NDArray[np.float64]:
        values = np.asarray(action, dtype=np.float64)
        if values.shape != self._inputs.shape:
            raise InputError(f"the action has shape {values.shape}, expected {self._inputs.shape}")
        # Written so that NaN fails too.
        if not np.abs(values).max() <= 1.0:
            k = int(np.flatnonzero(~(np.abs(values) <= 1.0))[0])
            raise InputError(f"action[{k}] = {values[k]}: expected a number within -1 .. 1")
        return values

    def _checked_scale(self, scale: float | None) -> float:
        if scale is None:
            return action_scale(self._model)
        if not (np.isfinite(scale) and scale > 0.0):
            raise InputError(f"action_scale = {scale}: expected a finite number above 0")
        return float(scale)

    def _checked_ranges(self, vary: Mapping[str, Sequence[float]]) -> dict[str, tuple[float, float]]:
        """The ranges, both ends of each tried on a copy of the model."""
        trial, ranges = self._model.copy(), {}
        for name, pair in vary.items():
            if len(pair) != 2 or not pair[0] <= pair[1]:
                raise InputError(f"vary `{name}` = {pair}: expected a pair (low, high)")
            for value in pair:
                trial.set(name, value)
            ranges[name] = (float(pair[0]), float(pair[1]))
        return ranges


def _checked_weights(weights: Mapping[str, float]) -> dict[str, float]:
    for name, weight in weights.items():
        if name not in REWARD_WEIGHTS:
            raise unknown("reward term", name, REWARD_WEIGHTS)
        if not np.isfinite(weight):
            raise InputError(f"weight of the reward term `{name}` = {weight}: expected a finite number")
    return REWARD_WEIGHTS | dict(weights)


def _checked_options(options: Mapping[str, Any]) -> dict[str, float]:
    """Parameters by name from the options of a reset."""
    known = ("parameters", "x0")
    for name in options:
        if name not in known:
            raise unknown("option", name, known)
    place = {"x0": options["x0"]} if "x0" in options else {}
    return dict(options.get("parameters", {})) | place
