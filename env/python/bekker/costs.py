"""Costs of safety: what a drive should avoid, apart from the reward, for learning under constraints.

A cost is one for a step in which a limit is exceeded, and zero for others, as in Safety-Gymnasium (Ji et al. 2023): its sum over an
episode counts the steps beyond the limit, whatever the units are. ``info["cost"]`` is the sum of those that are asked for. A cost of one's
own is one too::

    def fast(step: Step, limit: float) -> Bools:
        return abs(step.signal("velocity")) > limit

    env = gymnasium.make("bekker/DitchCrossing-v0", costs=["slip", bekker.costs.Cost("fast", 0.3, "m/s", "the rover is fast", fast)])
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from math import radians
from typing import Any, TypeAlias

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ._bekker import Batch
from .checked import finite
from .errors import InputError
from .rewards import Step
from .vocabulary import unknown

__all__ = ["COSTS", "Cost", "CostInStep", "Costs", "costs"]

Bools: TypeAlias = NDArray[np.bool_]

MOVING = 0.02
"""Speed of a rim from which its slip counts, m/s: a wheel that hardly turns has any slip and digs nothing."""

BELLY = Batch.statuses.index("belly_contact")


@dataclass(frozen=True)
class Cost:
    """A cost: one for a step beyond a limit."""

    name: str
    limit: float
    """Beyond it a step costs one."""
    unit: str
    doc: str
    """What costs, in a few words."""
    exceeded: Callable[[Step, float], Bools]
    """Whether a step is beyond the limit, one entry a rover. The entry of one rover must not depend on the others."""


def slip(step: Step, limit: float) -> Bools:
    beyond = np.zeros(len(step.after), np.bool_)
    for k in range(1, step.wheels + 1):
        moving = np.abs(step.wheel(k, "speed")) * step.radius > MOVING
        beyond |= moving & (np.abs(step.wheel(k, "slip")) > limit)
    return beyond


def sinkage(step: Step, limit: float) -> Bools:
    beyond = np.zeros(len(step.after), np.bool_)
    for k in range(1, step.wheels + 1):
        beyond |= step.wheel(k, "sinkage") > limit * step.radius
    return beyond


def tilt(step: Step, limit: float) -> Bools:
    return np.abs(step.signal("pitch")) > limit


def belly(step: Step, limit: float) -> Bools:
    touching: Bools = step.codes == BELLY
    return touching


COSTS: dict[str, Cost] = {
    cost.name: cost
    for cost in (
        Cost("slip", 0.3, "1", "a wheel that turns (0.02 m/s at its rim) slips or skids by more than the limit; by default the slip limit of the task", slip),
        Cost("sinkage", 0.5, "1", "a wheel has sunk by more than this share of its radius", sinkage),
        Cost("tilt", radians(15.0), "rad", "the chassis is pitched by more than the limit, up or down", tilt),
        Cost("belly", 0.0, "1", "the belly has touched the ground, which ends the episode; its limit has no meaning", belly),
    )
}
"""Costs by name, with their usual limits."""

Costs: TypeAlias = bool | Mapping[str, float] | Iterable[str | Cost]


def costs(given: Costs, slip_limit: float) -> tuple[Cost, ...]:
    """The costs that are asked for: all, limits by name, or names and objects."""
    usual = COSTS | {"slip": replace(COSTS["slip"], limit=slip_limit)}
    if isinstance(given, bool):
        return tuple(usual.values()) if given else ()
    if isinstance(given, str):
        raise InputError(f"costs = {given!r}: expected a list of costs, limits by name, or True for all")
    found: dict[str, Cost] = {}
    for one in given:
        if not isinstance(one, Cost):
            if one not in usual:
                raise unknown("cost", one, usual)
            one = usual[one]
        found[one.name] = one
    if isinstance(given, Mapping):
        for name, limit in given.items():
            found[name] = replace(found[name], limit=finite(f"limit of the cost `{name}`", limit))
    return tuple(found.values())


class CostInStep(gymnasium.Wrapper[Any, Any, Any, Any]):
    """The interface of Safety-Gymnasium: ``step`` returns the cost behind the reward. A vector environment has an array in ``info["cost"]``.

    ``observation, reward, cost, terminated, truncated, info = CostInStep(env).step(action)``

    Args:
        env: an environment that was made with ``costs``.

    Raises:
        InputError: it was made without.
    """

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        setup = getattr(env.unwrapped, "setup", None)
        if not getattr(setup, "costs", ()):
            raise InputError("CostInStep: the environment has no costs; make it with costs=True, or with some by name")
        super().__init__(env)

    def step(self, action: Any) -> Any:
        """Holds ``action`` for one period; the cost is a number."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        return observation, reward, info["cost"], terminated, truncated, info
