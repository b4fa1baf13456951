"""Dataclasses built from JSON by their annotations, so that no field is copied by hand.

Each field is read from the key of its name; ``json_key`` gives another. A number that is null in JSON, which has no other
sign for one that is not finite, becomes NaN where the annotation is ``float`` or an array, and None where it allows None.
"""

import dataclasses
import types
from collections.abc import Mapping
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

__all__ = ["built", "json_key", "merged"]

T = TypeVar("T")


def json_key(key: str | None) -> dict[str, str | None]:
    """Metadata of a field whose JSON key differs from its name; with None its own fields stand among those around it."""
    return {"json_key": key}


def built(kind: type[T], found: Mapping[str, Any], **others: Any) -> T:
    """The dataclass ``kind`` from a JSON object; fields in ``others`` are taken as they are.

    Raises:
        KeyError: the object lacks the key of a field.
    """
    read = {}
    for name, (hint, key) in _fields(kind).items():
        if name not in others:
            read[name] = _value(hint, found if key is None else found[key])
    return kind(**read, **others)


def merged(first: Any, second: Any) -> Any:
    """Two JSON documents in one: objects key by key, lists of objects entry by entry; elsewhere ``second`` holds."""
    if isinstance(first, dict) and isinstance(second, dict):
        return first | {key: merged(first.get(key), value) for key, value in second.items()}
    if isinstance(first, list) and isinstance(second, list) and all(isinstance(item, dict) for item in first + second):
        return [merged(one, other) for one, other in zip(first, second, strict=True)]
    return second


def _fields(kind: type) -> dict[str, tuple[Any, str | None]]:
    """Annotation and JSON key of each field."""
    hints = get_type_hints(kind)
    fields = dataclasses.fields(kind)
    return {field.name: (hints[field.name], field.metadata.get("json_key", field.name)) for field in fields}


def _value(hint: Any, found: Any) -> Any:
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        (inner,) = (argument for argument in arguments if argument is not types.NoneType)
        return None if found is None else _value(inner, found)
    if origin is list:
        return [_value(arguments[0], item) for item in found]
    if origin is tuple:
        return tuple(_value(argument, item) for argument, item in zip(arguments, found, strict=True))
    if origin is dict:
        return {key: _value(arguments[1], item) for key, item in found.items()}
    if origin is np.ndarray:
        return np.array(found, dtype=np.float64)
    if hint is float:
        return float("nan") if found is None else float(found)
    return built(hint, found) if dataclasses.is_dataclass(hint) and isinstance(hint, type) else found
