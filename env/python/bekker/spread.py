"""Fits of a diagnosis, spread over whatever an executor reaches."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future

from . import _bekker
from .errors import InputError

__all__ = ["fit_task", "through"]


def fit_task(payload: bytes) -> bytes:
    """Makes one fit, on one core: model, experiment, noise and starting values come in the payload.

    The same payload gives the same bits on any machine of one kind.
    """
    return _bekker.fit_task(payload)


def through(executor: Executor) -> Callable[[Sequence[bytes]], list[bytes]]:
    """Makes fits through an executor, in order; what a fit raises is raised here, and the others are cancelled."""
    if not callable(getattr(executor, "submit", None)):
        raise InputError(f"executor: expected a concurrent.futures.Executor, found {type(executor).__name__}")

    def fits(payloads: Sequence[bytes]) -> list[bytes]:
        futures: list[Future[bytes]] = []
        try:
            futures += (executor.submit(fit_task, payload) for payload in payloads)
            return [future.result() for future in futures]
        except BaseException:
            for future in futures:
                future.cancel()
            raise

    return fits
