"""Types of the vocabulary's entries, and names looked up with suggestions."""

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Literal, TypedDict

from .errors import UnknownNameError

__all__ = ["Variable"]


class Variable(TypedDict):
    """A parameter, input or signal of a model."""

    name: str
    """Full name, the same in Rust, TOML, FMU and CSV headers, for example ``wheel[2].slip``."""
    value: float
    """Present value (of a signal: 0)."""
    unit: str
    """SI unit."""
    doc: str
    """One line of meaning."""
    default: float
    """Default; for a parameter of an effect the neutral value, at which nothing changes."""
    min: float
    """Smallest allowed value."""
    max: float
    """Largest allowed value."""
    role: Literal["fixed", "rig", "calibrated", "effect", "signal"]
    """Whether a default calibration may move it."""
    source: str
    """Where the default, the bounds or the equation come from."""


def unknown(kind: str, name: object, known: Iterable[str]) -> UnknownNameError:
    """The error for a name that does not exist, with the nearest names (all, where they are few)."""
    names = list(known)
    near = names if len(names) <= 8 else get_close_matches(str(name), names, n=3)
    hint = f"; expected {', '.join(near)}" if near and near == names else ""
    hint = hint or (f"; did you mean {', '.join(near)}?" if near else "")
    return UnknownNameError(f"unknown {kind} `{name}`{hint}")
