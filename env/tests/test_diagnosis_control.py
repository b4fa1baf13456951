"""A diagnosis under way: executors, progress, a budget of time, Ctrl-C. None of them changes a number."""

import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from typing import Any

import pytest
from sand_wheel import CANDIDATES, DRAWS, as_arrays, sand

import bekker


class Counting(Executor):
    """Another executor that counts what it is given, and makes the last task first."""

    def __init__(self) -> None:
        self.waiting: list[tuple[Future[Any], Callable[..., Any], tuple[Any, ...]]] = []
        self.made = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        counting, (module, name) = self, (fn.__module__, fn.__qualname__)
        assert getattr(sys.modules[module], name) is fn, "a worker finds the function by its name"

        class Late(Future[Any]):
            def result(self, timeout: float | None = None) -> Any:
                while counting.waiting:
                    future, work, given = counting.waiting.pop()
                    future.set_result(work(*given))
                    counting.made += 1
                return super().result(timeout)

        future = Late()
        self.waiting.append((future, fn, args))
        return future


def test_agreement_an_executor_changes_nothing(diagnosis: bekker.Diagnosis) -> None:
    counting = Counting()
    assert sand(executor=counting).to_json() == diagnosis.to_json()
    assert counting.made >= len(CANDIDATES)
    with ThreadPoolExecutor(2) as pool:
        assert sand(executor=pool).to_json() == diagnosis.to_json()


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_agreement_processes_change_nothing(diagnosis: bekker.Diagnosis, method: str) -> None:
    with warnings.catch_warnings():
        # Newer Pythons warn of forks beside threads; a worker waits for no thread of its parent.
        warnings.simplefilter("ignore", DeprecationWarning)
        with ProcessPoolExecutor(2, mp_context=get_context(method)) as pool:
            found = bekker.diagnose(as_arrays(lambda frame: frame), candidates=CANDIDATES, draws=DRAWS, executor=pool)
    assert found.to_json() == diagnosis.to_json()


class Broken(Executor):
    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        raise ZeroDivisionError("no machine")


def test_property_what_others_raise_is_raised(diagnosis: bekker.Diagnosis) -> None:
    with pytest.raises(ZeroDivisionError, match="no machine"):
        sand(executor=Broken())

    def stop(progress: bekker.Progress) -> None:
        if progress.done > 0.0:
            raise LookupError(progress.stage)

    with pytest.raises(LookupError, match="noise"):
        sand(progress=stop)
    with pytest.raises(bekker.InputError, match="executor: expected a concurrent.futures.Executor, found int"):
        sand(executor=3)
    # Nothing of that is left behind.
    assert sand().to_json() == diagnosis.to_json()


def test_property_progress_is_told(diagnosis: bekker.Diagnosis) -> None:
    told: list[bekker.Progress] = []
    threads: set[int] = set()

    def tell(progress: bekker.Progress) -> None:
        told.append(progress)
        threads.add(threading.get_ident())

    assert sand(progress=tell).to_json() == diagnosis.to_json()
    assert threads == {threading.get_ident()}
    assert told[0].done == 0.0 and told[0].remaining is None and told[-1].done == 1.0
    assert all(0.0 <= p.done <= 1.0 for p in told) and "calibrating" in str(told[0])
    assert all(a.done <= b.done and a.elapsed <= b.elapsed for a, b in zip(told, told[1:], strict=False))
    assert any("slip_sinkage + exit_angle" in p.trying or p.trying.startswith("slip_sinkage (") for p in told)
    assert told[-1].remaining == 0.0


def test_property_a_budget_of_time_lists_what_was_not_tried(diagnosis: bekker.Diagnosis) -> None:
    short = sand(time_budget=1e-3)
    assert short.not_tried and not short.interrupted and not diagnosis.not_tried
    assert short.verdict == "undetermined" and not any(candidate.refitted for candidate in short.candidates)
    assert short.steps[0].rmse == diagnosis.steps[0].rmse and short.smallest_p == diagnosis.smallest_p
    # Plenty of time changes nothing.
    assert sand(time_budget=1e4).to_json() == diagnosis.to_json()
    for wrong in (0.0, -1.0, float("nan"), "long"):
        with pytest.raises(bekker.InputError, match="time_budget"):
            sand(time_budget=wrong)


@pytest.fixture
def ctrl_c() -> Iterator[None]:
    """Ctrl-C as in a terminal: a process started in the background by a script ignores it, and hands that down."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("ctrl_c")
def test_property_ctrl_c_leaves_what_was_found(diagnosis: bekker.Diagnosis) -> None:
    pressed: list[str] = []

    def press(progress: bekker.Progress) -> None:
        # Once: a second time ends the work without a result.
        if "left out" in progress.stage and not pressed:
            pressed.append(progress.stage)
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(bekker.DiagnosisInterrupted) as caught:
        sand(progress=press)
    assert isinstance(caught.value, KeyboardInterrupt) and not isinstance(caught.value, Exception)
    partial = caught.value.partial
    assert partial is not None and partial.interrupted and not diagnosis.interrupted
    # After a stop the baseline's values come from those with derivatives, whose rounding differs.
    assert partial.steps[0].rmse == pytest.approx(diagnosis.steps[0].rmse, rel=1e-12) and not partial.profiles
    with pytest.raises(bekker.InputError, match="interrupted"):
        partial.plot_profiles()


@pytest.mark.usefixtures("ctrl_c")
def test_property_ctrl_c_during_fits_elsewhere() -> None:
    class Pressing(Executor):
        def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            signal.raise_signal(signal.SIGINT)
            return Future()

    with pytest.raises(bekker.DiagnosisInterrupted) as caught:
        sand(executor=Pressing())
    assert caught.value.partial is None or caught.value.partial.interrupted
