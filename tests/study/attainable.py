"""What a model with the true effect in its true form would leave on left-out conditions of a wheel's experiment.

A diagnosis is judged by the left-out error that its named effect removes. How much could be removed at all is found here: the
generator's own model, with the soil and the true effect's strength free, is fitted to all groups but one and predicts that
one, in turn, as the diagnosis does with its own model. Noise that happens to be large stays in both.
"""

import csv

import numpy as np

import noise
from soils import CALIBRATED

# Bounds of a default calibration, as the diagnosis has them; k_phi and K are searched in logarithms.
BOUNDS = {
    "cohesion": (0.0, 5e3),
    "friction_angle": (0.0, 0.8),
    "k_phi": (1e4, 1e8),
    "exponent": (0.3, 1.5),
    "shear_modulus": (0.001, 0.1),
    "c1": (0.0, 0.6),
    "c2": (0.0, 0.5),
}
LOGARITHMIC = ("k_phi", "shear_modulus")
STEP = 1e-5  # of a coordinate's scale, for differences
STEPS = 25
ENOUGH = 1e-4  # share of chi-square that a step has to win


class Coordinates:
    """Search coordinates of the soil and of hidden strengths, and the way back."""

    def __init__(self, soil, forms):
        self.names = [*CALIBRATED, *(form.key for form in forms)]
        self.bounds = dict(BOUNDS) | {form.key: ((-form.bound if form.signed else 0.0), form.bound) for form in forms}
        self.soil = soil

    def of(self, values):
        ends = [self.bounds[name] for name in self.names]
        scaled = lambda name, v, low, high: np.log(v) if name in LOGARITHMIC else v / (high - low)
        return np.array([scaled(n, np.clip(values[n], *e), *e) for n, e in zip(self.names, ends)])

    def changes(self, u):
        """Parameter values, within their bounds."""
        values = {}
        for name, x in zip(self.names, u):
            low, high = self.bounds[name]
            values[name] = float(np.clip(np.exp(x) if name in LOGARITHMIC else x * (high - low), low, high))
        return values


def measured(folder, bench, replicates):
    """Signals as written: group, replicate, row, signal."""
    data = np.full((len(bench.set_points), replicates, len(bench.slips), len(bench.signals)), np.nan)
    for g, (load, speed) in enumerate(bench.set_points):
        for r in range(replicates):
            path = folder / "runs" / f"load{load:g}_speed{speed:g}_{'abcdef'[r]}.csv"
            with open(path, encoding="ascii") as file:
                for k, row in enumerate(csv.DictReader(file)):
                    data[g, r, k] = [float(row[name]) for name in bench.signals]
    return data


def heldout_rmse(folder, bench, forms, strengths, deviation, replicates):
    """RMSE by signal on each group, predicted from the others by the true model; None where it finds no fit."""
    data = measured(folder, bench, replicates)
    coordinates = Coordinates(bench.soil, forms)
    start = coordinates.of(bench.soil | {form.key: strengths[form.key] for form in forms})
    white = noise.whitener(data.shape[2])
    residual_of = lambda signals: (data - signals[:, None]) / deviation
    squares, count = np.zeros(len(bench.signals)), 0
    for left_out in range(len(bench.set_points)):
        kept = [g for g in range(len(bench.set_points)) if g != left_out]
        whitened = lambda signals: np.einsum("ij,grjs->gris", white, residual_of(signals)[kept]).ravel()
        fitted = fit(bench, coordinates, start, whitened)
        if fitted is None:
            return None
        predicted = bench.simulate([coordinates.changes(fitted)])[0]
        error = data[left_out] - predicted[left_out][None]
        squares += np.nansum(error**2, axis=(0, 1))
        count += error.shape[0] * error.shape[1]
    return dict(zip(bench.signals, np.sqrt(squares / count).tolist()))


def fit(bench, coordinates, start, whitened):
    """Levenberg-Marquardt within the bounds, from the truth; None where the rig does not run."""
    u, damping = start.copy(), 1e-3
    residual = whitened(bench.simulate([coordinates.changes(u)])[0])
    if not np.all(np.isfinite(residual)):
        return None
    for _ in range(STEPS):
        moved = [u + STEP * np.eye(len(u))[k] for k in range(len(u))]
        changed = bench.simulate([coordinates.changes(v) for v in moved])
        jacobian = np.stack([(whitened(signals) - residual) / STEP for signals in changed], axis=1)
        # A parameter on its bound does not move there and has no slope.
        jacobian = np.where(np.isfinite(jacobian), jacobian, 0.0)
        gram, along = jacobian.T @ jacobian, jacobian.T @ residual
        before, won = residual @ residual, False
        for _ in range(8):
            step = np.linalg.solve(gram + damping * np.diag(np.diag(gram) + 1e-12), -along)
            there = coordinates.of(coordinates.changes(u + step))
            new = whitened(bench.simulate([coordinates.changes(there)])[0])
            if np.all(np.isfinite(new)) and new @ new < before:
                u, residual, damping, won = there, new, damping / 5.0, True
                break
            damping *= 5.0
        if not won or before - residual @ residual < ENOUGH * before:
            break
    return u
