#!/usr/bin/env python3
"""Makes an experiment with something hidden in it, and a file that tells what.

    python3 tests/generators/hidden.py --kind single_wheel --case slip_sinkage --form lyasko --noise 0.02 --seed 17 FOLDER

FOLDER gets experiment.toml, the CSV files and truth.json: case, form, strength, its size in standard deviations.
`--case a+b` hides two effects, `--case clean` none. See README.md here. Needs numpy only.
"""

import argparse
import json
import pathlib
import sys
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import cases  # noqa: E402
import conditions  # noqa: E402
import noise as noises  # noqa: E402
from bench_wheel import WheelBench  # noqa: E402
from detect import DETECTABLE, Detector, alone, effect, nearest, side_by_side  # noqa: E402
from refit import finding_fit, promised  # noqa: E402

REPLICATES = 3


def make_bench(kind, seed, size, poor, under=()):
    if kind == cases.WHEEL:
        return WheelBench(seed, poor)
    from bench_rover import RoverBench

    return RoverBench(seed, size, poor, under)


def hidden_forms(kind, case, form):
    if case == "clean" or case in cases.CAUTION:
        return []
    names, forms = case.split("+"), (form or "").split("+")
    forms += [""] * (len(names) - len(forms))
    return [cases.find(kind, name, f or None) for name, f in zip(names, forms)]


def choosing(detector, forms, rng, multiple=None):
    """Strengths of the hidden effects: from 1.5 times the smallest detectable to what is usual, drawn in logarithms. A search for
    `detect.side_by_side`; gives for each its form, strength and length in deviations."""
    chosen = []
    for k, form in enumerate(forms):
        sign = float(rng.choice([-1.0, 1.0])) if form.signed else 1.0
        # The partner of a pair may take up what it can: its signature at typical strength is free as well.
        other = None
        if len(forms) == 2:
            partner = forms[1 - k]
            other = yield from detector.finding_signature((yield from effect(partner, 0.2 * partner.typical)))
        wanted = 1.02 * DETECTABLE * (multiple if multiple else 1.5)  # the search meets it to 2 %
        strength, reached, fits = yield from detector.finding_strength(form, sign, wanted, other)
        signals, least = (yield from effect(form, strength)), abs(strength)
        if not multiple and least < form.typical:
            share = rng.uniform()
            for _ in range(4):  # weaker where the rig does not run
                wished = sign * least ** (1.0 - share) * form.typical**share
                stronger = yield from effect(form, wished)
                # A rig that is about to get stuck may do so with fine steps only.
                if np.all(np.isfinite(stronger)) and np.all(np.isfinite((yield [{form.key: wished}], False))):
                    strength, signals = wished, stronger
                    break
                share *= 0.5
        fit = yield from finding_fit(detector, signals, *nearest(fits, abs(strength)))
        reached = float(np.linalg.norm(detector.without(promised(detector, fit), other)))
        chosen.append((form, strength, reached))
    return chosen


def describe(chosen):
    return [
        {
            "case": form.case,
            "form": form.form,
            "library_form": form.library,
            "outside": form.outside,
            "strength": strength,
            "deviations": reached,
            "visible": bool(reached >= 1.5 * DETECTABLE * 0.999),
        }
        for form, strength, reached in chosen
    ]


def random_of(seed, case, form, level):
    """The random numbers of an experiment: first those of its strengths, then those of its noise."""
    return np.random.default_rng([seed, 2, zlib.crc32(f"{case}/{form}/{level}".encode())])


def chosen_side_by_side(detector, experiments):
    """Effects with their strengths, and the random numbers that follow, of experiments (kind, case, form, seed) at one bench, whose
    searches go on side by side; in the place of one that finds none its ValueError."""
    randoms = [random_of(seed, case, form, detector.level) for _, case, form, seed in experiments]
    forms = [hidden_forms(kind, case, form) for kind, case, form, _ in experiments]
    found = side_by_side(detector.bench, [choosing(detector, some, rng) for some, rng in zip(forms, randoms)])
    return [one if isinstance(one, ValueError) else (one, rng) for one, rng in zip(found, randoms)]


