"""What is taken for a model, and the catalogues of built-in models and effects."""

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from . import _bekker
from ._bekker import Model
from .errors import InputError
from .vocabulary import unknown

__all__ = ["Given", "ModelLike", "as_model", "effects", "export_fmu", "given", "names_of", "presets", "save_model"]

ModelLike = Model | str | os.PathLike[str]
"""A :class:`Model`, the name of a preset, TOML text, or the path of a TOML file."""


Given = tuple[tuple[Model, str] | None, dict[str, float]]
"""What is given beside an experiment: a model with the name that it was asked for by (None for the experiment's own, or one
that is built in), and parameters that are set by hand."""


def presets() -> dict[str, str]:
    """Names and meanings of the built-in models."""
    return dict(_bekker.presets())


def effects(*, soil_tests: bool = False) -> dict[str, str]:
    """Ids and meanings of the effects. Every model has them all; their parameters are neutral by default.

    Args:
        soil_tests: those of tests of a soil, by plates and by shear, instead; a rover has none of them.
    """
    return dict(_bekker.test_effects() if soil_tests else _bekker.effects())


def as_model(model: ModelLike, parameters: Mapping[str, float] | None = None) -> Model:
    """A model of one's own (never the caller's object) with ``parameters`` set by name.

    Raises:
        UnknownNameError: no preset or parameter of that name.
        ModelError: the TOML or a value is refused.
        OSError: the file cannot be read.
    """
    own = _read(model)
    for name, value in (parameters or {}).items():
        own.set(name, value)
    return own


def given(model: ModelLike | None, parameters: Mapping[str, float] | None) -> Given:
    """What is given beside an experiment. Errors as :func:`as_model`; the names of ``parameters`` are checked later."""
    values = {name: float(value) for name, value in (parameters or {}).items()}
    if model is None:
        return None, values
    own = _read(model)
    # A model in memory has its own name, and TOML text is none.
    asked = own.name if isinstance(model, Model) else os.fspath(model)
    return (own, own.name if "\n" in asked or "=" in asked else asked), values


def export_fmu(
    model: ModelLike,
    path: str | os.PathLike[str],
    parameters: Mapping[str, float] | None = None,
    *,
    fmi: int | None = None,
    kind: str | None = None,
    libraries: Sequence[str | os.PathLike[str]] = (),
    arrays: bool = False,
    system_inputs: bool = False,
) -> None:
    """Writes a model as an FMU; its parameters can be changed in the FMU. To a path that ends in ``.ssp``, as a system of
    two FMUs of FMI 2.0, the rover and its controller (SSP 1.0).

    Args:
        model: What to pack.
        path: Where to write.
        parameters: Changes to the model's parameters.
        fmi: Version of the standard: 2 (2.0, which nearly every tool reads) or 3 (3.0). Where missing 3, and 2 in a system.
        kind: What of the model it offers: ``rover`` (the plant alone), ``controller`` or ``closed-loop`` (both), or
            ``carriage`` of a wheel on a carriage; what the model file says where missing.
        libraries: Libraries for other platforms, packed besides the one for this machine; each file says for which
            platform it is.
        arrays: Whether FMI 3.0 shows the same quantity of every wheel, link or obstacle as one array, ``wheels.slip``.
        system_inputs: Whether a system has the inputs that no FMU feeds as its own, where FMPy sets them; Ecos and libcosim
            refuse a system that has inputs.

    Raises:
        UnknownNameError, ModelError: as :func:`as_model`, or the model does not start, or cannot be what is asked.
        OSError: a file cannot be read or written.
        ValueError: there is no such version or kind.
    """
    _bekker.export_fmu(as_model(model, parameters), path, fmi, kind, list(libraries), arrays, system_inputs)


def save_model(model: Model, path: str | os.PathLike[str]) -> None:
    """Writes a model as TOML; reading it back gives the same model to the last bit.

    Raises:
        OSError: the file cannot be written.
    """
    Path(path).write_text(model.to_toml(), encoding="utf-8")


def names_of(argument: str, names: Iterable[str]) -> list[str]:
    """A list of names; a single text, which is an iterable of its letters, is refused."""
    listed = list(names)
    if isinstance(names, str) or not all(isinstance(name, str) for name in listed):
        raise InputError(f"{argument}: expected a list of names, found {names!r}")
    return listed


def _read(model: ModelLike) -> Model:
    if isinstance(model, Model):
        return model.copy()
    if isinstance(model, os.PathLike):
        return Model.read(model)
    if not isinstance(model, str):
        raise InputError(f"model: expected a Model, a preset's name, TOML text or a path, found {type(model).__name__}")
    if model in presets():
        return Model.from_preset(model)
    # A path has no line breaks and no `=`; TOML text that says anything has one of them.
    if "\n" in model or "=" in model:
        return Model.from_toml(model)
    if model.endswith(".toml"):
        return Model.read(model)
    raise unknown("preset", model, presets())
