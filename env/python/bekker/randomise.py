"""Distributions of parameters, drawn anew for every episode (domain randomisation).

Each takes one number from the environment's stream, so that another distribution of one parameter leaves the draws of those
after it as they are. As arguments they may also be written in plain data, which a gymnasium spec keeps as JSON:

| data | distribution |
|---|---|
| ``(low, high)`` | :class:`Uniform` |
| ``{"uniform": [low, high]}`` | :class:`Uniform` |
| ``{"log_uniform": [low, high]}`` | :class:`LogUniform` |
| ``{"normal": [mean, deviation, low, high]}`` | :class:`Normal` |
| ``{"choice": [value, ...]}`` | :class:`Choice` |

A curriculum scales them: at level 1 they are as given, towards level 0 they shrink to the parameter's own value.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from statistics import NormalDist
from typing import Any, TypeAlias

from numpy.random import Generator

from .errors import InputError
from .vocabulary import unknown

__all__ = ["Choice", "Distribution", "LogUniform", "Normal", "Randomise", "Uniform", "distribution"]


class Distribution(ABC):
    """How a parameter scatters from episode to episode."""

    @abstractmethod
    def check(self) -> str | None:
        """What was expected, where the numbers make no sense."""

    @abstractmethod
    def ends(self) -> tuple[float, ...]:
        """The values among which all draws lie: each has to be one that the parameter allows."""

    @abstractmethod
    def at(self, level: float, nominal: float) -> "Distribution":
        """The distribution at a level from 0 to 1 of the curriculum, where ``nominal`` is the parameter's own value."""

    @abstractmethod
    def quantile(self, share: float) -> float:
        """The value below which ``share`` (0 to 1) of the draws lie."""

    def draw(self, random: Generator) -> float:
        """A value."""
        return self.quantile(random.random())


@dataclass(frozen=True)
class Uniform(Distribution):
    """Evenly between two values."""

    low: float
    high: float

    def check(self) -> str | None:
        return None if _ordered(self.low, self.high) else "finite numbers, low <= high"

    def ends(self) -> tuple[float, ...]:
        return self.low, self.high

    def at(self, level: float, nominal: float) -> "Uniform":
        return Uniform(*(_between(nominal, end, level) for end in self.ends()))

    def quantile(self, share: float) -> float:
        return _between(self.low, self.high, share)


@dataclass(frozen=True)
class LogUniform(Distribution):
    """Evenly in the logarithm between two values above 0: for what spreads over decades, such as soil moduli."""

    low: float
    high: float

    def check(self) -> str | None:
        return None if _ordered(self.low, self.high) and self.low > 0.0 else "finite numbers, 0 < low <= high"

    def ends(self) -> tuple[float, ...]:
        return self.low, self.high

    def at(self, level: float, nominal: float) -> "LogUniform":
        if level == 1.0 or nominal <= 0.0:
            # There is no way in logarithms to a value that has none.
            return self
        return LogUniform(*(nominal * float((end / nominal) ** level) for end in self.ends()))

    def quantile(self, share: float) -> float:
        return min(max(self.low * float((self.high / self.low) ** share), self.low), self.high)


@dataclass(frozen=True)
class Normal(Distribution):
    """Normal, cut off at two values and spread evenly over what is left."""

    mean: float
    deviation: float
    low: float
    high: float

    def check(self) -> str | None:
        good = _ordered(self.low, self.high) and isfinite(self.mean) and self.deviation > 0.0 and isfinite(self.deviation)
        return None if good else "finite numbers, low <= high, a deviation above 0"

    def ends(self) -> tuple[float, ...]:
        return self.low, self.high

    def at(self, level: float, nominal: float) -> Distribution:
        if level == 0.0:
            return Uniform(nominal, nominal)
        low, high = (_between(nominal, end, level) for end in self.ends())
        return Normal(_between(nominal, self.mean, level), level * self.deviation, low, high)

    def quantile(self, share: float) -> float:
        normal = NormalDist(self.mean, self.deviation)
        inside = _between(normal.cdf(self.low), normal.cdf(self.high), share)
        # Far out in a tail there is no more than rounding between the ends.
        value = normal.inv_cdf(inside) if 0.0 < inside < 1.0 else (self.low if inside <= 0.0 else self.high)
        return min(max(value, self.low), self.high)


@dataclass(frozen=True)
class Choice(Distribution):
    """One of some values, each as likely as the others. A curriculum takes the first ones only: order them from easy to hard."""

    values: tuple[float, ...]

    def check(self) -> str | None:
        return None if self.values and all(map(isfinite, self.values)) else "one finite number at least"

    def ends(self) -> tuple[float, ...]:
        return self.values

    def at(self, level: float, nominal: float) -> "Choice":
        return Choice(self.values[: 1 + int(level * (len(self.values) - 1))])

    def quantile(self, share: float) -> float:
        return self.values[min(int(share * len(self.values)), len(self.values) - 1)]


Randomise: TypeAlias = Mapping[str, Any]
"""Distributions, or their data, by the parameter's name; under ``soil`` a known soil (:class:`bekker.Soil`) or the path of its file."""

_KINDS: dict[str, type[Uniform] | type[LogUniform] | type[Normal]] = {
    "uniform": Uniform,
    "log_uniform": LogUniform,
    "normal": Normal,
}


def distribution(name: str, given: Distribution | Sequence[float] | Mapping[str, Sequence[float]]) -> Distribution:
    """The distribution of the parameter ``name``, checked."""
    found = given if isinstance(given, Distribution) else _from_data(name, given)
    expected = found.check()
    if expected is not None:
        raise InputError(f"randomise `{name}` = {given}: expected {expected}")
    return found


def _from_data(name: str, given: Sequence[float] | Mapping[str, Sequence[float]]) -> Distribution:
    refused = InputError(f"randomise `{name}` = {given}: expected a pair (low, high), a distribution or its data")
    try:
        if not isinstance(given, Mapping):
            low, high = given
            return Uniform(float(low), float(high))
        ((kind, numbers),) = given.items()
        if kind == "choice":
            return Choice(tuple(float(value) for value in numbers))
        if kind not in _KINDS:
            raise unknown("distribution", kind, [*_KINDS, "choice"])
        return _KINDS[kind](*(float(value) for value in numbers))
    except TypeError:
        raise refused from None
    except ValueError as error:
        raise (error if isinstance(error, InputError | KeyError) else refused) from None


def _ordered(low: float, high: float) -> bool:
    return isfinite(low) and isfinite(high) and low <= high


def _between(a: float, b: float, share: float) -> float:
    return a if a == b else a + (b - a) * share
