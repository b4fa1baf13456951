"""The model as curves beside the points of a wheel on a carriage, as :attr:`bekker.Diagnosis.curves` has them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Curve", "CurveGroup", "Curves", "ModelCurves"]


@dataclass(frozen=True, eq=False)
class Curve:
    """One signal of a model over the grid of its group, SI units; NaN where the model has no answer."""

    value: NDArray[np.float64]
    """At the typical inputs of the group."""
    low: NDArray[np.float64]
    """Lowest value over the range of the group's inputs."""
    high: NDArray[np.float64]
    """Highest value."""


@dataclass(frozen=True, eq=False)
class ModelCurves:
    """The curves of one model."""

    step: int | None
    """The step of the diagnosis, 0 the calibrated baseline; None for the model as given. A comparison has at most step 0."""
    signals: dict[str, Curve]


@dataclass(frozen=True, eq=False)
class CurveGroup:
    """Rows that belong together, and the model at their typical inputs.

    Rows belong together where their rigs have the same parameters and their inputs the same set-points. Values are
    set-points where they stand in at most ten classes that lie apart by more than 5 % of the largest value (of slip by
    more than 0.02) and by more than twice the width of the widest class; other differences count as accidental. Typical
    inputs are the group's means, or their own smooth course where an input follows the axis.
    """

    name: str
    """What tells the group from the others; empty where it is the only one."""
    rows: list[tuple[int, int]]
    """Run and row of each point, counted from 0."""
    loads: tuple[float, float]
    """Lowest and highest load of the rows, N."""
    slips: tuple[float, float]
    wheel_speeds: tuple[float, float]
    """Lowest and highest wheel speed, rad/s."""
    at: NDArray[np.float64]
    """Values of the axis, rising; empty where the rows lie at one place of it."""
    inputs: NDArray[np.float64]
    """The typical inputs there, one row a value of the axis: load (N), slip, wheel speed (rad/s)."""
    models: list[ModelCurves]

    def __post_init__(self) -> None:
        # Three columns also where there is no row.
        object.__setattr__(self, "inputs", self.inputs.reshape(-1, 3))

    def curve(self, step: int | None, signal: str) -> Curve | None:
        """The curve of a signal at a step; None where the group has none."""
        for model in self.models:
            if model.step == step and self.at.size:
                return model.signals.get(signal)
        return None


@dataclass(frozen=True, eq=False)
class Curves:
    """The model over one input that was varied."""

    axis: Literal["slip", "load", "wheel_speed"]
    groups: list[CurveGroup]
