"""The model beside measurements: :func:`compare` and its :class:`Comparison`."""

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from . import _bekker
from ._bekker import Model
from .checked import whole
from .curves import Curves
from .errors import InputError
from .experiment import ExperimentLike, sources, together_of
from .from_json import built
from .models import ModelLike, given, names_of, save_model
from .soil import Soil, SoilLike, passed
from .vocabulary import unknown

__all__ = [
    "CalibratedParameter",
    "Calibration",
    "Comparison",
    "Failure",
    "Fit",
    "Identified",
    "NoiseFloor",
    "SignalFit",
    "UnansweredRows",
    "UncountedRows",
    "calibrate",
    "compare",
]


@dataclass(frozen=True)
class SignalFit:
    """One signal of one run, one entry a row, SI units; NaN where nothing was measured."""

    measured: NDArray[np.float64]
    modelled: NDArray[np.float64]
    """NaN where the model has no answer."""
    residual: NDArray[np.float64]
    """Measured minus modelled; NaN also in rows that are left out."""


@dataclass(frozen=True)
class Fit:
    """The model beside the measurements, for one set of parameters."""

    runs: list[tuple[str, dict[str, SignalFit]]]
    """Name of each run and its signals, in the experiment's order."""
    rmse: dict[str, float]
    """Root mean square of the residual by signal."""

    def signal(self, name: str) -> SignalFit:
        """One signal of all runs that measure it, end to end."""
        parts = [signals[name] for _, signals in self.runs if name in signals]
        if not parts:
            raise unknown("measured signal", name, self.rmse)
        measured, modelled, residual = (
            np.concatenate([getattr(part, column) for part in parts])
            for column in ("measured", "modelled", "residual")
        )
        return SignalFit(measured, modelled, residual)


@dataclass(frozen=True)
class CalibratedParameter:
    """A free parameter after the calibration, SI units."""

    name: str
    unit: str
    min: float
    max: float
    start: float
    value: float
    deviation: float | None
    """Standard error; None on a bound, or where the experiment does not determine it."""
    at_bound: bool
    """The fit wanted to go further than is believable."""
    prior_shift: float | None
    """How far it moved from its prior, in the prior's standard deviations."""


@dataclass(frozen=True)
class Calibration:
    """What a calibration found, and how well it is determined."""

    parameters: list[CalibratedParameter]
    weights: dict[str, float]
    """Standard deviation by which each signal's residuals were divided."""
    chi_square: float
    degrees_of_freedom: int
    steps: int
    converged: bool
    searches: int
    agreeing: int
    """Searches from different starts that ended at the best cost."""


@dataclass(frozen=True)
class Identified:
    """What a calibration determines of one parameter."""

    name: str
    determined: Literal["alone", "together", "not"]
    """By itself: at most a tenth of what was open before is left; together: that would be left if the other parameters were known; not:
    more is left even then."""
    left: float
    """Standard deviation over that of what was open before, by the bounds and what was known."""
    left_alone: float
    """The same if all other parameters were known."""
    trade: str | None
    """Where ``determined`` is "together": this parameter a standard error higher and how those that it trades with then move, a change
    that the measurements hardly see."""


@dataclass(frozen=True)
class NoiseFloor:
    """Standard deviation of one sample: how well any model could do."""

    value: float | None
    source: Literal["stated", "replicates", "unknown"]


@dataclass(frozen=True)
class Failure:
    """The level of a condition at which a signal's mean residual is largest."""

    signal: str
    condition: str
    low: float
    high: float
    mean: float
    """Mean residual where the condition lies within low .. high."""
    samples: int
    spread: float
    """How much the mean residual changes over all levels."""
    noise: float | None


@dataclass(frozen=True)
class UnansweredRows:
    """Neighbouring rows of a run that the model cannot answer: the soil does not carry the load, the rover is stuck."""

    run: str
    first_row: int
    """Counted from 1."""
    last_row: int
    """The last of them, included."""
    reason: str

    def __str__(self) -> str:
        one = self.first_row == self.last_row
        rows = f"row {self.first_row}" if one else f"rows {self.first_row} to {self.last_row}"
        return f"run {self.run}, {rows}: {self.reason}"


