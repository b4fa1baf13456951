"""Values as the text of a TOML file."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from .errors import InputError

__all__ = ["number", "numbers", "quantity", "text", "value"]


def text(content: object) -> str:
    """A TOML string; JSON's is one but for the character DEL."""
    if not isinstance(content, str):
        raise InputError(f"expected a text, found {content!r}")
    return json.dumps(content, ensure_ascii=False).replace("\x7f", "\\u007f")


def number(place: str, content: object) -> str:
    try:
        return repr(float(content))  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise InputError(f"{place}: expected a number, found {content!r}") from None


def numbers(place: str, values: Mapping[str, Any]) -> list[str]:
    if not isinstance(values, Mapping):
        raise InputError(f"{place}: expected a mapping from name to number, found {type(values).__name__}")
    return [f"{text(name)} = {quantity(f'{place}, `{name}`', value)}" for name, value in values.items()]


def quantity(place: str, content: object) -> str:
    return value(place, content) if isinstance(content, Mapping) else number(place, content)


def value(place: str, content: object) -> str:
    """A value of TOML on one line."""
    if isinstance(content, Mapping):
        return f"{{ {', '.join(f'{text(key)} = {value(place, inner)}' for key, inner in content.items())} }}"
    if isinstance(content, (list, tuple)):
        return f"[{', '.join(value(place, inner) for inner in content)}]"
    if isinstance(content, bool):
        return "true" if content else "false"
    if isinstance(content, str):
        return text(content)
    if isinstance(content, (int, np.integer)):
        return str(int(content))
    return number(place, content)
