"""What is known of a soil: values with their covariance, from one experiment to the next, and as a randomisation."""

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from . import _bekker
from ._bekker import Model
from .errors import InputError
from .from_json import built

__all__ = ["KnownParameter", "Soil", "SoilLike"]

# Draws outside of what the model allows are drawn again, this often at most; then they are moved to the bound.
_TRIES = 200


@dataclass(frozen=True)
class KnownParameter:
    """A parameter of a known soil, SI units."""

    name: str
    value: float
    unit: str
    scale: Literal["linear", "logarithm"]
    """Of what the covariance is: the parameter, or its natural logarithm."""
    sd: float
    """Standard deviation in the parameter's unit."""
    at_bound: bool
    """The fit wanted to go further than is believable."""
    covariance: list[float]
    """With each parameter, in their order."""


@dataclass(frozen=True, eq=False)
class Soil:
    """A soil that :func:`bekker.calibrate` has found (``Comparison.soil``), or that a file of
    ``bekker calibrate --save-soil`` holds: :meth:`read`. Give it as ``soil_from`` to :func:`bekker.compare`,
    :func:`bekker.calibrate` and :func:`bekker.diagnose`, or to an environment as ``randomise={"soil": soil}``.

    Args:
        toml: the text of such a file.

    Raises:
        InputError: the text has not this form.
    """

    toml: str
    name: str = field(init=False)
    """What it was found from."""
    contact_widths: tuple[float, ...] = field(init=False)
    """Widths of contact at which it was found, m."""
    parameters: tuple[KnownParameter, ...] = field(init=False)
    _root: NDArray[np.float64] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        found = json.loads(_bekker.known_soil(self.toml))
        parameters = tuple(built(KnownParameter, parameter) for parameter in found["parameter"])
        object.__setattr__(self, "name", found["name"])
        object.__setattr__(self, "contact_widths", tuple(found["contact_widths"]))
        object.__setattr__(self, "parameters", parameters)
        object.__setattr__(self, "_root", np.linalg.cholesky(np.array([p.covariance for p in parameters])))

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> "Soil":
        """Reads a file.

        Raises:
            OSError: it cannot be read.
            InputError: it has not this form.
        """
        return cls(Path(path).read_text(encoding="utf-8"))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file, which the command line takes as ``--soil-from`` too.

        Raises:
            OSError: it cannot be written.
        """
        Path(path).write_text(self.toml, encoding="utf-8")

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of all parameters, of each in its ``scale``."""
        return np.array([parameter.covariance for parameter in self.parameters])

    def draw(self, random: Generator, model: Model, level: float = 1.0) -> dict[str, float]:
        """Values of all parameters that hang together as the covariance says, within what ``model`` allows. At level 0 they are
        those of the model, between 0 and 1 on the straight way from these.

        Takes one number of the stream ``random``, whatever is drawn.
        """
        own = np.random.default_rng(int(random.integers(2**63)))
        ranges = {entry["name"]: (entry["min"], entry["max"]) for entry in model.parameters()}
        missing = [parameter.name for parameter in self.parameters if parameter.name not in ranges]
        if missing:
            raise InputError(f"randomise `soil`: the model has no parameter `{missing[0]}`")
        logarithm = np.array([parameter.scale == "logarithm" for parameter in self.parameters])
        low, high = np.array([ranges[parameter.name] for parameter in self.parameters]).T
        mean = np.array([parameter.value for parameter in self.parameters])
        nominal = np.array([model.get(parameter.name) for parameter in self.parameters])
        middle, here = (np.where(logarithm, np.log(np.where(logarithm, v, 1.0)), v) for v in (mean, nominal))
        for _ in range(_TRIES):
            at = here + level * (middle - here + self._root @ own.standard_normal(len(mean)))
            values = np.where(logarithm, np.exp(np.where(logarithm, at, 0.0)), at)
            if np.all((values >= low) & (values <= high)):
                break
        values = np.clip(values, low, high)
        return {parameter.name: float(value) for parameter, value in zip(self.parameters, values, strict=True)}


SoilLike: TypeAlias = Soil | str | os.PathLike[str]
"""A known soil, or the path of its file."""


def as_soil(soil: SoilLike) -> Soil:
    """A known soil, read where it is a path."""
    return soil if isinstance(soil, Soil) else Soil.read(soil)


def passed(soil: SoilLike | None) -> tuple[str, str] | None:
    """The text of a known soil, and how messages call it."""
    if soil is None:
        return None
    if isinstance(soil, Soil):
        return soil.toml, f"soil_from (`{soil.name}`)"
    return Soil.read(soil).toml, Path(soil).name
