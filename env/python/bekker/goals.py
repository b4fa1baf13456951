"""What a task counts as success, judged after every step for many rovers at once."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .rewards import Step

__all__ = ["Goal", "Hold", "Open", "Reach", "ReachGently", "ReachOnSchedule", "ReachWithinSlip", "ReachWithinSpeed", "Way"]

Bools: TypeAlias = NDArray[np.bool_]
Floats: TypeAlias = NDArray[np.float64]


@dataclass
class Way:
    """How far the rovers have come in their episodes, one entry a rover."""

    distance: Floats
    """Along x from the start, m."""
    steps: NDArray[np.int64]
    """Steps made, this one among them."""
    tally: Floats
    """A sum that the goal keeps for itself; 0 at the start."""


def schedules_gone(step: Step, way: Way, distance: float) -> Floats:
    """Time of the episodes over that which ``distance`` takes at the speed asked for. A speed of 0, which no arrival keeps, gives 0."""
    gone: Floats = way.steps * (step.seconds * step.target_velocity / distance)
    return gone


class Goal(ABC):
    """What success is."""

    def way(self) -> float:
        """Distance along x that it asks for, m; 0 for none."""
        return 0.0

    @abstractmethod
    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        """Whether the goal is reached, which ends the episode, and whether this is a success, for the rovers that
        ``moved``; keeps ``way.tally``."""


@dataclass(frozen=True)
class Open(Goal):
    """No goal: the drive goes on, and nothing is a success."""

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        never = np.zeros(len(way.distance), np.bool_)
        return never, never


@dataclass(frozen=True)
class Reach(Goal):
    """Success is to come so far; this ends the episode."""

    distance: float

    def way(self) -> float:
        return self.distance

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        reached = moved & ~step.ended & (way.distance >= self.distance)
        return reached, reached


@dataclass(frozen=True)
class ReachWithinSlip(Goal):
    """Coming so far ends the episode; success is to have done so with some wheel beyond the slip limit for at most a share of
    the steps."""

    distance: float
    share: float

    def way(self) -> float:
        return self.distance

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        beyond = np.zeros(len(way.distance), np.bool_)
        for k in range(1, step.wheels + 1):
            beyond |= np.abs(step.wheel(k, "slip")) > step.slip_limit
        way.tally += moved & beyond
        reached = moved & ~step.ended & (way.distance >= self.distance)
        return reached, reached & (way.tally <= self.share * way.steps)


@dataclass(frozen=True)
class ReachWithinSpeed(Goal):
    """Coming so far ends the episode; success is to have done so faster than a limit for at most a share of the steps."""

    distance: float
    speed: float
    """m/s."""
    share: float

    def way(self) -> float:
        return self.distance

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        way.tally += moved & (np.abs(step.signal("velocity")) > self.speed)
        reached = moved & ~step.ended & (way.distance >= self.distance)
        return reached, reached & (way.tally <= self.share * way.steps)


@dataclass(frozen=True)
class ReachGently(Goal):
    """Coming so far ends the episode; success is to have done so on schedule with a chassis that seldom pitched fast.

    The schedule is the time that the way takes at the speed asked for, ``target_velocity``: T = distance/target. Success asks for an
    arrival within ``late`` T, and for a pitch rate above the limit for at most some time.
    """

    distance: float
    late: float
    pitch_rate: float
    """The limit, rad/s."""
    seconds: float
    """How long the pitch rate may be above it altogether, s."""

    def way(self) -> float:
        return self.distance

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        way.tally += moved & (np.abs(step.signal("pitch_rate")) > self.pitch_rate)
        reached = moved & ~step.ended & (way.distance >= self.distance)
        gone = schedules_gone(step, way, self.distance)
        # Half a step is added so that a count of just so many steps is within the limit however it is rounded.
        gentle = way.tally * step.seconds <= self.seconds + 0.5 * step.seconds
        return reached, reached & (gone <= self.late) & (gone > 0.0) & gentle


@dataclass(frozen=True)
class ReachOnSchedule(Goal):
    """Coming so far ends the episode; success is to have done so on schedule and with the energy that the schedule allows.

    The schedule is the time that the way takes at the speed asked for, ``target_velocity``: T = distance/target. Success
    asks for an arrival between ``early`` T and ``late`` T, with an electrical energy of at most
    m g distance (``energy`` + ``energy_per_speed`` target).
    """

    distance: float
    late: float
    early: float = 0.0
    energy: float = np.inf
    """Energy over m g distance that every schedule allows."""
    energy_per_speed: float = 0.0
    """What is allowed besides, for each m/s of the speed asked for, s/m."""

    def way(self) -> float:
        return self.distance

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        reached = moved & ~step.ended & (way.distance >= self.distance)
        gone = schedules_gone(step, way, self.distance)
        allowed = self.energy + self.energy_per_speed * step.target_velocity
        thrifty = step.signal("electrical_energy") <= allowed * step.weight * self.distance
        return reached, reached & (gone >= self.early) & (gone <= self.late) & (gone > 0.0) & thrifty


@dataclass(frozen=True)
class Hold(Goal):
    """Success, at any time after the first seconds: a mean distance between speed and target, since then, of at most a share
    of the target. The episode goes on to its time."""

    share: float
    after: float
    """Seconds that do not count."""

    def judge(self, step: Step, way: Way, moved: Bools) -> tuple[Bools, Bools]:
        late = round(self.after / step.seconds)
        counts = moved & (way.steps > late)
        error = np.abs(step.signal("velocity") - step.target_velocity)
        way.tally += np.where(counts, error, 0.0)
        success = counts & ~step.ended & (way.tally <= self.share * step.target_velocity * (way.steps - late))
        return np.zeros(len(success), np.bool_), success
