"""Ground profiles by formula, for many runs at once, and the contact foot on them.

h(x) = slope x + a row of hills + waves; a run has a plane, or hills, or both, and all runs share the waves. The files hold the
profile sampled every 2 cm; a cubic through them differs from the formula by under 1 micrometre.
"""

import copy

import numpy as np

SPACING = 0.02  # m
FOOT_STEPS = 4


class Profile:
    """Arrays over runs: slope of the plane, height (m) and length (m) of the hills from x = 0 on; waves as
    (amplitude in m, wave number in 1/m, phase), the same for all runs."""

    def __init__(self, slope, height, length, waves=()):
        self.waves = waves
        self.slope, self.height = np.asarray(slope, float), np.asarray(height, float)
        self.number = 2.0 * np.pi / np.asarray(length, float)

    def of(self, runs):
        """The profile of these runs."""
        some = copy.copy(self)
        some.slope, some.height, some.number = self.slope[runs], self.height[runs], self.number[runs]
        return some

    def at(self, x, per_wheel=False):
        """Height, slope and curvature at x, (..., run), or (..., run, wheel) where `per_wheel`."""
        fit = lambda a: a[..., None] if per_wheel else a
        slope, height, number = fit(self.slope), fit(self.height), fit(self.number)
        z = slope * x + 0.5 * height * (1.0 - np.cos(number * x))
        rise, bend = slope + 0.5 * height * number * np.sin(number * x), 0.5 * height * number**2 * np.cos(number * x)
        for amplitude, k, phase in self.waves:
            z = z + amplitude * np.sin(k * x + phase)
            rise = rise + amplitude * k * np.cos(k * x + phase)
            bend = bend - amplitude * k * k * np.sin(k * x + phase)
        return z, rise, bend

    def foot(self, x, z):
        """The nearest point to (x, z): its x, distance along the normal, tangent (cos, sin)."""
        at = x
        for _ in range(FOOT_STEPS):
            h, slope, bend = self.at(at, True)
            at = at - (at - x + (h - z) * slope) / np.maximum(1.0 + slope * slope + (h - z) * bend, 0.1)
        h, slope, _ = self.at(at, True)
        cos = 1.0 / np.sqrt(1.0 + slope * slope)
        sin = slope * cos
        return at, (z - h) * cos - (x - at) * sin, cos, sin

    def rows(self, run, low, high):
        """Samples (x, z) of one run's ground."""
        x = np.arange(np.floor(low / SPACING), np.ceil(high / SPACING) + 1) * SPACING
        k = self.number[run]
        z = self.slope[run] * x + 0.5 * self.height[run] * (1.0 - np.cos(k * x))
        return x, z + sum(amplitude * np.sin(k * x + phase) for amplitude, k, phase in self.waves)
