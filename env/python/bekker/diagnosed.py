"""What a diagnosis finds: :class:`Diagnosis`, with its plots and its files."""

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _bekker
from ._bekker import Model
from .comparison import Failure, Fit, NoiseFloor, UnansweredRows, UncountedRows
from .curves import Curves
from .errors import BekkerError, InputError
from .findings import (
    Candidate,
    LackOfFit,
    NoiseModel,
    Pair,
    Profile,
    RunData,
    Share,
    Step,
    Suggestion,
    WholeDrive,
)
from .from_json import built, json_key, merged
from .models import save_model
from .vocabulary import unknown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Diagnosis"]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What a diagnosis found. SI units throughout."""

    experiment: str
    kind: Literal["single_wheel", "traverse", "plate_sinkage", "shear"]
    """What was done; where several experiments were diagnosed together, in the first of them."""
    runs: list[RunData]
    verdict: Literal["explained", "effect_missing", "unexplained", "undetermined"]
    """``explained``: the calibrated model leaves only noise. ``effect_missing``: the listed effects account for the
    structure. ``unexplained``: no candidate accounts for it, the listed effects are none or partial.
    ``undetermined``: candidates tie, or the experiment cannot see the difference."""
    effects: list[str]
    """The effects that the verdict names, in part where ``unexplained``; none where ``undetermined``, see :attr:`tied`."""
    where: dict[str, list[str]]
    """Where several experiments were diagnosed together: for each effect that the verdict is about, the experiments in which it
    acts. Candidates that act in some only are called ``slip_sinkage in wheel_2``. Empty for one experiment."""
    possible_beside: list[str]
    """Effects one of which may act beside those that are named, the best first: what the named ones leave is more than noise, and
    one of these, or another form of a named effect's law, accounts for it. Empty unless effects are named with confidence, and where
    there was no time to look. Of several experiments, an effect that acts in some only is called ``slip_sinkage in wheel_2``."""
    noise_floor: dict[str, NoiseFloor]
    """Standard deviation of one sample by signal."""
    noise_floor_source: Literal["stated", "replicates", "unknown"]
    noise: dict[str, NoiseModel] = field(metadata=json_key("noise_models"))
    """The noise models used for whitening, by signal."""
    given: Fit | None
    """The model before calibration; None where it cannot compute the experiment."""
    steps: list[Step]
    """The calibrated baseline, then one step an effect."""
    curves: list[Curves]
    """The model of each step over each input that was varied; empty for a traverse."""
    candidates: list[Candidate]
    """Single effects, the most probable first."""
    pairs: list[Pair]
    """Pairs of effects, the best first."""
    invisible: list[str]
    """Candidates without any signature in this experiment."""
    share: Share = field(metadata=json_key(None))
    lack_of_fit: LackOfFit
    smallest_p: float
    """Smallest p-value that the bootstrap can give."""
    explained_share: float
    """Share of the explainable chi-square that the final model accounts for."""
    confused_with: list[tuple[str, str]]
    """Pairs of effects that this experiment hardly tells apart."""
    profiles: list[Profile]
    """Profile likelihoods of the final model's parameters; empty if interrupted before."""
    failures: list[Failure]
    """Where the calibrated baseline fails, the worst first."""
    failures_left: list[Failure]
    """The same of the final model."""
    suggestions: list[Suggestion]
    """What to measure next, the most decisive first: at most three, and only what this rig can do."""
    next_experiment: str
    """The first of them in one line; empty where there is none."""
    improved_is: str
    """Which model :attr:`improved` is, in words."""
    unanswered: list[UnansweredRows]
    """Rows that are left out of everything, since the calibrated baseline has no answer there."""
    uncounted: list[UncountedRows]
    """All rows that no fit counts, and why: starts of runs, what follows a gap, odd stretches, rows without an answer."""
    whole_drive: WholeDrive | None
    """The final model over the whole of each run, where runs were cut into windows; None where they were not."""
    cautions: list[str]
    """What the reader should beware of."""
    interrupted: bool
    """Whether the work was cut short; what was not done is missing from the lists."""
    not_tried: list[str]
    """What was not tried, because the work was cut short or ``time_budget`` had no time for it: one line a kind of work."""
    improved: Model
    """The final model, calibrated and with its effects on: for compare, export_fmu and, where it is a rover, simulate and
    RoverEnv. Compared with the same experiment it gives the same errors. A wheel on a carriage (``improved.kind``), for
    :func:`bekker.steady_points`, where a single wheel was measured and no rover is named: ``rover.with_rig_of(improved)`` puts
    it on one. What the experiment says of single runs is not part of it."""
    improved_parts: dict[str, Model]
    """Of several experiments the improved model of each, by its name, of which :attr:`improved` is the first; empty for one."""
    sources: list[str]
    """What was taken from where, where two places disagree; priors of a class of soil; what drives the rover where no command
    was recorded."""
    _json: str = field(repr=False)
    _native: "_bekker.NativeDiagnosis | None" = field(repr=False)

    def to_json(self, indent: int | None = None) -> str:
        """The JSON that ``bekker diagnose --json`` writes: a stable interface."""
        return self._json if indent is None else json.dumps(json.loads(self._json), indent=indent)

    def save_html(self, path: str | os.PathLike[str]) -> None:
        """Writes the report: one self-contained HTML page with plots to zoom into. Of several experiments a page of each, whose name
        stands behind that of the file: ``report-wheel.html``.

        Raises:
            BekkerError: this diagnosis was pickled, which leaves out what only the report needs.
            OSError: a file cannot be written.
        """
        if self._native is None:
            raise BekkerError("a diagnosis that was pickled has no report; call save_html where diagnose was called")
        path = Path(path)
        if not self.improved_parts:
            path.write_text(self._native.html(), encoding="utf-8")
        for part, name in enumerate(self.improved_parts):
            path.with_name(f"{path.stem}-{name}{path.suffix}").write_text(self._native.html(part), encoding="utf-8")

    def save_model(self, path: str | os.PathLike[str]) -> None:
        """Writes the improved model as TOML, which ``simulate``, the FMU builder and the environment take.

        Raises:
            OSError: the file cannot be written.
        """
        save_model(self.improved, path)

    def candidate(self, effect: str) -> Candidate:
        """The candidate called ``effect``.

        Raises:
            UnknownNameError: it was none.
        """
        for candidate in self.candidates:
            if candidate.effect == effect:
                return candidate
        raise unknown("candidate", effect, [candidate.effect for candidate in self.candidates])

    def plot_overlay(self, signals: Iterable[str] | None = None, axis: str | None = None) -> "Figure":
        """Measured values with two standard deviations of their noise, the calibrated baseline and the final model.

        A wheel on a carriage over one of its inputs, a colour a group of rows (a run where there is one group), the
        model as the curves and bands of :attr:`curves`; a traverse over time, one column a set of repeats. This and
        all plots need matplotlib (``pip install bekker[plot]``) and return its Figure.

        Args:
            signals: names in the order of the rows; where None, those whose error stands out most from the noise.
            axis: "slip", "load" or "wheel_speed", of those that were varied; the first of them where None. Not for a
                traverse.

        Raises:
            UnknownNameError: a signal was not measured, or ``axis`` was not varied.
            ImportError: matplotlib is missing.
        """
        from .plots import overlay

        return overlay(self, signals, axis)

    def plot_residuals(self, signals: Iterable[str] | None = None) -> "Figure":
        """Residuals (measured minus modelled) of baseline and final model against each condition, with a band of
        two standard deviations of the noise and what they are on average: means with two standard errors at set-points,
        a smooth where a condition takes values all along. Arguments and errors as :meth:`plot_overlay`."""
        from .plots import residuals

        return residuals(self, signals)

    def plot_steps(self, signals: Iterable[str] | None = None) -> "Figure":
        """The error falling step by step, fitted and on left-out data, beside the noise floor. Arguments and errors as
        :meth:`plot_overlay`."""
        from .plots import steps

        return steps(self, signals)

    def plot_candidates(self, most: int = 12) -> "Figure":
        """Probabilities of the ``most`` best candidates, of "enough already" and of "something else". Errors as
        :meth:`plot_overlay`."""
        from .plots import candidates

        return candidates(self, most)

    def plot_profiles(self) -> "Figure":
        """Profile likelihoods of the final parameters with their 95 % intervals. Errors as :meth:`plot_overlay`.

        Raises:
            InputError: there are none: the diagnosis was interrupted, or no effect was added to a traverse.
        """
        from .plots import profiles

        return profiles(self)

    def plot_heatmap(self, signal: str | None = None, x: str | None = None, y: str | None = None) -> "Figure":
        """Mean residual over two conditions, before and after the effects, in standard deviations of the noise.

        Args:
            signal: where None, the one whose error stands out most from the noise.
            x, y: columns of the runs, or ``"run"``; slip and load of a single wheel, time and run of a traverse.

        Raises:
            UnknownNameError: the signal or a column was not measured.
            ImportError: matplotlib is missing.
        """
        from .plots import heatmap

        return heatmap(self, signal, x, y)

    def __getstate__(self) -> dict[str, Any]:
        # The native part stays where it is: all numbers are here, only the report needs it.
        return {name: value for name, value in self.__dict__.items() if name != "_native"} | {"_native": None}

    @property
    def tied(self) -> list[str]:
        """Effects that remain possible where the verdict is ``undetermined``, the most probable first."""
        return [candidate.effect for candidate in self.candidates if candidate.tied]

    def __str__(self) -> str:
        about = _list(": ", self.effects) or _list(", tied: ", self.tied)
        lines = [f"{self.experiment}: {self.verdict.replace('_', ' ')}" + about]
        for step in self.steps:
            errors = ", ".join(f"{signal} {rmse:.3g}" for signal, rmse in step.rmse.items())
            lines.append(f"  {f'+ {step.added}' if step.added else 'calibrated'}: error {errors} rms, {step.left:.0%} left")
        floors = {signal: floor.value for signal, floor in self.noise_floor.items() if floor.value is not None}
        floor = ", ".join(f"{signal} {value:.3g}" for signal, value in floors.items())
        lines.append(f"  noise floor ({self.noise_floor_source}): {floor or 'unknown'}")
        likely = [c for c in self.candidates if c.probability >= 0.01]
        shares = [(c.effect + (" (tied)" if c.tied else ""), c.probability) for c in likely]
        shares += [("enough already", self.share.enough), ("something else", self.share.other)]
        lines.append("  probability: " + ", ".join(f"{name} {p:.2f}" for name, p in shares if p >= 0.01))
        if self.whole_drive:
            errors = ", ".join(f"{signal} {rmse:.3g}" for signal, rmse in self.whole_drive.rmse.items())
            lines.append(f"  {self.whole_drive.windows} windows; as a whole: error {errors} rms")
        lines += [f"  caution: {caution}" for caution in self.cautions]
        if self.next_experiment:
            lines.append(f"  next: {self.next_experiment}")
        if self.not_tried:
            lines.append("  not tried: " + "; ".join(self.not_tried))
        if self.interrupted:
            lines.append("  interrupted: what was not done is missing")
        return "\n".join(lines)


def of_native(native: "_bekker.NativeDiagnosis") -> Diagnosis:
    """What the core found."""
    text = native.json()
    # Only a drive that was cut into windows has the first key, and only several experiments have the second.
    found = {"whole_drive": None, "where": {}} | merged(json.loads(text), json.loads(native.details()))
    return built(Diagnosis, found, improved=native.improved(), improved_parts=dict(native.improved_parts()), _json=text, _native=native)


def _list(start: str, names: list[str]) -> str:
    return start + ", ".join(names) if names else ""
