#!/usr/bin/env python3
"""Makes tests of a soil, by plates and by shear, with one hidden effect: the other side of the comparison with the Rust model.

It shares no code with the model, and each hidden effect has a form of its own where the literature has one:

- plate_size: resistance grows linearly with the width of the plate, as the bearing capacity of a footing does (Terzaghi 1943);
- box_walls: 1 + a (d/W)^3;
- box_bottom: 1/(1 - s z/(H - z)): the layer that is left gets stiffer as it gets thinner;
- rate: 1 + m ln(v/v_0);
- seating: an offset that differs from test to test about its mean;
- shear_rate: 1 + m ln(v/v_0);
- box_friction: a stress that is there at once and grows a little with the normal stress;
- shear_play: a gap that closes softly;
- softening: the hump of Wong 2008, 2.4.3.

Outside of the library: crust (a stiff layer that breaks), hardpan (a layer below), ripple (stick and slip), drift (the normal stress falls).

A whole test scatters by `--soil` of what it resists, rows by `--noise` of it with a correlation from row to row.

Needs numpy only; the same seed makes the same bytes.

    python3 tests/generators/soil_tests.py --kind plate_sinkage --case seating --seed 3 FOLDER
    python3 tests/generators/soil_tests.py --examples
"""

import argparse
import pathlib

import numpy as np

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"

# Soil: k_c (N/m^(n+1)), k_phi (N/m^(n+2)), n, cohesion (Pa), friction angle (deg), K (m): LETE sand (Wong), whose k_c counts.
LETE = {"k_c": 102e3, "k_phi": 5301e3, "n": 0.793, "c": 1300.0, "phi": 31.1, "K": 0.012}

DIAMETERS = (0.05, 0.10, 0.15)  # m
BOX = {"width": 0.5, "depth": 0.25}  # m
SPEEDS = {"slow": 0.002, "fast": 0.05}  # m/s; the model's moduli hold at 0.01
STRESSES = (2e3, 5e3, 10e3, 20e3)  # Pa
SHEAR_SPEEDS = {"slow": 1e-4, "fast": 1e-2}  # m/s; the model's strength holds at 0.001
SCATTER = 0.04  # of what a soil resists, from test to test
ROWS = 25
CORRELATION = 0.6
CELL = 0.05  # noise of the load cell, over that of the rows, of a usual value


def plate_factor(case, strength, z, diameter, speed):
    """What an effect multiplies the pressure by at the sinkages z."""
    b = 0.5 * diameter
    if case == "plate_size":
        return 1.0 + strength * (b / 0.05 - 1.0)
    if case == "box_walls":
        return 1.0 + strength * (diameter / BOX["width"]) ** 3
    if case == "box_bottom":
        return 1.0 / (1.0 - strength * diameter * z / (BOX["depth"] - z) ** 2)
    if case == "rate":
        return 1.0 + strength * np.log(speed / 0.01)
    if case == "crust":
        return 1.0 + strength * np.exp(-(((z - 0.006) / 0.003) ** 2))
    if case == "hardpan":
        return 1.0 + strength * np.maximum(z - 0.02, 0.0) / 0.02
    return 1.0


def pressure(case, strength, z, diameter, speed, rng, soil=LETE):
    """Pressure (Pa) under a round plate at the recorded sinkages (m)."""
    if case == "seating":
        z = np.maximum(z + strength * (1.0 + 0.1 * rng.standard_normal()), 0.0)
    k = soil["k_c"] / (0.5 * diameter) + soil["k_phi"]
    return k * z ** soil["n"] * plate_factor(case, strength, z, diameter, speed)


def shear_stress(case, strength, j, sigma, speed, soil=LETE):
    """Shear stress (Pa) at the recorded displacements (m)."""
    added, factor, normal = 0.0, 1.0, np.full_like(j, sigma)
    if case == "shear_play":
        j = j - strength * (1.0 - np.exp(-j / strength))
    if case == "box_friction":
        added = strength * (0.9 + 0.1 * sigma / max(STRESSES))
    if case == "shear_rate":
        factor = 1.0 + strength * np.log(speed / 1e-3)
    if case == "ripple":
        factor = 1.0 + strength * np.sin(2.0 * np.pi * j / 0.013)
    if case == "drift":
        normal = sigma * (1.0 - strength * np.sin(np.pi * j / 0.04))
    top = soil["c"] + normal * np.tan(np.radians(soil["phi"]))
    if case == "softening":
        rest = 1.0 - strength
        hump = rest * (1.0 + (1.0 / (rest * (1.0 - np.exp(-1.0))) - 1.0) * np.exp(1.0 - j / soil["K"] / 1.5))
        return top * hump * (1.0 - np.exp(-j / soil["K"] / 1.5))
    return added + top * (1.0 - np.exp(-j / soil["K"])) * factor


# Strengths at which each effect is clear beside 2 % of noise and 4 % of scatter from test to test.
STRENGTHS = {
    "clean": 0.0,
    "plate_size": 0.5,
    "box_walls": 25.0,
    "box_bottom": 0.5,
    "rate": 0.15,
    "seating": 0.003,
    "crust": 0.6,
    "hardpan": 1.0,
    "shear_rate": 0.08,
    "box_friction": 900.0,
    "shear_play": 0.004,
    "softening": 0.3,
    "ripple": 0.12,
    "drift": 0.4,
}
PLATE_CASES = ("clean", "plate_size", "box_walls", "box_bottom", "rate", "seating", "crust", "hardpan")
SHEAR_CASES = ("clean", "shear_rate", "box_friction", "shear_play", "softening", "ripple", "drift")


