"""Levels of a condition: set-points that a rig holds roughly, or classes where the values are spread."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "levels", "means"]

Floats: TypeAlias = NDArray[np.float64]

# Values that differ by less than this share of the range are one level; the core's reports use the same.
_SAME_LEVEL = 0.02

# Set-points are held within this share of the range; what is wider has no levels but values all along.
_WIDEST_LEVEL = 0.1


def levels(values: Floats, most: int) -> list[tuple[float, float]]:
    """Lowest and highest value of each level, rising: gaps divide them, or where that gives more than ``most``, classes
    of equal count."""
    there = np.sort(values[~np.isnan(values)])
    if there.size == 0:
        return []
    gap = _SAME_LEVEL * (there[-1] - there[0])
    parts = np.split(there, np.flatnonzero(np.diff(there) > gap) + 1)
    widest = max(part[-1] - part[0] for part in parts)
    if len(parts) > most or widest > _WIDEST_LEVEL * (there[-1] - there[0]):
        # Equal values stay together: an edge between them moves up.
        edges = np.unique(there[[k * there.size // most for k in range(most)]])
        parts = [part for part in np.split(there, np.searchsorted(there, edges[1:])) if part.size]
    return [(float(part[0]), float(part[-1])) for part in parts]


def means(x: Floats, y: Floats, most: int = 60) -> tuple[Floats, Floats]:
    """Means of x and y by level of x; rows without a y are left out."""
    there = ~(np.isnan(x) | np.isnan(y))
    x, y = x[there], y[there]
    inside = [(x >= low) & (x <= high) for low, high in levels(x, most)]
    return np.array([x[part].mean() for part in inside]), np.array([y[part].mean() for part in inside])
