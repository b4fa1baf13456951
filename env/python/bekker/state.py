"""What moves while rovers drive: numbers by rover, and snapshots of all of it."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._bekker import Batch, Model, Run

__all__ = ["GOAL", "STATUSES", "MechanicsState", "Numbers"]

Floats: TypeAlias = NDArray[np.float64]
Bools: TypeAlias = NDArray[np.bool_]

GOAL = len(Batch.statuses)
STATUSES = np.array([*Batch.statuses, "goal"], dtype=object)
"""Words for the codes of an episode's state."""


@dataclass
class Numbers:
    """What moves besides the runs themselves, one entry or row a rover."""

    signals: Floats
    codes: NDArray[np.uint8]
    states: NDArray[np.uint8]
    """As ``codes``, and GOAL where the goal was reached."""
    steps: NDArray[np.int64]
    tally: Floats
    start_x: Floats
    weight: Floats
    radius: Floats
    target_velocity: Floats
    success: Bools
    rewards: Floats
    """A row a term, weights included."""
    costs: Floats
    """A row a cost."""
    started: Bools
    drawn: dict[str, tuple[Floats, Bools]]
    """Values drawn, and for which rovers."""

    @classmethod
    def fresh(cls, count: int, signals: int, terms: int, costs: int) -> "Numbers":
        """Of rovers before their first episode, with so many signals, terms of the reward and costs."""

        def zeros() -> Floats:
            return np.zeros(count)

        return cls(
            signals=np.zeros((count, signals)),
            codes=np.zeros(count, np.uint8),
            states=np.zeros(count, np.uint8),
            steps=np.zeros(count, np.int64),
            tally=zeros(),
            start_x=zeros(),
            weight=np.ones(count),
            radius=np.ones(count),
            target_velocity=zeros(),
            success=np.zeros(count, np.bool_),
            rewards=np.zeros((terms, count)),
            costs=np.zeros((costs, count)),
            started=np.zeros(count, np.bool_),
            drawn={},
        )


@dataclass(frozen=True)
class MechanicsState:
    """A snapshot: everything that moves."""

    runs: list[Run]
    models: list[Model]
    numbers: Numbers
