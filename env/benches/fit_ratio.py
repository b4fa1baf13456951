"""The baseline calibration of a traverse, beside the same fit by SciPy around the FMU, in the same run.

    python env/benches/fit_ratio.py

Both fit the same free parameters within the same bounds to the same four runs of four seconds, on one thread, by plain least
squares, in the same way: twice, the second time with the noise floor that the first time gave, and each time with searches
from the given values and from the best of eight draws. `bekker.calibrate` has exact derivatives; SciPy's `least_squares`
(trf, forward differences) steps the exported FMU through FMPy call by call, one instance that is reset before every drive,
and is given the weights. One search of SciPy's alone is shown too. Times are CPU time. Needs scipy and fmpy.
"""

import os

os.environ.setdefault("RAYON_NUM_THREADS", "1")

import tempfile
import time
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from numpy.typing import NDArray
from scipy.optimize import least_squares

import bekker

PERIOD = 0.1
TIME = PERIOD * np.arange(41)
# What was "measured" has this soil; the fit starts from the preset's.
SOIL = {"soil.shear_modulus": 0.012, "soil.friction_angle": 0.54}
# Noise of the torques (N m), the pitch (rad) and the sinkages (m).
NOISE = {"wheel[1].torque": 0.01, "wheel[2].torque": 0.01, "pitch": 0.0005, "wheel[1].sinkage": 1e-4, "wheel[2].sinkage": 1e-4}
ROUNDS = 2


def commands(forward: float) -> NDArray[np.float64]:
    """Wheel speeds, rad/s: on, then slower, then back."""
    return np.where(TIME < 1.5, forward, np.where(TIME < 2.5, 0.4 * forward, -forward))


def measured() -> bekker.Experiment:
    """Two drives, each twice, with white noise."""
    random = np.random.default_rng(7)
    truth = bekker.Model.from_preset("two_wheeled_speed")
    for name, value in SOIL.items():
        truth.set(name, value)
    runs = []
    for forward in (1.5, 3.0):
        run = truth.start()
        at = [run.signal_names.index(name) for name in NOISE]
        rows = []
        for command in commands(forward):
            rows.append(run.signals()[at])
            run.step([command, command], round(PERIOD / run.step_size))
        clean = dict(zip(NOISE, np.array(rows).T, strict=True))
        for repeat in "ab":
            data = {"time": TIME, **{f"wheel[{k}].speed_command": commands(forward) for k in (1, 2)}}
            data |= {name: values + NOISE[name] * random.standard_normal(len(TIME)) for name, values in clean.items()}
            runs.append(bekker.MeasuredRun(data, f"{forward}{repeat}", group=str(forward)))
    return bekker.Experiment("traverse", runs, "ratio")


class Peer:
    """The experiment as a user of FMPy and SciPy would replay it."""

    def __init__(self, experiment: bekker.Experiment, fmu: Path, folder: Path) -> None:
        self.experiment = experiment
        unzipped = fmpy.extract(str(fmu), unzipdir=str(folder))
        description = fmpy.read_model_description(unzipped)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.slave = FMU3Slave(
            guid=description.guid,
            unzipDirectory=unzipped,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="rover",
        )
        self.slave.instantiate()
        self.drives = 0

    def residuals(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([self.drive(run, values) for run in self.experiment.runs])

    def drive(self, run: bekker.MeasuredRun, values: NDArray[np.float64]) -> NDArray[np.float64]:
        self.drives += 1
        slave, refer = self.slave, self.references
        slave.reset()
        slave.setFloat64([refer[p.name] for p in self.free], list(values))
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        outputs = [refer[name] for name in NOISE]
        inputs = [refer[f"wheel[{k}].speed_command"] for k in (1, 2)]
        rows = []
        for time_now, command in zip(TIME, run.data["wheel[1].speed_command"], strict=True):
            rows.append(slave.getFloat64(outputs))
            slave.setFloat64(inputs, [command, command])
            slave.doStep(time_now, PERIOD)
        wanted = np.array([run.data[name] for name in NOISE]).T
        return ((np.array(rows) - wanted) / self.weights).ravel()

    def fit(self, calibration):
        self.free = calibration.parameters
        self.weights = [calibration.weights[name] for name in NOISE]
        """The best solution of the whole protocol, and the CPU time of its first search."""
        random = np.random.default_rng(1)
        low, high = (np.array([getattr(p, end) for p in self.free]) for end in ("min", "max"))
        given = np.clip([p.start for p in self.free], low, high)
        found, first = [], 0.0
        for _ in range(2):
            draws = [random.uniform(low, high) for _ in range(8)]
            for start in (given, min(draws, key=self.cost)):
                begin = time.process_time()
                found.append(
                    least_squares(self.residuals, start, bounds=(low, high), x_scale=high - low, diff_step=1e-6)
                )
                first = first or time.process_time() - begin
        return min(found, key=lambda solution: solution.cost), first

    def cost(self, values: NDArray[np.float64]) -> float:
        """Weighted squares; infinite where the rover cannot drive on such soil."""
        try:
            return float(np.sum(self.residuals(values) ** 2))
        except FMICallException:
            return float("inf")


def main() -> None:
    experiment = measured()
    ours, peers, singles = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        fmu = Path(folder) / "rover.fmu"
        bekker.export_fmu(bekker.Model.from_preset("two_wheeled_speed"), fmu)
        peer = Peer(experiment, fmu, Path(folder) / "unzipped")
        for _ in range(ROUNDS):
            begin = time.process_time()
            found = bekker.calibrate(experiment, "two_wheeled_speed")
            ours.append(time.process_time() - begin)
            begin = time.process_time()
            solution, first = peer.fit(found.calibration)
            singles.append(first)
            peers.append(time.process_time() - begin)
        values = np.array([p.value for p in found.calibration.parameters])
        cost = {"bekker": np.sum(peer.residuals(values) ** 2), "scipy": np.sum(peer.residuals(solution.x) ** 2)}
        peer.slave.freeInstance()
    print(f"{'':<34}{'CPU s':>8}  weighted squares of {len(solution.fun)} residuals")
    print(f"{'bekker.calibrate':<34}{min(ours):>8.2f}  {cost['bekker']:.1f}")
    print(f"{'scipy around the FMU':<34}{min(peers):>8.2f}  {cost['scipy']:.1f}  ({peer.drives // ROUNDS} drives)")
    print(f"{'  its first search':<34}{min(singles):>8.2f}")
    print(f"{'ratio':<34}{min(peers) / min(ours):>8.1f}")
    print(f"{'parameter':<24}{'bekker':>14}{'scipy':>14}")
    for parameter, value in zip(found.calibration.parameters, solution.x, strict=True):
        print(f"{parameter.name:<24}{parameter.value:>14.5g}{value:>14.5g}")


if __name__ == "__main__":
    main()
