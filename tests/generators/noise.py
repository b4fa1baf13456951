"""Noise of measurements: a part common to a whole run and a part correlated from sample to sample, as in single_wheel.py."""

import numpy as np

RUN_SHARE = 0.6  # of the standard deviation, common to a whole run
CORRELATION = 0.5  # of neighbouring samples, AR(1)


def draw(rng, runs, rows, signals):
    """Noise of unit variance, (runs, rows, signals)."""
    along = rng.standard_normal((runs, rows, signals))
    fresh = np.sqrt(1.0 - CORRELATION**2)
    for k in range(1, rows):
        along[:, k] = CORRELATION * along[:, k - 1] + fresh * along[:, k]
    return RUN_SHARE * rng.standard_normal((runs, 1, signals)) + np.sqrt(1.0 - RUN_SHARE**2) * along


def covariance(rows):
    """Covariance along one run."""
    lag = np.abs(np.subtract.outer(np.arange(rows), np.arange(rows)))
    return RUN_SHARE**2 + (1.0 - RUN_SHARE**2) * CORRELATION**lag


def whitener(rows, deviation=1.0, own=0.0):
    """The matrix that makes the noise along one run white: noise of this standard deviation, and of `own`, independent from row to
    row, besides."""
    return np.linalg.inv(np.linalg.cholesky(deviation**2 * covariance(rows) + own**2 * np.eye(rows)))
