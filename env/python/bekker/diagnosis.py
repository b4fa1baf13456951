"""Which physical effect is missing from the model: :func:`diagnose`; what it finds is a :class:`Diagnosis`."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from . import _bekker
from .checked import whole
from .diagnosed import Diagnosis, of_native
from .errors import DiagnosisInterrupted, InputError
from .experiment import ExperimentLike, sources, together_of
from .models import ModelLike, given, names_of
from .soil import SoilLike, passed
from .spread import through

__all__ = ["Diagnosis", "Progress", "diagnose"]


@dataclass(frozen=True)
class Progress:
    """How far a diagnosis is."""

    stage: str
    """What is being done, for people."""
    trying: str
    """What is being tried within the stage, for example ``slip_sinkage + drag (7 of 22)``; empty where the stage says it
    all."""
    done: float
    """Share of the expected work that is done, 0 to 1; never falls."""
    elapsed: float
    """Time since the start, s."""
    remaining: float | None
    """Estimate of the time left, s: what fits have taken so far times the fits that this stage and, at most, the later
    ones still make. None before the baseline is calibrated."""

    def __str__(self) -> str:
        left = "" if self.remaining is None else f", about {self.remaining:.0f} s left"
        trying = f": {self.trying}" if self.trying else ""
        return f"{100 * self.done:3.0f} %  {self.stage}{trying}{left}"


def diagnose(
    experiment: ExperimentLike | Sequence[ExperimentLike],
    model: ModelLike | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    soil_from: SoilLike | None = None,
    soil_scatter: float | None = None,
    share: Iterable[str] | None = None,
    candidates: Iterable[str] | None = None,
    added: Iterable[str] | None = None,
    max_effects: int = 3,
    draws: int = 399,
    windows: int = 64,
    executor: Executor | None = None,
    progress: Callable[[Progress], object] | None = None,
    time_budget: float | None = None,
) -> Diagnosis:
    """Compares a model with an experiment and finds out which physical effect is missing from it, if any.

    For each parameter the first that gives a value holds: a run's own ``parameters``; ``parameters`` here; what the model
    states (in its file, or by ``Model.set``; a built-in model states nothing); the experiment's ``parameters``; the mean of a
    prior; the built-in model. Dimensions and masses of the rig are taken from the experiment rather than from the model. Where
    two disagree, ``sources`` says so.
    An effect that the model has switched on is part of the baseline, held at its value.

    Without a ``time_budget`` the result depends neither on the number of threads nor on the executor nor on the clock. The
    interpreter is free for other threads meanwhile; Ctrl-C cuts the simulations at hand short and leaves what was found.

    Args:
        experiment: the folder with ``experiment.toml``, or an :class:`bekker.Experiment`; or a sequence of these, made on one soil: the
            soil's parameters are shared, each experiment keeps its rig and its noise, and an effect may act in some of them only,
            which :attr:`Diagnosis.where` says. Signals and runs then have the name of their experiment before their own.
        model: a Model, the name of a preset, TOML text, or the path of a TOML file; where None, the one that the experiment
            names, or else a plain wheel, or a rover with as many wheels as the commands name.
        parameters: values by name that go before the model and the experiment's ``parameters``, though not before a run's own;
            a calibration leaves them as they are unless they have a prior.
        soil_from: what another experiment found of the soil, as in :func:`bekker.compare`.
        soil_scatter: of several experiments the relative standard deviation of the soil from one to the next, 0 where all were made in
            one bed; 0.05 where None.
        share: of several experiments what they share, of ``"soil"``, ``"vehicle"`` (wheels, masses and drive) and ``"drive"`` (motor and
            gear); of what is not named each has its own. Where None, what the experiments name alike in ``shared``, else the soil alone.
        candidates: ids of the effects to try (:func:`bekker.effects`); all where None.
        added: ids of effects that are part of the baseline, with free parameters.
        max_effects: most effects that are added.
        draws: bootstrap draws, at least 100; p-values are not below 1/(draws + 1), and to be named takes less than 0.01.
        windows: different windows of a long drive, at least 8, that take part in the fits, evenly spread. A window has 6 s; the others
            judge the final model.
        executor: where candidates are fitted: any ``concurrent.futures.Executor``, for example a
            ProcessPoolExecutor, a Dask client's ``get_executor()`` or Ray through a small adapter (see
            ``examples/ray_diagnosis.py``). Each fit takes one core there. The threads of this machine where None.
        progress: called in this thread with a :class:`Progress` when a piece of work begins and when it ends; ``print``
            will do.
        time_budget: time that the diagnosis may take, s. It decides before each batch of fits whether there is time left
            for it; what was not tried is listed in ``not_tried``, and no number is changed by it. The baseline is always
            calibrated.

    Raises:
        UnknownNameError, ModelError: as :func:`bekker.compare`; a candidate that does not exist.
        InputError: an argument or the data of an :class:`bekker.Experiment` are refused.
        SimulationError: the model cannot compute a measured row within the bounds of its parameters.
        DiagnosisInterrupted: Ctrl-C; a KeyboardInterrupt whose ``partial`` is what was found by then. A second Ctrl-C
            does not wait for that.
        Exception: whatever the executor or ``progress`` raise, as it is.
    """
    native, raised = _bekker.diagnose(
        sources(experiment),
        *given(model, parameters),
        None if candidates is None else names_of("candidates", candidates),
        names_of("added", added or ()),
        whole("max_effects", max_effects, 0),
        # Fewer cannot give a p-value under 0.01, so that nothing would ever be named.
        whole("draws", draws, 100),
        whole("windows", windows, 8),
        None if executor is None else through(executor),
        None if progress is None else _telling(progress),
        _seconds(time_budget),
        passed(soil_from),
        together_of(experiment, soil_scatter, share),
    )
    if isinstance(raised, KeyboardInterrupt):
        raise DiagnosisInterrupted(None if native is None else of_native(native)) from raised
    if raised is not None:
        raise raised
    assert native is not None, "the core raises or finds"
    return of_native(native)


def _telling(progress: Callable[[Progress], object]) -> Callable[[str, str, float, float, float | None], None]:
    def tell(stage: str, trying: str, done: float, elapsed: float, remaining: float | None) -> None:
        progress(Progress(stage, trying, done, elapsed, remaining))

    return tell


def _seconds(time_budget: float | None) -> float | None:
    if time_budget is None:
        return None
    if not isinstance(time_budget, (int, float, np.integer, np.floating)) or not 0.0 < time_budget < float("inf"):
        raise InputError(f"time_budget = {time_budget!r}: expected a positive number of seconds")
    return float(time_budget)
