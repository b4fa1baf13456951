#!/usr/bin/env python3
"""Beside the trade: lmfit with AIC and BIC over the same model, and `bekker.diagnose`, on the same measurements.

    python3 tests/study/trade.py --clean 50 --out trade.csv

Three cases of the generator of single-wheel experiments, each on one unseen seed (a hidden slip-sinkage, a hidden
Coulomb friction, and a hump that no effect of the library has), and sets in which nothing is hidden. lmfit's `leastsq` fits the soil alone and with each effect
of the library that a wheel on a carriage shows, with the noise of each signal from the repeats, rows taken as independent, bounds as
in the vocabulary; the least AIC, and the least BIC, names the effect or none. This is what a careful user of these tools does: the
physics is ours in both. The generator's noise has a part that a run shares and neighbours that resemble each other, which our noise
model has and the criteria do not; `--independent` gives every row noise of its own, as they assume. Prints what each concludes and the share of false alarms with 95 % intervals. What has a row in the
output is not made again. Needs numpy, lmfit and the package bekker.
"""

import argparse
import csv
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "generators"))

import bekker  # noqa: E402
import hidden  # noqa: E402
import lmfit  # noqa: E402
from bench_wheel import WheelBench  # noqa: E402
from table import wilson  # noqa: E402

SEED = 120000
NOISE = 0.02
CASES = ("slip_sinkage", "coulomb_friction", "hump")
SOIL = {  # start, bounds
    "soil.cohesion": (1000.0, 0.0, 5000.0),
    "soil.friction_angle": (0.5, 0.0, 0.8),
    "soil.k_phi": (850e3, 1e4, 1e8),
    "soil.exponent": (1.0, 0.3, 1.5),
    "soil.shear_modulus": (0.03, 0.001, 0.1),
    "soil.c1": (0.4, 0.0, 0.6),
    "soil.c2": (0.2, 0.0, 0.5),
}
UNANSWERED = 1e3  # standard deviations by which a row counts as missed where the model has no answer
COLUMNS = ("name", "hidden", "aic", "bic", "bekker", "seconds_lmfit", "seconds_bekker")


class Measured:
    """Repeats of every set-point of an experiment folder, and the noise that they tell."""

    def __init__(self, folder, rig):
        self.rig, runs = rig, {}
        for path in sorted((folder / "runs").glob("*.csv")):
            with open(path, newline="") as file:
                rows = list(csv.DictReader(file))
            label = path.stem.rsplit("_", 1)[0]
            runs.setdefault(label, []).append({name: np.array([float(row[name]) for row in rows]) for name in rows[0]})
        groups = list(runs.values())
        self.points = {name: np.concatenate([group[0][name] for group in groups]) for name in ("load", "slip", "wheel_speed")}
        # (repeat, point) for each signal
        self.values = {s: np.stack([np.concatenate([g[k][s] for g in groups]) for k in range(len(groups[0]))]) for s in WheelBench.signals}
        self.noise = {s: float(np.sqrt(np.mean(v.var(axis=0, ddof=1)))) for s, v in self.values.items()}
        self.count = sum(v.size for v in self.values.values())

    def residual(self, parameters):
        """Measured minus modelled over the noise; large where the soil does not carry the wheel."""
        values = self.rig | {p.name.replace("__", "."): p.value for p in parameters.values()}
        if not np.all(np.isfinite(list(values.values()))):
            return np.full(self.count, UNANSWERED)
        try:
            modelled = bekker.steady_points("two_wheeled", *self.points.values(), values)
        except bekker.BekkerError:
            return np.full(self.count, UNANSWERED)
        all_signals = np.concatenate([((v - modelled[s]) / self.noise[s]).ravel() for s, v in self.values.items()])
        return np.where(np.isfinite(all_signals), all_signals, UNANSWERED)


def fitted(measured, start, effect):
    """lmfit's result for the soil and the parameters of one effect (name, start, bounds)."""
    parameters = lmfit.Parameters()
    for name, (value, low, high) in {**start, **effect}.items():
        parameters.add(name.replace(".", "__"), value=value, min=low, max=high)
    return lmfit.minimize(measured.residual, parameters, method="leastsq", max_nfev=2000)