@dataclass(frozen=True)
class UncountedRows:
    """Neighbouring rows of a run that no fit counts."""

    run: str
    first_row: int
    """Counted from 1."""
    last_row: int
    """The last of them, included."""
    seconds: tuple[float, float] | None
    """Times of these rows; None where rows have no time."""
    why: str
    """``start`` of a run, ``gap`` (what follows one), ``odd`` stretch, ``no_answer`` of the model, or ``spared``: a
    window that takes no part in the fits, so that it can judge the final model."""
    reason: str
    """The same in words."""

    def __str__(self) -> str:
        rows = f"rows {self.first_row} to {self.last_row}"
        when = rows if self.seconds is None else f"{self.seconds[0]:.1f} to {self.seconds[1]:.1f} s"
        return f"run {self.run}, {when}: {self.reason}"


@dataclass(frozen=True)
class Comparison:
    """A model beside an experiment."""

    experiment: str
    given: Fit | None
    """With the given parameters; None where they have no answer anywhere, see ``given_error``."""
    given_error: str | None
    calibration: Calibration | None
    calibrated: Fit | None
    noise_floor: dict[str, NoiseFloor]
    failures: list[Failure]
    """Where the model fails, the worst first."""
    curves: list[Curves]
    """The model over each input that was varied, as given and after the calibration; empty for a traverse."""
    unanswered: list[UnansweredRows]
    """Rows that ``fit`` leaves without an answer: left out of its errors, of the noise and of the calibration."""
    given_unanswered: list[UnansweredRows]
    """Rows that the given parameters leave without an answer: left out of the errors of ``given``."""
    uncounted: list[UncountedRows]
    """All rows that ``fit`` does not count, and why; those without an answer stand in ``unanswered`` too."""
    cautions: list[str]
    """What the reader of a calibration should beware of."""
    sources: list[str]
    """What was taken from where, where two places disagree; priors of a class of soil; what drives the rover where no command
    was recorded."""
    model: Model
    """The model of ``fit``: with what is known of the rig and, after a calibration, with what that found; compared with the
    same experiment it gives the same errors. A wheel on a carriage (``model.kind``) where a single wheel was measured and no
    rover is named. What the experiment says of single runs is not part of it."""
    part_models: dict[str, Model]
    """Of several experiments the model of each, by its name, of which :attr:`model` is the first; empty for one."""
    soil: Soil | None
    """What a calibration found of the soil, with its covariance, for other experiments; None without one, or where no parameter of
    the soil was free."""
    identified: list[Identified]
    """Which parameters a calibration determines, which only together with others, and which not; those on a bound are left out.
    Empty without one."""

    def save_model(self, path: str | os.PathLike[str]) -> None:
        """Writes the model of ``fit`` as TOML, which ``simulate``, the FMU builder and the environment take.

        Raises:
            OSError: the file cannot be written.
        """
        save_model(self.model, path)

    @property
    def fit(self) -> Fit:
        """The best fit: after the calibration where there was one."""
        best = self.calibrated or self.given
        assert best is not None, "the core gives one of them"
        return best

    def __str__(self) -> str:
        lines = [self.experiment]
        for signal, rmse in self.fit.rmse.items():
            floor = self.noise_floor[signal]
            noise = "unknown" if floor.value is None else f"{floor.value:.3g} ({floor.source})"
            lines.append(f"  {signal}: error {rmse:.3g} rms, noise {noise}")
        for parameter in self.calibration.parameters if self.calibration else []:
            bound = ", on its bound" if parameter.at_bound else ""
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            lines.append(f"  {parameter.name} = {parameter.value:.4g}{unit}{bound}")
        for worst in self.failures[:1]:
            place = f"{worst.condition} {worst.low:.3g} .. {worst.high:.3g}"
            lines.append(f"  fails most in {worst.signal} at {place}: mean residual {worst.mean:.3g}")
        lines += [f"  left out: {rows}" for rows in self.unanswered]
        lines += [f"  caution: {caution}" for caution in self.cautions]
        return "\n".join(lines)


