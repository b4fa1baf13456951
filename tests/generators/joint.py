#!/usr/bin/env python3
"""Makes several experiments on one soil, with one effect hidden in one or all of them.

    python3 tests/generators/joint.py --parts wheel,other_wheel --case slip_sinkage --place other_wheel --seed 3 FOLDER

FOLDER gets a folder for each part and truth.json: the effect, in which parts it acts, its size in standard deviations as seen by
the part alone. Parts are `wheel` and `other_wheel` (two wheels of different size on a carriage), `plates` and `shear` (tests of the same
soil), and `drive` (four runs of a rover with repeats). The strength is at least 1.5 times what the part alone can see. Needs numpy only.
"""

import argparse
import json
import pathlib
import sys
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import cases  # noqa: E402
import hidden  # noqa: E402
import soil_detect  # noqa: E402
import soil_tests  # noqa: E402
import soils  # noqa: E402
import vehicles  # noqa: E402
from bench_rover import RoverBench  # noqa: E402
from bench_wheel import WheelBench  # noqa: E402
from detect import Detector  # noqa: E402

WHEELS = ("wheel", "other_wheel")
TESTS = {"plates": "plate_sinkage", "shear": "shear"}
DRIVE = "drive"
PARTS = (*WHEELS, *TESTS, DRIVE)
NOISE = 0.02
DRIVE_SIZE = "reduced"
SCATTER = 0.04  # of the soil from part to part, relative
# Dimensions of the second wheel over those of the first: wider, smaller, and under other loads.
WIDER, SMALLER, HEAVIER = 1.6, 0.8, 1.3


def kind_of(part):
    """The kind of experiment that a wheel or a drive is."""
    return cases.ROVER if part == DRIVE else cases.WHEEL


class OnSoil(WheelBench):
    """A wheel on a soil that is given as k_c and k_phi."""

    def __init__(self, seed, soil, rig, heavier):
        self.given, self.given_rig, self.heavier = soil, rig, heavier
        self.draw(np.random.default_rng([seed, 1]), False)

    def draw(self, rng, poor):
        super().draw(rng, poor)
        self.rig = self.given_rig
        self.soil_name, self.soil = "shared", at_width(self.given, self.rig["width"])
        self.set_points = [(round(self.heavier * load, 1), speed) for load, speed in self.set_points]


def prepared(soil, seed, scatter):
    """The soil of each part: a bed that is prepared anew differs by `scatter` (relative), its angle of friction by a fifth of that."""
    rng = np.random.default_rng([seed, 11])
    of_parts = {}
    for part in PARTS:
        stiffness, strength, angle, modulus = np.exp(scatter * np.array([1.0, 1.0, 0.2, 1.0]) * rng.standard_normal(4))
        changed = {"k_c": stiffness, "k_phi": stiffness, "cohesion": strength, "friction_angle": angle, "shear_modulus": modulus}
        of_parts[part] = {name: value * float(changed.get(name, 1.0)) for name, value in soil.items()}
    return of_parts


def at_width(soil, width):
    """The soil as a contact of one width meets it: the width is the smaller side of the contact."""
    return {name: value for name, value in soil.items() if name != "k_c"} | {"k_phi": soil["k_phi"] + soil["k_c"] / width}


def rover_on(seed, soil):
    """A rover that drives on this soil; None where the soil does not carry it up the slopes."""
    width = vehicles.TWO_WHEELED.parameters["width"]
    try:
        return RoverBench(seed, DRIVE_SIZE, soil=("shared", at_width(soil, width)))
    except RuntimeError:
        return None


def shared_soil(seed, scatter, drives=False):
    """A soil with k_c and k_phi of its own, that of each part, and two wheels that it carries, and with `drives` a rover."""
    rng = np.random.default_rng([seed, 9])
    for _ in range(200):
        rig = {"radius": float(rng.choice([0.10, 0.12])), "width": float(rng.choice([0.08, 0.10]))}
        name = str(rng.choice(soils.FIRM))
        n, k_c, k_phi, cohesion, angle, modulus, c1, c2 = soils.TABLE[name]
        spread = lambda size: float(np.exp(size * np.clip(rng.standard_normal(), -2.0, 2.0)))
        soil = {
            "k_c": k_c * spread(0.15), "k_phi": k_phi * spread(0.15), "exponent": n * spread(0.05),
            "cohesion": cohesion * spread(0.15), "friction_angle": float(np.radians(angle)) * spread(0.04),
            "shear_modulus": modulus * spread(0.12), "c1": c1 * spread(0.08), "c2": c2 * spread(0.15),
        }  # fmt: skip
        other = {"radius": SMALLER * rig["radius"], "width": WIDER * rig["width"]}
        beds = prepared(soil, seed, scatter)
        benches = {"wheel": OnSoil(seed, beds["wheel"], rig, 1.0), "other_wheel": OnSoil(seed + 1, beds["other_wheel"], other, HEAVIER)}
        clean = [bench.simulate([{}, {"slip_sinkage.ding": 0.3}]) for bench in benches.values()]
        if not all(np.all(np.isfinite(signals)) for signals in clean):
            continue
        if drives:
            benches[DRIVE] = rover_on(seed + 2, beds[DRIVE])
            if benches[DRIVE] is None:
                continue
        return name, soil, beds, benches
    raise RuntimeError("no soil carries all")


