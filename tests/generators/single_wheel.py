#!/usr/bin/env python3
"""Makes the experiment in examples/sand_wheel: a wheel on a carriage over dry sand, with one hidden effect.

This is the other side of the comparison. It shares no code and no numerical scheme with the Rust model: the contact is
parametrised by its entry angle instead of its sinkage, the stresses are summed by the midpoint rule on a cosine grid
instead of Gauss-Legendre, and the load is balanced by plain bisection instead of Newton's method.

Needs numpy only. The seed is fixed: the same bytes every time.

    python3 tests/generators/single_wheel.py [FOLDER]
"""

import pathlib
import sys

import numpy as np

SEED = 20011
FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples" / "sand_wheel"

# The rig: a rigid wheel without lugs.
RADIUS = 0.10  # m
WIDTH = 0.12  # m
LOADS = (20.0, 40.0, 70.0)  # N
SPEEDS = (0.2, 0.8)  # rad/s
SLIPS = (0.02, 0.06, 0.12, 0.20, 0.30, 0.40, 0.50, 0.60, 0.70)
REPLICATES = ("a", "b", "c")

# Dry sand (Wong's table); the shear modulus is the middle of Wong's 10-25 mm.
SAND = {"k_c": 990.0, "k_phi": 1528.43e3, "n": 1.1, "c": 1040.0, "phi": np.radians(28.0), "K": 0.016, "c1": 0.4, "c2": 0.2}

# Noise: standard deviation of one sample, as a share of the signal's RMS over the experiment.
NOISE = 0.02
RUN_SHARE = 0.6  # of that standard deviation, common to a whole run (the bed is prepared anew for each run)
CORRELATION = 0.5  # of neighbouring samples in a run, AR(1)

NODES = 2000  # a zone; the forces change by under 1e-6 of the load from 1000 nodes to 2000


def slip_sinkage(slip, n1=0.35):
    """The hidden effect: what slip adds to the sinkage exponent (Ding et al. 2011), n = n0 + n1 |i|."""
    return n1 * min(abs(slip), 1.0)


def zone(start, end):
    """Midpoints and weights of a cosine grid: dense at both ends, where the stress has roots of the angle."""
    s = (np.arange(NODES) + 0.5) / NODES
    theta = start + (end - start) * 0.5 * (1.0 - np.cos(np.pi * s))
    return theta, (end - start) * 0.5 * np.pi * np.sin(np.pi * s) / NODES


def forces(entry, slip, soil, hidden):
    """Normal force, drawbar pull and torque of a wheel that drives forward with 0 <= slip < 1.

    Stresses of Wong and Reece (1967), shear of Janosi and Hanamoto (1961), exit at the lowest point.
    """
    n = soil["n"] + hidden(slip)
    peak = np.clip(soil["c1"] + soil["c2"] * abs(slip), 0.05, 0.95) * entry
    modulus = soil["k_c"] / WIDTH + soil["k_phi"]
    front, front_weight = zone(peak, entry)
    rear, rear_weight = zone(0.0, peak)
    depth_front = RADIUS * (np.cos(front) - np.cos(entry))
    depth_rear = RADIUS * (np.cos(entry - rear / peak * (entry - peak)) - np.cos(entry))
    theta = np.concatenate([rear, front])
    weight = np.concatenate([rear_weight, front_weight])
    sigma = modulus * np.maximum(np.concatenate([depth_rear, depth_front]), 0.0) ** n
    shear = RADIUS * ((entry - theta) - (1.0 - slip) * (np.sin(entry) - np.sin(theta)))
    tau = (soil["c"] + sigma * np.tan(soil["phi"])) * (1.0 - np.exp(-shear / soil["K"]))
    normal = RADIUS * WIDTH * np.sum(weight * (sigma * np.cos(theta) + tau * np.sin(theta)))
    pull = RADIUS * WIDTH * np.sum(weight * (tau * np.cos(theta) - sigma * np.sin(theta)))
    torque = RADIUS**2 * WIDTH * np.sum(weight * tau)
    return normal, pull, torque


def steady_point(load, slip, soil=SAND, hidden=slip_sinkage):
    """Drawbar pull (N), torque (N m) and sinkage (m) where the soil carries the load (N) at this slip."""
    low, high = 1e-6, np.pi / 2 - 1e-6
    if forces(high, slip, soil, hidden)[0] < load:
        raise ValueError(f"the soil does not carry {load} N at slip {slip}")
    for _ in range(60):
        middle = 0.5 * (low + high)
        if forces(middle, slip, soil, hidden)[0] < load:
            low = middle
        else:
            high = middle
    _, pull, torque = forces(0.5 * (low + high), slip, soil, hidden)
    return pull, torque, RADIUS * (1.0 - np.cos(0.5 * (low + high)))


def run_noise(rng, samples):
    """Noise of unit variance along one run: scatter of the whole run plus AR(1) from sample to sample."""
    along = np.empty(samples)
    along[0] = rng.standard_normal()
    for k in range(1, samples):
        along[k] = CORRELATION * along[k - 1] + np.sqrt(1.0 - CORRELATION**2) * rng.standard_normal()
    return RUN_SHARE * rng.standard_normal() + np.sqrt(1.0 - RUN_SHARE**2) * along


def write_experiment(folder):
    rng = np.random.default_rng(SEED)
    clean = {load: np.array([steady_point(load, slip) for slip in SLIPS]) for load in LOADS}
    deviation = NOISE * np.sqrt(np.mean(np.concatenate(list(clean.values())) ** 2, axis=0))
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    toml = [
        "# Made by tests/generators/single_wheel.py; do not edit.",
        'name = "a wheel on dry sand"',
        'kind = "single_wheel"',
        "",
        "[parameters]",
        f'"wheel.radius" = {RADIUS}',
        f'"wheel.width" = {WIDTH}',
    ]
    for load in LOADS:
        for speed in SPEEDS:
            group = f"load{load:.0f}_speed{speed}"
            for replicate in REPLICATES:
                noise = np.stack([run_noise(rng, len(SLIPS)) for _ in range(3)], axis=1)
                measured = clean[load] + deviation * noise
                name = f"runs/{group}_{replicate}.csv"
                rows = ["load,slip,wheel_speed,drawbar_pull,torque,sinkage"]
                for slip, (pull, torque, sinkage) in zip(SLIPS, measured):
                    rows.append(f"{load:.1f},{slip:.2f},{speed:.1f},{pull:.3f},{torque:.4f},{sinkage:.5f}")
                (folder / name).write_text("\n".join(rows) + "\n", encoding="ascii", newline="\n")
                toml += ["", "[[run]]", f'file = "{name}"', f'group = "{group}"']
    (folder / "experiment.toml").write_text("\n".join(toml) + "\n", encoding="ascii", newline="\n")
    return clean, deviation


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    clean, deviation = write_experiment(folder)
    print("noise: drawbar pull %.3f N, torque %.4f N m, sinkage %.2f mm" % (deviation[0], deviation[1], 1e3 * deviation[2]))
    for load, points in clean.items():
        print(f"load {load:.0f} N")
        for slip, (pull, torque, sinkage) in zip(SLIPS, points):
            print(f"  slip {slip:4.2f}  pull {pull:7.3f} N  torque {torque:6.3f} N m  sinkage {1e3 * sinkage:6.2f} mm")


if __name__ == "__main__":
    main()
