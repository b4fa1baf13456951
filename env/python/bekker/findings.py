"""The parts of a :class:`bekker.Diagnosis`."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .comparison import CalibratedParameter, Fit, UnansweredRows
from .from_json import json_key

__all__ = [
    "Candidate",
    "LackOfFit",
    "NoiseModel",
    "Pair",
    "Parameter",
    "Profile",
    "RunData",
    "Share",
    "Step",
    "Suggestion",
    "WholeDrive",
]


@dataclass(frozen=True)
class RunData:
    """A run as it was measured."""

    name: str
    group: str | None
    """Runs of a group repeat the same inputs."""
    inputs: list[str]
    """Columns that are given to the model."""
    measured: list[str]
    """Columns that are compared with it."""
    columns: dict[str, NDArray[np.float64]]
    """One entry a row, SI units; NaN where nothing was measured."""


@dataclass(frozen=True)
class NoiseModel:
    """Noise along a run: a scatter common to the whole run plus an AR(1) process from row to row."""

    deviation: float
    """Standard deviation of one sample, in the signal's unit."""
    run_share: float
    """Share of the variance that a whole run has in common."""
    correlation: float
    """Correlation of neighbouring rows of the rest."""


@dataclass(frozen=True)
class Parameter(CalibratedParameter):
    """A free parameter of a fit, SI units."""

    effect: bool
    """Whether it belongs to an added effect rather than to the calibration."""

    @property
    def left_off(self) -> bool:
        """Whether the fit leaves this law of an added effect at its neutral value, where it starts, on a bound: its other laws suffice."""
        return self.effect and self.at_bound and self.value == self.start


@dataclass(frozen=True)
class Step:
    """One step from the calibrated baseline to the final model."""

    added: str | None
    """The effect added at this step; None for the baseline."""
    rmse: dict[str, float]
    """Root mean square of measured minus modelled by signal, in the signal's unit."""
    heldout_rmse: dict[str, float]
    """The same on conditions or runs that were left out of the fit."""
    parameters: list[Parameter]
    chi_square: float
    """Sum of squared whitened residuals."""
    degrees_of_freedom: int
    left: float
    """Share of the baseline's explainable chi-square that is left, 1 at the baseline."""
    fit: Fit


@dataclass(frozen=True)
class Candidate:
    """One effect, added to the baseline alone (or beside the effects named before it)."""

    effect: str
    probability: float
    """Probability that it is part of the explanation; nan where some effects were not tried."""
    tied: bool
    """Whether it remains possible where the verdict is undetermined."""
    heldout_gain: float | None
    """Gain in log predictive density on left-out data, nats; None where only screened."""
    better: float | None
    """Probability that it predicts left-out data better than the baseline; None where only screened."""
    p_value: float
    """Probability that noise alone gives the best of all candidates as large a gain."""
    gain: float
    """Fall of chi-square after refitting everything; from the sensitivities where only screened."""
    left: float
    """Share of the baseline's explainable chi-square that is left with it."""
    refitted: bool
    """Whether it was refitted, or only screened by its sensitivities."""
    visible_share: float
    """The part of its signature that the calibrated parameters cannot absorb, 0 to 1."""
    parameters: list[Parameter]
    """The effect's parameters after the fit; empty where only screened."""


@dataclass(frozen=True)
class Pair:
    """Two effects added to the baseline at once."""

    effects: tuple[str, str]
    gain: float
    """Fall of chi-square against the baseline."""
    refitted: bool


@dataclass(frozen=True)
class Share:
    """Probabilities of the two answers that are no effect; nan where some effects were not tried."""

    enough: float = field(metadata=json_key("probability_enough"))
    """The baseline is enough."""
    other: float = field(metadata=json_key("probability_other"))
    """Something else than any candidate."""


@dataclass(frozen=True)
class LackOfFit:
    """Whether what the calibrated baseline leaves is more than noise."""

    chi_square: float
    degrees_of_freedom: int
    p_value: float
    """Probability of as large a chi-square by noise alone."""
    p_common: float
    """Probability of as large a part that repeats have in common by noise alone."""
    explainable: float
    """The part of chi-square along the conditions, less what noise puts there."""
    p_structure: float
    """Probability of as large a part along the conditions by noise alone."""


@dataclass(frozen=True)
class WholeDrive:
    """The final model from the start of each run to its end, where a drive was judged window by window."""

    windows: int
    """Number of windows into which the runs were cut."""
    runs: list[str]
    """Runs that begin at rest and have no gap; the others cannot be driven as a whole."""
    rmse: dict[str, float]
    """Error of each signal over the rows that the model reaches."""
    unanswered: list[UnansweredRows]
    """Rows that it does not reach."""


@dataclass(frozen=True)
class Profile:
    """Profile likelihood of a parameter of the final model."""

    name: str
    interval: tuple[float | None, float | None]
    """95 % interval; None where a side is open within the bounds."""
    values: NDArray[np.float64]
    """Where the profile was taken, SI unit, increasing."""
    rise: NDArray[np.float64]
    """Rise of chi-square over the minimum there, all others refitted."""


@dataclass(frozen=True)
class Suggestion:
    """An experiment worth making."""

    text: str
    effects: list[str]
    """Effects that it would tell apart or make visible."""
