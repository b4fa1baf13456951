"""The batch below the environments: bound arrays, forked processes, panics that go no further."""

import multiprocessing
import os
import subprocess
import sys
import threading

import numpy as np
import pytest

import bekker

STEPS = 10


def runs(count: int) -> list[bekker.Run]:
    model, made = bekker.Model.from_preset("two_wheeled"), []
    for k in range(count):
        model.set("soil.cohesion", 500.0 + 300.0 * k)
        made.append(model.start())
    return made


class Bound:
    """A batch and its arrays."""

    def __init__(self, count: int, threads: int = 1) -> None:
        some = runs(count)
        self.inputs = np.zeros((count, 2))
        self.signals = np.zeros((count, len(some[0].signal_names)))
        self.codes = np.zeros(count, np.uint8)
        self.batch = bekker.Batch(some, self.inputs, self.signals, self.codes, threads)

    def drive(self, turns: int) -> bytes:
        for turn in range(turns):
            self.inputs[:] = 1.0 + 0.1 * (turn % 5)
            self.batch.step(STEPS)
        return self.signals.tobytes()


def test_property_bound_arrays_hold_what_single_runs_say() -> None:
    bound, alone = Bound(3), runs(3)
    assert np.array_equal(bound.signals, [run.signals() for run in alone])
    end = bound.drive(20)
    for k, run in enumerate(alone):
        for turn in range(20):
            run.step(np.full(2, 1.0 + 0.1 * (turn % 5)), STEPS)
        assert np.array_equal(bound.signals[k], run.signals()) and bound.batch.time(k) == run.time
    assert bound.signals.tobytes() == end


def test_property_a_forked_process_steps_a_batch_whose_threads_it_does_not_have() -> None:
    bound = Bound(8, threads=3)
    bound.drive(2)  # starts the threads
    expected = Bound(8).drive(12)
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)

    def child() -> None:
        sender.send_bytes(bound.drive(10))

    # Turns 2..11 of one drive are turns 0..9 of the pattern plus two: the child makes them all over again.
    again = Bound(8)
    again.drive(2)
    expected = again.drive(10)
    process = context.Process(target=child)
    process.start()
    assert receiver.poll(60), "the child hangs"
    assert receiver.recv_bytes() == expected
    process.join(60)
    assert process.exitcode == 0
    # The parent goes on undisturbed.
    assert bound.drive(10) == expected


def test_property_a_fork_of_a_fork_and_its_end_do_not_hang() -> None:
    script = """
import os, sys
sys.path.insert(0, sys.argv[1])
from test_batch import Bound
bound = Bound(4, threads=2)
bound.drive(1)
child = os.fork()
if child == 0:
    bound.drive(1)
    grandchild = os.fork()
    if grandchild == 0:
        bound.drive(1)
        del bound
        sys.exit(0)
    _, status = os.waitpid(grandchild, 0)
    sys.exit(status)
_, status = os.waitpid(child, 0)
bound.drive(1)
sys.exit(status)
"""
    subprocess.run([sys.executable, "-c", script, os.path.dirname(__file__)], check=True, timeout=60)


def test_property_other_threads_go_on_while_a_batch_steps() -> None:
    bound, begun, seen = Bound(8), threading.Event(), threading.Event()

    def other() -> None:
        begun.wait()
        seen.set()

    thread = threading.Thread(target=other)
    thread.start()
    interval = sys.getswitchinterval()
    # Longer than all of this takes: until then the other thread runs only where a step gives up the lock.
    sys.setswitchinterval(600.0)
    try:
        begun.set()
        for _ in range(100):
            bound.batch.step(1000)
            if went_on := seen.is_set():
                break
    finally:
        sys.setswitchinterval(interval)
        thread.join()
    assert went_on


def test_property_marks_decide_who_moves() -> None:
    bound = Bound(3)
    bound.inputs[:] = 1.0
    bound.batch.step(STEPS, np.array([True, False, True]))
    assert [bound.batch.time(k) for k in range(3)] == [0.02, 0.0, 0.02]
    with pytest.raises(bekker.InputError, match="2 marks of active runs were given, this batch has 3"):
        bound.batch.step(STEPS, np.array([True, False]))


def test_property_runs_are_taken_out_and_put_back() -> None:
    bound = Bound(2)
    bound.drive(3)
    taken, before = bound.batch.run(1), bound.signals.copy()
    bound.drive(3)
    bound.batch.replace(1, taken)
    assert np.array_equal(bound.signals[1], before[1]) and not np.array_equal(bound.signals[0], before[0])
    with pytest.raises(bekker.InputError, match="run 2: expected 0 to 1"):
        bound.batch.run(2)


def test_property_a_failed_run_has_a_code_and_an_error() -> None:
    model = bekker.Model.from_preset("two_wheeled")
    model.add_effects(
        "[[effect]]\nid = 'cliff'\ntarget = 'body.force_x'\nexpression = 'share * sqrt(0.1 - share * travelled)'\n"
        "parameters = { share = { neutral = 0.0, min = 0.0, max = 1.0, unit = '1' } }\n"
    )
    good = model.start()
    model.set("cliff.share", 1.0)
    signals, codes = np.zeros((2, len(good.signal_names))), np.zeros(2, np.uint8)
    batch = bekker.Batch([good, model.start()], np.full((2, 2), 1.5), signals, codes)
    for _ in range(100):
        batch.step(STEPS)
    assert [batch.statuses[code] for code in codes] == ["running", "failed"]
    assert batch.error(0) is None and "cliff" in (batch.error(1) or "")
    assert np.isfinite(signals).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"inputs": np.zeros((2, 3))}, r"inputs: expected .* of shape \[2, 2\], found shape \[2, 3\]"),
        ({"inputs": np.zeros((2, 2)).T[:, ::-1]}, "inputs: expected a writeable array in C order"),
        ({"codes": np.zeros(3, np.uint8)}, r"codes: expected .* of shape \[2\]"),
        ({"threads": 0}, "0 threads"),
        ({"runs": []}, "a batch of no runs"),
    ],
)
def test_property_what_does_not_fit_is_named(change: dict[str, object], message: str) -> None:
    bound = Bound(2)
    arguments = {"runs": runs(2), "inputs": bound.inputs, "signals": bound.signals, "codes": bound.codes}
    with pytest.raises(bekker.InputError, match=message):
        bekker.Batch(**(arguments | change))  # type: ignore[arg-type]


def test_property_a_bad_input_is_named_and_moves_nothing() -> None:
    bound = Bound(2)
    bound.inputs[1, 0] = np.nan
    with pytest.raises(bekker.InputError, match=r"run 1: input `wheel\[1\].torque_command`"):
        bound.batch.step(STEPS)
    assert bound.batch.time(0) == 0.0
