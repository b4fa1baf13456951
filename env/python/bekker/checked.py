"""Numbers that a user gives, checked."""

from typing import Any

import numpy as np

from .errors import InputError

__all__ = ["finite", "real", "whole"]


def real(name: str, value: Any) -> float:
    """One real number, from Python or numpy.

    Raises:
        InputError: it is something else; the message has ``name``.
    """
    found = np.asarray(value)
    if found.ndim != 0 or found.dtype.kind not in "biuf":
        raise InputError(f"{name} = {value!r}: expected a number, found {type(value).__name__}")
    return float(found)


def finite(name: str, value: Any, above: float = -np.inf) -> float:
    """One finite real number, above a limit where there is one.

    Raises:
        InputError: it is something else; the message has ``name``.
    """
    found = real(name, value)
    if not (np.isfinite(found) and found > above):
        more = "" if above == -np.inf else f" above {above:g}"
        raise InputError(f"{name} = {value}: expected a finite number{more}")
    return found


def whole(name: str, value: Any, least: int) -> int:
    """A whole number from ``least``, from Python or numpy.

    Raises:
        InputError: it is something else; the message has ``name``.
    """
    if not isinstance(value, (int, np.integer)) or value < least:
        raise InputError(f"{name} = {value!r}: expected a whole number from {least}")
    return int(value)
