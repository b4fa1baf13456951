"""Worlds: soils and hidden effects that stay the same for some episodes, in splits for training, validation and test.

A policy is trained where the soil is ordinary and effects are few, and is judged on soils and effects that it has never met. The
argument ``worlds`` of an environment draws another world at every reset; :func:`bekker.adaptation.evaluate` drives some episodes in
each of given worlds::

    env = gymnasium.make("bekker/BlindSlope-v0", worlds="train")                         # to train in
    judged = gymnasium.make("bekker/BlindSlope-v0")
    result = bekker.adaptation.evaluate(judged, policy, bekker.worlds.SPLITS["test"].worlds(42))

The splits are meant for the tasks on the two-wheeled rover's sand (Rover, SpeedHold, SlopeClimb, BlindSlope, SlipLimited). What these draw by
themselves overlaps the soils of the test: a policy that is to be judged is trained with ``worlds="train"``. The strengths of the
effects are such that a driver who knows them still comes to the goal of `bekker/BlindSlope-v0`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians
from types import MappingProxyType
from typing import Any
from zlib import crc32

import numpy as np

from ._bekker import Model
from .errors import InputError
from .models import effects as all_effects
from .randomise import Distribution, LogUniform, Uniform, distribution
from .vocabulary import unknown

__all__ = ["NO_EFFECT", "SPLITS", "Split", "World", "split_of"]

NO_EFFECT = "none"
"""Name of the worlds without a hidden effect."""


_VERSION = 1
"""Another number gives other worlds."""


@dataclass(frozen=True)
class World:
    """A soil, and perhaps an effect, that a policy is not told."""

    split: str
    number: int
    soil: str
    """Name of the kind of soil in its split."""
    effect: str
    """Id of the effect (:func:`bekker.effects`), or :data:`NO_EFFECT`."""
    parameters: Mapping[str, float]
    """Their values by the vocabulary's names."""

    @property
    def options(self) -> dict[str, Any]:
        """Options of a ``reset`` that starts an episode in it, also in an environment that draws worlds by itself."""
        return {"parameters": dict(self.parameters), "worlds": False}

    def on(self, model: Model) -> Model:
        """A copy of a model with this soil and effect. What a task draws besides is not in it."""
        changed = model.copy()
        for name, value in self.parameters.items():
            changed.set(name, value)
        return changed


@dataclass(frozen=True)
class Split:
    """Worlds of one purpose: each kind of soil meets each effect, with values of its own."""

    name: str
    purpose: str
    """What it is for, a sentence."""
    soils: Mapping[str, Mapping[str, Distribution]]
    """Distributions of the soil's parameters, by the name of the kind of soil."""
    effects: Mapping[str, Mapping[str, Distribution]]
    """Distributions of an effect's parameters by its id, nothing under :data:`NO_EFFECT`."""

    def __post_init__(self) -> None:
        if not self.soils or not self.effects:
            raise InputError(f"split `{self.name}`: expected a soil and an effect at least ({NO_EFFECT!r} for none)")
        for effect, scatter in self.effects.items():
            if effect != NO_EFFECT and effect not in all_effects():
                raise unknown("effect", effect, all_effects())
            for name in scatter:
                if not name.startswith(f"{effect}."):
                    raise InputError(f"split `{self.name}`, effect `{effect}`: `{name}` is no parameter of it")
        # Distributions from pairs or plain data, as `randomise` takes them.
        for group in ("soils", "effects"):
            checked = {key: {n: distribution(n, d) for n, d in scatter.items()} for key, scatter in getattr(self, group).items()}
            object.__setattr__(self, group, checked)

    def world(self, number: int) -> World:
        """The world of a number from 0: neighbouring numbers have different effects, then different soils."""
        if number < 0:
            raise InputError(f"world {number}: expected a number from 0")
        effects, soils = list(self.effects), list(self.soils)
        effect = effects[number % len(effects)]
        soil = soils[number // len(effects) % len(soils)]
        random = np.random.default_rng([_VERSION, crc32(self.name.encode()), number])
        scatter = {**self.soils[soil], **self.effects[effect]}
        return World(self.name, number, soil, effect, {name: drawn.draw(random) for name, drawn in scatter.items()})

    def worlds(self, count: int) -> list[World]:
        """The first ``count`` worlds."""
        return [self.world(number) for number in range(count)]

    @property
    def distributions(self) -> list[tuple[str, Distribution]]:
        """Everything that is drawn, with the parameter's name."""
        groups = (*self.soils.values(), *self.effects.values())
        return [(name, scatter) for group in groups for name, scatter in group.items()]


def _soil(cohesion: tuple[float, float], friction: tuple[float, float]) -> dict[str, Distribution]:
    return {"soil.cohesion": LogUniform(*cohesion), "soil.friction_angle": Uniform(*map(radians, friction))}


SPLITS: Mapping[str, Split] = MappingProxyType(
    {
        split.name: split
        for split in (
            Split(
                "train",
                "What a policy may learn from: medium sand, and three effects of load and passes.",
                {"medium": _soil((800.0, 1250.0), (29.0, 31.0))},
                {
                    NO_EFFECT: {},
                    "payload": {"payload.mass": Uniform(1.0, 6.0)},
                    "multi_pass": {"multi_pass.growth": Uniform(0.2, 1.0)},
                    "drag": {"drag.force": Uniform(1.0, 6.0)},
                },
            ),
            Split(
                "validation",
                "To choose settings by: softer and firmer sand, and effects of wheel and rate that training does not have.",
                {"soft": _soil((700.0, 800.0), (28.3, 29.0)), "firm": _soil((1250.0, 1600.0), (31.0, 32.0))},
                {
                    NO_EFFECT: {},
                    "flexible_wheel": {"flexible_wheel.compliance": Uniform(5e-5, 2e-4)},
                    "rate": {"rate.exponent": Uniform(0.1, 0.3)},
                },
            ),
            Split(
                "test",
                "What is judged: looser and denser sand, and effects that neither training nor validation has.",
                {"loose": _soil((550.0, 700.0), (27.5, 28.3)), "dense": _soil((1600.0, 2200.0), (32.0, 34.0))},
                {
                    NO_EFFECT: {},
                    "grousers": {"grousers.height": Uniform(0.003, 0.012)},
                    "exit_angle": {"exit_angle.lambda": Uniform(0.2, 0.7)},
                    "tether": {"tether.stiffness": Uniform(0.5, 3.0)},
                    "bulldozing": {"bulldozing.share": Uniform(0.1, 0.4)},
                    "slope_strength": {"slope_strength.beta": Uniform(0.05, 0.25)},
                    "radius_scale": {"radius_scale.deviation": Uniform(0.03, 0.07)},
                },
            ),
        )
    }
)
"""The registered splits by name. No effect and no soil of one is in another."""


def split_of(split: str | Split) -> Split:
    """A split by its name, or as it is.

    Raises:
        UnknownNameError: there is none of this name.
        InputError: it is neither.
    """
    if isinstance(split, Split):
        return split
    if not isinstance(split, str):
        raise InputError(f"worlds: expected the name of a split or a Split, found {type(split).__name__}")
    if split not in SPLITS:
        raise unknown("split", split, SPLITS)
    return SPLITS[split]