def noisy(rng, clean, noise, soil):
    """A test with the scatter of its soil and noise along its rows, both shares of what is measured, and a little of a load cell."""
    along = np.empty(len(clean))
    along[0] = rng.standard_normal()
    for k in range(1, len(clean)):
        along[k] = CORRELATION * along[k - 1] + np.sqrt(1.0 - CORRELATION**2) * rng.standard_normal()
    cell = CELL * noise * np.sqrt(np.mean(clean**2)) * rng.standard_normal(len(clean))
    return clean * (1.0 + soil * rng.standard_normal() + noise * along) + cell


def plate_runs(case, strength, noise, soil, repeats, rng, diameters=DIAMETERS, ground=LETE):
    """Name, group, settings, header and rows of each test."""
    for diameter in diameters:
        for speed_name, speed in SPEEDS.items():
            group = f"plate{1e3 * diameter:.0f}_{speed_name}"
            for repeat in range(repeats):
                z = 0.03 * ((np.arange(ROWS) + rng.uniform(0.8, 1.2, ROWS)) / ROWS) ** 1.5
                clean = pressure(case, strength, z, diameter, speed, rng, ground) * np.pi * diameter**2 / 4.0
                force = noisy(rng, clean, noise, soil)
                rows = [f"{1e3 * a:.3f},{b:.3f}" for a, b in zip(z, force)]
                settings = f'{{ "plate.diameter" = {diameter}, "plate.speed" = {speed} }}'
                yield f"{group}_{'abcdefgh'[repeat]}", group, settings, "sinkage_mm,force_n", rows


def shear_runs(case, strength, noise, soil, repeats, rng, ground=LETE):
    for sigma in STRESSES:
        for speed_name, speed in SHEAR_SPEEDS.items():
            group = f"stress{1e-3 * sigma:.0f}_{speed_name}"
            for repeat in range(repeats):
                j = 0.08 * ((np.arange(ROWS) + rng.uniform(0.8, 1.2, ROWS)) / ROWS) ** 2
                tau = noisy(rng, shear_stress(case, strength, j, sigma, speed, ground), noise, soil)
                rows = [f"{1e3 * a:.3f},{1e-3 * sigma:.3f},{1e-3 * b:.4f}" for a, b in zip(j, tau)]
                settings = f'{{ "shear_box.speed" = {speed} }}'
                yield f"{group}_{'abcdefgh'[repeat]}", group, settings, "displacement_mm,normal_kpa,shear_kpa", rows


HEADS = {
    "plate_sinkage": [
        "[columns]",
        'sinkage_mm = { signal = "sinkage", unit = "mm" }',
        'force_n = { signal = "force", unit = "N" }',
        "",
        "[parameters]",
        f'"soil_box.width" = {BOX["width"]}',
        f'"soil_box.depth" = {BOX["depth"]}',
    ],
    "shear": [
        "[columns]",
        'displacement_mm = { signal = "displacement", unit = "mm" }',
        'normal_kpa = { signal = "normal_stress", unit = "kPa" }',
        'shear_kpa = { signal = "shear_stress", unit = "kPa" }',
    ],
}


def write(folder, kind, case, seed, strength=None, noise=0.02, soil=SCATTER, repeats=3, diameters=DIAMETERS, name=None, ground=LETE):
    """Writes an experiment folder; `ground` is the soil, with the keys of LETE."""
    rng = np.random.default_rng(seed)
    strength = STRENGTHS[case] if strength is None else strength
    runs = (
        plate_runs(case, strength, noise, soil, repeats, rng, diameters, ground)
        if kind == "plate_sinkage"
        else shear_runs(case, strength, noise, soil, repeats, rng, ground)
    )
    toml = [
        "# Made by tests/generators/soil_tests.py; do not edit.",
        f'name = "{name or case}"',
        f'kind = "{kind}"',
        "",
        *HEADS[kind],
    ]
    for run, group, settings, header, rows in runs:
        file = folder / "runs" / f"{run}.csv"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join([header, *rows]) + "\n", encoding="ascii", newline="\n")
        toml += ["", "[[run]]", f'file = "runs/{run}.csv"', f'group = "{group}"', f"parameters = {settings}"]
    (folder / "experiment.toml").write_text("\n".join(toml) + "\n", encoding="ascii", newline="\n")


def write_examples(folder=EXAMPLES):
    """The shipped folders."""
    write(folder / "sand_plates", "plate_sinkage", "seating", 20023, name="plates on dense sand")
    write(folder / "sand_shear", "shear", "softening", 20024, name="shear tests of dense sand")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    parser.add_argument("--examples", action="store_true", help="write the shipped folders")
    parser.add_argument("--kind", choices=("plate_sinkage", "shear"), default="plate_sinkage")
    parser.add_argument("--case", choices=sorted(STRENGTHS), default="clean")
    parser.add_argument("--strength", type=float)
    parser.add_argument("--noise", type=float, default=0.02)
    parser.add_argument("--soil", type=float, default=SCATTER, help="scatter from test to test")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--diameters", type=float, nargs="*", default=list(DIAMETERS))
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if given.examples:
        write_examples()
    elif given.folder:
        cases = PLATE_CASES if given.kind == "plate_sinkage" else SHEAR_CASES
        if given.case not in cases:
            parser.error(f"a {given.kind} experiment has the cases {', '.join(cases)}")
        write(given.folder, given.kind, given.case, given.seed, given.strength, given.noise, given.soil, given.repeats, tuple(given.diameters))
    else:
        parser.error("give a folder, or --examples")


if __name__ == "__main__":
    main()