def by_criteria(measured, effects):
    """The effect (or `none`) with the least AIC, and with the least BIC."""
    base = fitted(measured, SOIL, {})
    soil = {name: (base.params[name.replace(".", "__")].value, low, high) for name, (_, low, high) in SOIL.items()}
    scores = {}
    for name, effect in {"none": {}, **effects}.items():
        found = base if name == "none" else fitted(measured, soil, effect)
        chi_square, free = float(np.sum(found.residual**2)), len(found.params)
        scores[name] = (chi_square + 2 * free, chi_square + free * np.log(measured.count))
    return [min(scores, key=lambda name, k=k: scores[name][k]) for k in range(2)]


def concluded(found):
    """What a diagnosis says, in the words of the table."""
    if found.verdict == "explained":
        return "none"
    if found.verdict == "effect_missing":
        return "+".join(found.effects)
    return f"{found.verdict}: {'+'.join(found.effects or found.tied)}".rstrip(": ")


def row(case, seed):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        hidden.make(folder, "single_wheel", case, level=NOISE, seed=seed)
        began = time.monotonic()
        found = bekker.diagnose(folder)
        took = time.monotonic() - began
        measured = Measured(folder, WheelBench(seed).parameters())
    # A little off the neutral value: on it some parameters show nothing.
    effects = {
        candidate.effect: {
            p.name: (0.05 * p.max if p.min >= 0.0 else 0.02 * p.max, p.min, p.max) for p in candidate.parameters
        }
        for candidate in found.candidates
        if candidate.parameters
    }
    began = time.monotonic()
    aic, bic = by_criteria(measured, effects)
    lmfit_took = time.monotonic() - began
    return dict(zip(COLUMNS, (f"{case}_{seed}", case, aic, bic, concluded(found), f"{lmfit_took:.1f}", f"{took:.1f}")))


def report(rows):
    lines = ["| hidden | lmfit, least AIC | lmfit, least BIC | bekker |", "|---|---|---|---|"]
    lines += [f"| {r['hidden']} | {r['aic']} | {r['bic']} | {r['bekker']} |" for r in rows if r["hidden"] != "clean"]
    clean = [r for r in rows if r["hidden"] == "clean"]
    if clean:
        alarms = []
        for tool in ("aic", "bic", "bekker"):
            count = sum(r[tool] != "none" for r in clean)
            low, high = wilson(count, len(clean))
            alarms.append(f"{count} of {len(clean)} ({100 * low:.0f} to {100 * high:.0f} %)")
        lines.append(f"| nothing: false alarms | {' | '.join(alarms)} |")
    total = [sum(float(r[name]) for r in rows) for name in ("seconds_lmfit", "seconds_bekker")]
    return "\n".join([*lines, "", f"{total[0]:.0f} s with lmfit, {total[1]:.0f} s with bekker, of {len(rows)} sets"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clean", type=int, default=50, help="sets in which nothing is hidden")
    parser.add_argument("--independent", action="store_true", help="noise of every row by itself, as the criteria assume; sets without a hidden effect only")
    parser.add_argument("--out", type=Path, default=Path("trade.csv"))
    a = parser.parse_args()
    rows = list(csv.DictReader(open(a.out, newline=""))) if a.out.exists() else []
    done = {r["name"] for r in rows}
    wanted = [(case, SEED) for case in CASES if not a.independent] + [("clean", SEED + k) for k in range(a.clean)]
    if a.independent:
        hidden.noises.draw = lambda rng, *shape: rng.standard_normal(shape)
    with open(a.out, "a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        if not rows:
            writer.writeheader()
        for case, seed in wanted:
            if f"{case}_{seed}" not in done:
                rows.append(row(case, seed))
                writer.writerow(rows[-1])
                file.flush()
                print(*rows[-1].values(), flush=True)
    print(report(rows))


if __name__ == "__main__":
    main()
