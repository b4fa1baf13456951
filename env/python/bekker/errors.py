"""Exceptions of the package. Each is also the built-in exception that one would expect."""

__all__ = ["BekkerError", "InputError", "ModelError", "SimulationError", "UnknownNameError"]


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
