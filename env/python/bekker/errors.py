"""Exceptions of the package. Each is also the built-in exception that one would expect."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .diagnosed import Diagnosis

__all__ = [
    "BekkerError",
    "DiagnosisInterrupted",
    "InputError",
    "ModelError",
    "PlanningError",
    "SimulationError",
    "UnknownNameError",
]


class BekkerError(Exception):
    """Anything that bekker refuses or that goes wrong in it."""


class ModelError(BekkerError, ValueError):
    """A model or one of its parameters is refused; the message names it and the allowed range."""


class UnknownNameError(ModelError, KeyError):
    """No preset, parameter, input or signal has this name; the message suggests near ones."""

    # KeyError would show the message in quotes.
    __str__ = Exception.__str__


class InputError(BekkerError, ValueError):
    """An input or argument is refused: wrong length, NaN, out of range."""


class SimulationError(BekkerError, RuntimeError):
    """A run cannot start or go on. Ends of a drive (stuck, tipped over ...) are not errors but a status."""


class PlanningError(BekkerError, RuntimeError):
    """There is no pose or no path; the message says why and where."""

    nearest: tuple[float, float] | None
    """Where the goal is out of reach: the nearest point to it that a safe path reaches, m. None otherwise."""

    def __init__(self, message: str, nearest: Sequence[float] | None = None) -> None:
        super().__init__(message)
        self.nearest = None if nearest is None else (float(nearest[0]), float(nearest[1]))


class DiagnosisInterrupted(KeyboardInterrupt):
    """Ctrl-C ended a diagnosis. Not a BekkerError: nothing went wrong."""

    partial: "Diagnosis | None"
    """What was found by then, with ``interrupted`` set; None where that is nothing yet."""

    def __init__(self, partial: "Diagnosis | None" = None) -> None:
        super().__init__("the diagnosis was interrupted; what was found is in `partial`" if partial else "")
        self.partial = partial
