"""What makes a traverse harder to diagnose than an ideal one: its ground, how it is driven, what is recorded and how well.

A study draws each of them for a fifth of its seeds (`drawn`). They hold for all cases of a seed, and what can be seen of an
effect is decided under them (detect.py).
"""

import numpy as np

import vehicles

SHARE = 0.2  # of the seeds, that have a condition
CONDITIONS = {
    "noise_5": "noise of 5 % of each signal's RMS in place of 2 %",
    "soil_scatter": "the soil differs from run to run, repeats included",
    "backwards": "every second set-point is driven backwards",
    "random_ground": "waves of random height, length and place on every ground",
    "current_only": "no torque and no power: currents are the only signal of force",
    "no_sinkage": "no sinkage",
    "gps": "noise of 0.02 m on x, independent from row to row",
    "jitter": "rows at uneven times",
    "gaps": "5 % of the measured cells are empty",
    "delay": "position, pitch and velocity are recorded later than the rest, by the same time throughout",
    "rocker_bogie": "one side of six wheels on a rocker-bogie in place of two wheels on a rigid body",
}

USUAL_NOISE, STRONG_NOISE = 0.02, 0.05  # share of each signal's RMS
GPS_NOISE = 0.02  # m
GAPS = 0.05  # share of the cells
DELAY = 0.1  # s
JITTER = 0.3  # of the time between rows, at most
# Standard deviation of a run's soil about the set's, relative; chosen, not taken from measurements.
SCATTER = {"k_phi": 0.05, "cohesion": 0.05, "friction_angle": 0.01, "shear_modulus": 0.05}
WAVES = 6
WAVE_HEIGHT = 0.003  # m, of one wave, standard deviation
WAVE_LENGTHS = (1.0, 4.0)  # m
STARTS, START = 50, 0.5  # draws; m about the start

TORQUES, SINKAGES, BODY = ("torque", "power"), ("sinkage",), ("x", "pitch", "velocity")


def drawn(seed):
    """The conditions of a seed."""
    rng = np.random.default_rng([seed, 3])
    return tuple(name for name in CONDITIONS if rng.uniform() < SHARE)


def check(names):
    for name in names:
        if name not in CONDITIONS:
            raise SystemExit(f"no condition `{name}`; known are {', '.join(CONDITIONS)}")
    return tuple(names)


def vehicle(names):
    return vehicles.ROCKER_BOGIE if "rocker_bogie" in names else vehicles.TWO_WHEELED


def noise(names, level=USUAL_NOISE):
    """Share of each signal's RMS that its noise has: `level` where no condition says otherwise."""
    return STRONG_NOISE if "noise_5" in names else level


def recorded(signals, names):
    """Which of the signals are recorded."""
    gone = (TORQUES if "current_only" in names else ()) + (SINKAGES if "no_sinkage" in names else ())
    return tuple(s for s in signals if not s.endswith(gone)) if gone else tuple(signals)


def directions(runs, names):
    """1 or -1 for each set-point: every second backwards, the first forwards."""
    return np.where(np.arange(runs) % 2, -1.0, 1.0) if "backwards" in names else np.ones(runs)


def waves(seed, names):
    """Amplitude (m), wave number (1/m) and phase of each wave; none on even ground."""
    if "random_ground" not in names:
        return ()
    rng = np.random.default_rng([seed, 4])
    number = 2.0 * np.pi / np.exp(rng.uniform(*np.log(WAVE_LENGTHS), WAVES))
    height = WAVE_HEIGHT * rng.standard_normal(WAVES)
    # Of some draws of the phases the one that is most level where the runs start: there the rover has to stand on the slope.
    phases = rng.uniform(0.0, 2.0 * np.pi, (STARTS, WAVES))
    start = np.linspace(-START, START, 21)[:, None, None]
    slopes = np.sum(height * number * np.cos(number * start + phases), axis=-1)
    return tuple(zip(height, number, phases[np.argmin(np.max(np.abs(slopes), axis=0))]))


def between_rows(rows, row_time, seed, names):
    """Time from each row to the next, s; whole milliseconds, as it is written."""
    if "jitter" not in names:
        return np.full(rows - 1, row_time)
    rng = np.random.default_rng([seed, 5])
    return np.round(row_time * (1.0 + JITTER * rng.uniform(-1.0, 1.0, rows - 1)), 3)


def scattered(soil, runs, rng, names):
    """Soil parameters of each run, as changes of the set's."""
    if "soil_scatter" not in names:
        return {}
    return {name: soil[name] * np.exp(share * rng.standard_normal(runs)) for name, share in SCATTER.items()}


def own_noise(signals, names):
    """Standard deviation of the noise that a signal has besides, independent from row to row."""
    return np.array([GPS_NOISE if name == "x" and "gps" in names else 0.0 for name in signals])


def kept(shape, rng, names):
    """Which cells of one run are recorded."""
    return rng.uniform(size=shape) >= GAPS if "gaps" in names else np.ones(shape, bool)