def compare(
    experiment: ExperimentLike | Sequence[ExperimentLike],
    model: ModelLike | None = None,
    *,
    calibrate: bool = False,
    added: Iterable[str] | None = None,
    parameters: Mapping[str, float] | None = None,
    soil_from: SoilLike | None = None,
    soil_scatter: float | None = None,
    share: Iterable[str] | None = None,
    windows: int = 64,
) -> Comparison:
    """Runs a model on the inputs of an experiment and compares it with what was measured.

    With ``calibrate`` the fit is the baseline of :func:`bekker.diagnose`, to the bit. Rows that the model cannot answer, for
    example where the wheel sinks to its axle, are left out and listed in ``unanswered``.

    For each parameter the first that gives a value holds: a run's own ``parameters``; ``parameters`` here; what the model
    states (in its file, or by ``Model.set``; a built-in model states nothing); the experiment's ``parameters``; the mean of a
    prior; the built-in model. Dimensions and masses of the rig are taken from the experiment rather than from the model. Where
    two disagree, ``sources`` says so.

    Args:
        experiment: the folder with ``experiment.toml``, or a :class:`bekker.Experiment`; a wheel on a carriage takes
            wheel, soil and effects of the model, a traverse the whole rover. Or a sequence of these, made on one soil, as in
            :func:`bekker.diagnose`.
        model: a Model, the name of a preset, TOML text, or the path of a TOML file; where None, the one that the experiment
            names, or else a plain wheel, or a rover with as many wheels as the commands name.
        calibrate: whether to calibrate the soil first.
        added: ids of effects (:func:`bekker.effects`) whose parameters a calibration frees too.
        parameters: values by name that go before the model and the experiment's ``parameters``, though not before a run's own;
            a calibration leaves them as they are unless they have a prior.
        soil_from: what another experiment found of the soil (:class:`bekker.Soil`, or the path of its file): a prior of its
            parameters together. It goes before the priors of a class of soil and after the experiment's own priors.
        soil_scatter: of several experiments the relative standard deviation of the soil from one to the next, as in
            :func:`bekker.diagnose`.
        share: of several experiments what they share, as in :func:`bekker.diagnose`.
        windows: different windows of a long drive, at least 8, that a calibration uses, as in :func:`bekker.diagnose`.

    Raises:
        UnknownNameError, ModelError: as :func:`bekker.models.as_model`; a ModelError too where the folder is refused
            (the message gives file, line and column) or does not suit the model.
        InputError: an effect is added without a calibration, which would leave it neutral.
        SimulationError: the model has no answer for any measured row or, in a calibration, for at least half of them and for
            more values than there are free parameters.
    """
    effects = names_of("added", added or ())
    if effects and not calibrate:
        raise InputError(f"added = {effects}: expected calibrate=True; an effect is neutral until it is calibrated")
    arguments = (*given(model, parameters), calibrate, effects, whole("windows", windows, 8), passed(soil_from))
    together = together_of(experiment, soil_scatter, share)
    found, fitted, parts = _bekker.compare(sources(experiment), *arguments, together)
    data = json.loads(found)
    soil = data.pop("soil")
    return built(Comparison, data, model=fitted, part_models=dict(parts), soil=None if soil is None else Soil(soil))


def calibrate(
    experiment: ExperimentLike | Sequence[ExperimentLike],
    model: ModelLike | None = None,
    *,
    added: Iterable[str] | None = None,
    parameters: Mapping[str, float] | None = None,
    soil_from: SoilLike | None = None,
    soil_scatter: float | None = None,
    share: Iterable[str] | None = None,
    windows: int = 64,
) -> Comparison:
    """Finds the soil (and what has a prior, and the parameters of the effects ``added``) that brings a model closest to
    an experiment.

    The result's ``calibration`` says how well each parameter is determined; its ``model`` is the calibrated model, its ``soil`` what
    other experiments may take as ``soil_from``.
    Arguments and errors are those of :func:`compare`.
    """
    return compare(
        experiment,
        model,
        calibrate=True,
        added=added,
        parameters=parameters,
        soil_from=soil_from,
        soil_scatter=soil_scatter,
        share=share,
        windows=windows,
    )