def detector_of(part, bench, level=NOISE):
    """What can be seen of an effect in a wheel's part or a drive alone."""
    kind = kind_of(part)
    replicates = hidden.REPLICATES if kind == cases.WHEEL else bench.replicates
    return Detector(bench, level, replicates, cases.library(kind, False))


def make(folder, parts, case, place, seed, level=NOISE, multiple=None, form=None, scatter=SCATTER):
    """Writes the folders and returns the truth. `place` is the part with the effect, or `all` for every wheel and drive; `scatter` is how much
    the soil differs from part to part."""
    folder = pathlib.Path(folder)
    name, shared, beds, benches = shared_soil(seed, scatter, DRIVE in parts)
    of_tests = {"plates": soil_tests.PLATE_CASES, "shear": soil_tests.SHEAR_CASES}
    shows = lambda part: case in of_tests[part] if part in TESTS else case in cases.cases_of(kind_of(part))
    there = [part for part in parts if place == part or place == "all" and part not in TESTS]
    if case != "clean" and not all(shows(part) for part in there):
        raise SystemExit(f"{case}: no effect of {place}")
    truth = {"parts": list(parts), "case": case, "where": [] if case == "clean" else there, "seed": seed, "noise": level, "scatter": scatter}
    truth |= {"soil_name": name, "soil": {f"soil.{key}": value for key, value in shared.items()}, "effects": []}
    strength = None
    for k, part in enumerate(parts):
        # Every set has noise of its own, also in the parts where nothing is hidden: else one odd draw shows in all sets of a seed.
        own = seed + 1000 * (k + 1) + 1_000_000 * (1 + zlib.crc32(f"{'+'.join(parts)}/{case}/{place}".encode()) % 1000)
        if part in TESTS:
            soil = beds[part]
            ground = {"k_c": soil["k_c"], "k_phi": soil["k_phi"], "n": soil["exponent"], "c": soil["cohesion"],
                      "phi": float(np.degrees(soil["friction_angle"])), "K": soil["shear_modulus"]}  # fmt: skip
            hides = part in there and case != "clean"
            seen = soil_detect.Detector(TESTS[part], ground, level, soil_tests.SCATTER).truth(case, np.random.default_rng([own, 4])) if hides else None
            inside, size = (case, seen["strength"]) if hides else ("clean", None)
            soil_tests.write(folder / part, TESTS[part], inside, own, strength=size, ground=ground, noise=level)
            truth["effects"] += [seen | {"part": part}] if hides else []
            continue
        kind, detector = kind_of(part), detector_of(part, benches[part], level)
        inside = case if part in truth["where"] else "clean"
        own_form = form if any(f.case == case and f.form == form and kind in f.kinds for f in cases.FORMS) else None
        if inside != "clean" and strength is not None:
            # The same strength in every part.
            signature = detector.signature(detector.effect(cases.find(kind, case, own_form), strength))
            multiple = float(np.linalg.norm(signature)) / hidden.DETECTABLE
        made = hidden.make(folder / part, kind, inside, own_form, level, own, multiple, detector=detector)
        for effect in made["effects"]:
            strength = effect["strength"]
            truth["effects"].append({**effect, "part": part})
    (folder / "truth.json").write_text(json.dumps(truth, indent=1, sort_keys=True) + "\n", encoding="ascii", newline="\n")
    return truth


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--parts", default="wheel,other_wheel", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--case", default="clean")
    parser.add_argument("--place", default="all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", type=float, default=NOISE)
    parser.add_argument("--scatter", type=float, default=SCATTER, help="of the soil from part to part, relative")
    parser.add_argument("--multiple", type=float, help="of the smallest strength that the part alone can see")
    parser.add_argument("folder", metavar="FOLDER")
    a = parser.parse_args()
    parts = a.parts.split(",")
    unknown = [part for part in [*parts, a.place] if part not in (*PARTS, "all")]
    if unknown:
        parser.error(f"no part {', '.join(unknown)}; parts are {', '.join(PARTS)}")
    truth = make(a.folder, parts, a.case, a.place, a.seed, a.noise, a.multiple, scatter=a.scatter)
    for effect in truth["effects"]:
        print(f"{effect['case']} = {effect['strength']:.4g} in {effect['part']}: {effect['deviations']:.1f} deviations there alone")


if __name__ == "__main__":
    main()
