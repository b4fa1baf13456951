"""Candidate fits of a diagnosis spread with Ray, here over the cores of one machine.

    pip install ./env ray
    python examples/ray_diagnosis.py [EXPERIMENT]

`bekker.diagnose` takes any `concurrent.futures.Executor`, and the result is the same to the last bit wherever the fits are
made. Ray needs the adapter below, five lines; on a cluster it is `ray.init("auto")` and nothing else changes, as long as
the workers have the package too. Dask has an executor of its own:

    from dask.distributed import Client
    diagnosis = bekker.diagnose(experiment, executor=Client(address).get_executor())

It pays where one fit takes seconds, as on a traverse; a wheel on a carriage is diagnosed faster than Ray starts.
"""

import functools
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import ray

import bekker

SAND = Path(__file__).parent / "sand_wheel"


class RayExecutor(Executor):
    """Tasks of Ray behind the interface of `concurrent.futures`; each takes one core."""

    def __init__(self) -> None:
        # Sent to the cluster once a function, not once a task.
        self._remote = functools.cache(ray.remote)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = self._remote(fn).remote(*args, **kwargs).future()
        return future


def timed(label: str, **options: Any) -> bekker.Diagnosis:
    start = time.perf_counter()
    diagnosis = bekker.diagnose(sys.argv[1] if len(sys.argv) > 1 else SAND, **options)
    print(f"{label}: {time.perf_counter() - start:.1f} s")
    return diagnosis


ray.init(log_to_driver=False)
with RayExecutor() as executor:
    spread = timed("with Ray", executor=executor)
here = timed("threads of this process")
assert spread.to_json() == here.to_json(), "the fits are the same wherever they are made"
print(spread)
