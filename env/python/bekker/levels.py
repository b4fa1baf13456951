"""Levels of a condition: set-points that a rig holds roughly, or classes where the values are spread."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["Floats", "levels", "set_points", "smooth"]

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


def set_points(values: Floats, least: float, most: int = 10) -> list[tuple[float, float]]:
    """Lowest and highest value of each class, rising, where the values stand in at most ``most`` classes that lie apart by
    more than ``least`` and by more than twice the width of the widest class; one class otherwise. As the core's."""
    there = np.sort(values[~np.isnan(values)])
    if there.size == 0:
        return []
    gaps = np.diff(there)
    for smallest in np.sort(gaps[gaps > least])[::-1][: most - 1][::-1]:
        parts = np.split(there, np.flatnonzero(gaps >= smallest) + 1)
        if len(parts) <= most and smallest > 2.0 * max(part[-1] - part[0] for part in parts):
            return [(float(part[0]), float(part[-1])) for part in parts]
    return [(float(there[0]), float(there[-1]))]


def smooth(x: Floats, y: Floats, span: float = 0.75, places: int = 60) -> tuple[Floats, Floats]:
    """A smooth of y over x, at places of the samples: local straight lines (LOESS of degree 1, Cleveland 1979), each over
    the share ``span`` of the samples; rows without an x or y are left out. As the core's."""
    there = ~(np.isnan(x) | np.isnan(y))
    order = np.argsort(x[there], kind="stable")
    x, y = x[there][order], y[there][order]
    if x.size == 0:
        return x, y
    reach = min(max(int(np.ceil(span * x.size)), 4), x.size)
    apart = float(x[-1] - x[0]) / places
    kept = [float(x[0])]
    for place in x:
        if place - kept[-1] >= apart and x[-1] - place >= apart:
            kept.append(float(place))
    at = np.unique([*kept, float(x[-1])])
    return at, np.array([_local(x, y, reach, place) for place in at])


def _local(x: Floats, y: Floats, reach: int, place: float) -> float:
    apart = x - place
    width = np.partition(np.abs(apart), reach - 1)[reach - 1]
    if width == 0.0:
        return float(y[apart == 0.0].mean())
    # A little wider than the farthest sample, whose weight would be nothing.
    weight = np.clip(1.0 - (np.abs(apart) / (1.001 * width)) ** 3, 0.0, None) ** 3
    weight = np.where(np.abs(apart) <= width, weight, 0.0) / weight[np.abs(apart) <= width].sum()
    middle = float(weight @ apart)
    spread = float(weight @ (apart - middle) ** 2)
    # Samples at one place have no slope.
    slope = float(weight @ ((apart - middle) * y)) / spread if spread > 1e-9 * width**2 else 0.0
    return float(weight @ y) - slope * middle