def make(folder, kind, case, form=None, level=0.02, seed=17, multiple=None, size="full", detector=None, under=(), known=None):
    """Writes the experiment and returns the truth; `under` are conditions of a traverse, `known` an entry of `chosen_side_by_side`.

    `level` 0 gives clean signals: those conditions that disturb the record (soil_scatter, gps, gaps) are then left out.
    """
    folder = pathlib.Path(folder)
    poor = case == "poor"
    bench = detector.bench if detector else make_bench(kind, seed, size, poor, under)
    replicates = 1 if case in ("noise_half", "noise_double") else REPLICATES if kind == cases.WHEEL else bench.replicates
    if isinstance(known, ValueError):
        raise known
    chosen, rng = known or (None, random_of(seed, case, form, level))
    forms = hidden_forms(kind, case, form)
    if any(f.jointed for f in forms) and not bench.jointed:
        raise SystemExit(f"{case}: this rover has no joints; they come with --condition rocker_bogie")
    if case == "poor":
        forms = [cases.find(kind, "slip_sinkage")]
    strengths = {}
    if forms:
        detector = detector or Detector(bench, level or 0.02, replicates, cases.library(kind, bench.jointed))
        chosen = alone(detector.bench, choosing(detector, forms, rng, multiple)) if chosen is None else chosen
        strengths = {f.key: strength for f, strength, _ in chosen}
    nothing_hidden, *hiding = bench.simulate([{}, strengths] if strengths else [{}])
    clean = hiding[0] if hiding else nothing_hidden
    if not np.all(np.isfinite(nothing_hidden)) or not np.all(np.isfinite(clean)):
        raise ValueError(f"{case}: the rig does not run with {strengths}")
    # The noise of the sensors does not depend on what is hidden: what an effect adds to a signal makes it no noisier.
    deviation = level * bench.size(nothing_hidden)
    groups, rows, signals = clean.shape
    error = noises.draw(rng, groups * replicates, rows, signals) * deviation
    runs = [(g, r, clean[g] + error[g * replicates + r]) for g in range(groups) for r in range(replicates)]
    if bench.conditions and level:
        runs = under_conditions(bench, runs, error, strengths, replicates, np.random.default_rng([seed, 6]))
    folder.mkdir(parents=True, exist_ok=True)
    truth = {
        "kind": kind,
        "case": case,
        "size": size,
        "noise": level,
        "seed": seed,
        "effects": describe(chosen) if chosen else [],
        "soil": {f"soil.{name}": value for name, value in bench.soil.items()},
        "soil_name": bench.soil_name,
        "deviation": dict(zip(bench.signals, map(float, np.hypot(deviation, bench.own_noise)))),
    }
    if bench.conditions:
        truth["conditions"] = list(bench.conditions)
    write_settings(folder, bench, truth, case, rng, bench.write(folder, runs))
    text = json.dumps(truth, indent=1, sort_keys=True)
    (folder / "truth.json").write_text(text + "\n", encoding="ascii", newline="\n")
    return truth


def under_conditions(bench, runs, error, strengths, replicates, rng):
    """The runs as the conditions of the bench leave them: their own soil, noise of single sensors, empty cells."""
    groups = len(bench.set_points)
    other = [conditions.scattered(bench.soil, groups, rng, bench.conditions) for _ in range(replicates)]
    if any(other):
        clean = bench.simulate([{**strengths, **soil} for soil in other])
        if not np.all(np.isfinite(clean)):
            raise ValueError("the rig does not run on the soil of every run")
        runs = [(g, r, clean[r, g] + error[g * replicates + r]) for g in range(groups) for r in range(replicates)]
    changed = []
    for group, replicate, signals in runs:
        signals = signals + bench.own_noise * rng.standard_normal(signals.shape)
        changed.append((group, replicate, np.where(conditions.kept(signals.shape, rng, bench.conditions), signals, np.nan)))
    return changed


def write_settings(folder, bench, truth, case, rng, run_lines):
    parameters, priors, stated = dict(bench.parameters()), {}, {}
    if case == "wrong_prior":
        # A separate test of a soil parameter that is off by five of its own standard deviations.
        name = str(rng.choice(["soil.friction_angle", "soil.cohesion", "soil.exponent"]))
        true = truth["soil"][name]
        share = {"soil.friction_angle": 0.03, "soil.cohesion": 0.1, "soil.exponent": 0.03}[name]
        sign = float(rng.choice([-1.0, 1.0]))
        parameters[name], priors[name] = true * (1.0 + 5.0 * sign * share), true * share
        truth["wrong_prior"] = {"parameter": name, "deviations": 5.0 * sign}
    factor = {"noise_half": 0.5, "noise_double": 2.0}.get(case)
    if factor:
        stated = {name: factor * value for name, value in truth["deviation"].items()}
    lines = [f'name = "seed {truth["seed"]}"', f'kind = "{bench.kind}"']
    lines += [f'model = "{bench.model}"'] if bench.model else []
    lines += ["", "[parameters]"]
    lines += [f'"{name}" = {value!r}' for name, value in parameters.items()]
    for title, table in (("priors", priors), ("noise", stated)):
        if table:
            lines += ["", f"[{title}]"] + [f'"{name}" = {float(f"{value:.6g}")!r}' for name, value in table.items()]
    text = "\n".join(["# Made by tests/generators/hidden.py; do not edit."] + lines + run_lines)
    (folder / "experiment.toml").write_text(text + "\n", encoding="ascii", newline="\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", choices=(cases.WHEEL, cases.ROVER), default=cases.WHEEL)
    parser.add_argument("--case", default="clean", help="an effect, two joined by +, clean, wrong_prior, noise_half, noise_double, poor")
    parser.add_argument("--form", help="form of the effect(s), joined by + for a pair; default: the library's")
    parser.add_argument("--noise", type=float, default=0.02, help="share of a signal's RMS; 0 is none")
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--multiple", type=float, help="of the smallest detectable strength; default: drawn, at least 1.5")
    parser.add_argument("--size", choices=("full", "long", "reduced"), default="full", help="of a traverse experiment: 18 runs of 24 s at 5 Hz, of 30 s at 10 Hz, 8 of 9 s")
    parser.add_argument("--condition", action="append", default=[], help=f"of a traverse, may be repeated: {', '.join(conditions.CONDITIONS)}")
    parser.add_argument("folder", metavar="FOLDER")
    a = parser.parse_args()
    level = conditions.noise(a.condition, a.noise)
    truth = make(a.folder, a.kind, a.case, a.form, level, a.seed, a.multiple, a.size, under=a.condition)
    for effect in truth["effects"]:
        seen = "" if effect["visible"] else " (this experiment cannot see it)"
        print(f"{effect['case']}.{effect['form']} = {effect['strength']:.4g}: {effect['deviations']:.1f} deviations{seen}")


if __name__ == "__main__":
    main()
