"""Terms of rewards: small named objects that see what one step has changed.

A term of one's own is one too::

    def level(step: Step) -> Floats:
        return -abs(step.signal("pitch"))

    env = gymnasium.make("bekker/Rover-v0", rewards=["progress", bekker.rewards.Term("level", 0.1, "keeps level", level)])
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .checked import finite
from .errors import InputError
from .vocabulary import unknown

__all__ = ["TERMS", "Step", "Term", "Terms", "terms"]

Floats: TypeAlias = NDArray[np.float64]

PITCH_RATE = 0.15
"""Pitch rate beyond which a chassis pitches fast, rad/s."""


@dataclass
class Step:
    """One step of many rovers: arrays have one entry (or row) a rover."""

    before: Floats
    """Signals at its start, in the vocabulary's order."""
    after: Floats
    """Signals at its end."""
    places: Mapping[str, int]
    """Place of each signal in a row."""
    wheels: int
    seconds: float
    """Length of the step, s."""
    weight: Floats
    """m g, N."""
    target_velocity: Floats
    """Speed that the task asks for, m/s; 0 where it asks for none."""
    radius: Floats
    """Radius of the wheels, m."""
    slip_limit: float
    """Slip that the task allows."""
    codes: NDArray[np.uint8]
    """What has ended the drive, as an index into `bekker.Batch.statuses`; 0 while it goes on."""
    ended: NDArray[np.bool_]
    """Whether an event ended the drive in this step."""
    reached: NDArray[np.bool_]
    """Whether the goal was reached in this step."""
    success: NDArray[np.bool_]
    """Whether the episode so far is a success, as the goal judges it."""

    def signal(self, name: str) -> Floats:
        """A signal at the end of the step."""
        return self.after[:, self.places[name]]

    def rise(self, name: str) -> Floats:
        """What a signal has gained over the step."""
        place = self.places[name]
        return self.after[:, place] - self.before[:, place]

    def wheel(self, k: int, name: str) -> Floats:
        """A signal of wheel k, from 1, at the end of the step."""
        return self.after[:, self.places[f"wheel[{k}].{name}"]]


@dataclass(frozen=True)
class Term:
    """A term of a reward."""

    name: str
    weight: float
    doc: str
    """What it is, in a few words."""
    value: Callable[[Step], Floats]
    """The term without its weight, one number a rover. The numbers of one rover must not depend on those of another."""


def progress(step: Step) -> Floats:
    return step.rise("x")


def climb(step: Step) -> Floats:
    return step.rise("z")


def energy(step: Step) -> Floats:
    return -step.rise("electrical_energy") / step.weight


def end(step: Step) -> Floats:
    return -step.ended.astype(np.float64)


def goal(step: Step) -> Floats:
    return (step.reached & step.success).astype(np.float64)


def speed_error(step: Step) -> Floats:
    return -np.abs(step.signal("velocity") - step.target_velocity) * step.seconds


def relative_speed_error(step: Step) -> Floats:
    asked = step.target_velocity
    error = np.abs(step.signal("velocity") - asked)
    relative = np.divide(error, np.abs(asked), out=np.zeros(len(asked)), where=asked != 0.0)
    return -relative * step.seconds


def fast_pitching(step: Step) -> Floats:
    return np.where(np.abs(step.signal("pitch_rate")) > PITCH_RATE, -step.seconds, 0.0)


def slip_excess(step: Step) -> Floats:
    # One wheel after the other: a sum over an axis may add in an order that depends on the batch.
    total = np.zeros(len(step.after))
    for k in range(1, step.wheels + 1):
        total += np.maximum(np.abs(step.wheel(k, "slip")) - step.slip_limit, 0.0)
    return -total * (step.seconds / step.wheels)


TERMS: dict[str, Term] = {
    term.name: term
    for term in (
        Term("progress", 1.0, "metres gained along x", progress),
        Term("climb", 1.0, "metres gained in height", climb),
        Term("energy", 0.2, "minus the electrical energy drawn, divided by the weight m g: metres", energy),
        Term("end", 1.0, "minus one on the step in which an event ends the drive", end),
        Term("goal", 1.0, "one on the step that reaches the goal with success", goal),
        Term("speed_error", 1.0, "minus the absolute difference between speed and target, integrated over time: metres", speed_error),
        Term(
            "relative_speed_error",
            1.0,
            "minus the absolute difference between speed and target over the target, integrated over time: seconds; 0 without a target",
            relative_speed_error,
        ),
        Term("fast_pitching", 1.0, f"minus the time in which the chassis pitches faster than {PITCH_RATE} rad/s: seconds", fast_pitching),
        Term("slip_excess", 1.0, "minus the mean over the wheels of |slip| beyond the limit, integrated over time: seconds", slip_excess),
    )
}
"""Terms by name, with the weights that `bekker/Rover-v0` gives them."""

Terms: TypeAlias = Iterable[str | Term]


def terms(given: Terms, weights: Mapping[str, float]) -> tuple[Term, ...]:
    """The terms of a reward, by name or as they are, with other weights."""
    if isinstance(given, str):
        raise InputError(f"rewards = {given!r}: expected a list of terms")
    found: dict[str, Term] = {}
    for term in given:
        if not isinstance(term, Term):
            if term not in TERMS:
                raise unknown("reward term", term, TERMS)
            term = TERMS[term]
        found[term.name] = term
    for name, weight in weights.items():
        if name not in found:
            raise unknown("reward term", name, found)
        found[name] = replace(found[name], weight=finite(f"weight of the reward term `{name}`", weight))
    if not found:
        raise InputError("rewards: expected one term at least")
    return tuple(found.values())
