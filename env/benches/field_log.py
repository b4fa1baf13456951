"""A diagnosis of a rover's log from beginning to end, beside SciPy's calibration of the baseline alone around the FMU, in one run.

    python env/benches/field_log.py [--case drag] [--seed 1000] [--size long]

The log is made by `tests/generators`: 18 runs of 30 s at 10 Hz (six different ones, each three times) over three grounds, 2 % noise,
with something hidden. `bekker.diagnose` estimates the noise, calibrates the seven parameters of the soil, fits 22 effects as far as they
promise anything, pairs too, judges left-out runs, plans the next experiment, on all cores. SciPy's `least_squares` (trf, forward
differences) fits the same seven parameters only, once, from the same start, with the noise given, to the same rows; it simulates each
different run once, on as many processes as there are cores, one FMU a ground, stepped through FMPy call by call. Times are wall-clock.
Needs numpy, scipy and fmpy.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import bekker
import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from scipy.optimize import least_squares

GENERATOR = Path(__file__).resolve().parents[2] / "tests/generators/hidden.py"
SOIL = ("cohesion", "friction_angle", "k_phi", "exponent", "shear_modulus", "c1", "c2")
MISSED = (
    1e3  # standard deviations by which a run counts as missed that cannot be driven
)


def table(file):
    with open(file, encoding="ascii") as lines:
        rows = list(csv.reader(lines))
    return {
        name: np.array([float(row[k] or "nan") for row in rows[1:]])
        for k, name in enumerate(rows[0])
    }


class Drives:
    """The different runs of a log, replayed through FMUs by one process."""

    def __init__(self, folder, fmus, noise):
        entries = tomllib.loads((folder / "experiment.toml").read_text())["run"]
        groups = {}
        for entry in entries:
            groups.setdefault(entry["group"], []).append(entry)
        self.runs = [
            (runs[0], [table(folder / run["file"]) for run in runs])
            for runs in groups.values()
        ]
        self.noise = noise
        self.slaves, self.references = {}, {}
        for ground, fmu in fmus.items():
            unzipped = fmpy.extract(str(fmu))
            description = fmpy.read_model_description(unzipped)
            slave = FMU3Slave(
                guid=description.guid,
                unzipDirectory=unzipped,
                modelIdentifier=description.coSimulation.modelIdentifier,
                instanceName="rover",
            )
            slave.instantiate()
            self.slaves[ground] = slave
            self.references = {
                variable.name: variable.valueReference
                for variable in description.modelVariables
            }

    def residuals(self, k, values):
        """Whitened residuals of all repeats of different run number `k`."""
        entry, repeats = self.runs[k]
        slave, refer = self.slaves[entry["terrain"]], self.references
        parameters = (
            dict(zip([f"soil.{name}" for name in SOIL], values, strict=True))
            | {"rover.mass": 10.0}
            | entry.get("parameters", {})
        )
        speeds = [name for name in repeats[0] if name.endswith(".speed_command")]
        measured = [name for name in repeats[0] if name in self.noise]
        inputs = np.array([repeats[0][name] for name in speeds]).T
        at = repeats[0]["time"]
        modelled = np.full((len(at), len(measured)), np.nan)
        slave.reset()
        slave.setFloat64(
            [refer[name] for name in parameters],
            [float(value) for value in parameters.values()],
        )
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        try:
            for row, now in enumerate(at):
                modelled[row] = slave.getFloat64([refer[name] for name in measured])
                slave.setFloat64([refer[name] for name in speeds], list(inputs[row]))
                if row + 1 < len(at):
                    slave.doStep(float(now), float(at[row + 1] - now))
        except FMICallException:
            pass  # stuck: the rest of its rows is missed
        weights = np.array([self.noise[name] for name in measured])
        every = [
            (modelled - np.array([repeat[name] for name in measured]).T) / weights
            for repeat in repeats
        ]
        return np.nan_to_num(np.concatenate(every), nan=MISSED).ravel()


drives = None


def begin(*given):
    global drives
    drives = Drives(*given)


def replay(task):
    return drives.residuals(*task)


def fmu_of(folder, ground, path):
    model = bekker.Model.from_preset("two_wheeled_speed")
    points = table(folder / ground)
    model.set_terrain(json.dumps({"x": list(points["x"]), "z": list(points["z"])}))
    bekker.export_fmu(model, path)


def peer(folder, scratch, noise, bounds, start):
    """Seconds and drives of SciPy's fit, and its weighted squares a row."""
    grounds = sorted(
        {
            run["terrain"]
            for run in tomllib.loads((folder / "experiment.toml").read_text())["run"]
        }
    )
    fmus = {ground: scratch / f"{k}.fmu" for k, ground in enumerate(grounds)}
    for ground, path in fmus.items():
        fmu_of(folder, ground, path)
    runs = len(
        {
            run["group"]
            for run in tomllib.loads((folder / "experiment.toml").read_text())["run"]
        }
    )
    count = 0
    with ProcessPoolExecutor(
        os.cpu_count(), initializer=begin, initargs=(folder, fmus, noise)
    ) as pool:

        def residuals(values):
            nonlocal count
            count += runs
            return np.concatenate(
                list(pool.map(replay, [(k, values) for k in range(runs)]))
            )

        residuals(start)  # the processes are up
        clock, count = time.perf_counter(), 0
        low, high = np.array(bounds).T
        solution = least_squares(
            residuals, start, bounds=(low, high), x_scale=high - low, diff_step=1e-6
        )
    return time.perf_counter() - clock, count, 2.0 * solution.cost / len(solution.fun)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--case", default="drag")
    parser.add_argument("--seed", default="1000")
    parser.add_argument("--size", default="long")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        folder = scratch / "log"
        make = [
            sys.executable,
            GENERATOR,
            "--kind",
            "traverse",
            "--size",
            asked.size,
            "--case",
            asked.case,
            "--seed",
            asked.seed,
            folder,
        ]
        subprocess.run(make, check=True)
        clock = time.perf_counter()
        found = bekker.diagnose(folder)
        ours = time.perf_counter() - clock
        free = {parameter.name: parameter for parameter in found.steps[0].parameters}
        bounds = [(free[f"soil.{name}"].min, free[f"soil.{name}"].max) for name in SOIL]
        start = [free[f"soil.{name}"].start for name in SOIL]
        theirs, count, squares = peer(folder, scratch, found.noise_floor, bounds, start)
    print(f"{'':<46}{'s':>8}")
    print(
        f"{'bekker.diagnose, everything':<46}{ours:>8.1f}  {found.verdict}: {', '.join(found.effects)}"
    )
    print(
        f"{'SciPy around the FMU, one baseline fit':<46}{theirs:>8.1f}  {count} drives, {squares:.2f} weighted squares a value"
    )
    print(f"{'ratio':<46}{theirs / ours:>8.2f}")


if __name__ == "__main__":
    main()
