"""The improved model of a diagnosis shows the smaller error in other doors too: effects live in the physics."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from stepped_fmu import Slave

import bekker

PERIOD = 0.1
TIME = PERIOD * np.arange(41)
# What the rover that was "measured" has and the model has not: dry friction of the drives, N m at the wheel.
HIDDEN = 0.2
# Noise of the torques (N m), the pitch (rad) and the sinkages (m).
NOISE = {"wheel[1].torque": 0.01, "wheel[2].torque": 0.01, "pitch": 0.0005, "wheel[1].sinkage": 1e-4, "wheel[2].sinkage": 1e-4}
# Sand on which the rover drives at moderate slip; the calibration starts from the thesis's.
SOIL = {"soil.shear_modulus": 0.012, "soil.friction_angle": 0.54}


def commands(forward: float) -> np.ndarray:
    """Wheel speeds, rad/s: on, then slower, then back."""
    return np.where(TIME < 1.5, forward, np.where(TIME < 2.5, 0.4 * forward, -forward))


def driven(model: bekker.Model, forward: float) -> dict[str, np.ndarray]:
    run = model.start()
    at = [run.signal_names.index(name) for name in NOISE]
    steps = round(PERIOD / run.step_size)
    rows = []
    for command in commands(forward):
        rows.append(run.signals()[at])
        run.step([command, command], steps)
    return dict(zip(NOISE, np.array(rows).T, strict=True))


@pytest.fixture(scope="module")
def experiment() -> bekker.Experiment:
    rng = np.random.default_rng(7)
    truth = bekker.Model.from_preset("two_wheeled_speed")
    for name, value in {**SOIL, "coulomb_friction.torque": HIDDEN}.items():
        truth.set(name, value)
    runs = []
    for forward in (1.5, 3.0):
        clean = driven(truth, forward)
        for repeat in "ab":
            data = {"time": TIME, **{f"wheel[{k}].speed_command": commands(forward) for k in (1, 2)}}
            data |= {name: values + NOISE[name] * rng.standard_normal(len(TIME)) for name, values in clean.items()}
            runs.append(bekker.MeasuredRun(data, f"{forward}{repeat}", group=str(forward)))
    return bekker.Experiment("traverse", runs, "reversals")


def error_of_fmu(model: bekker.Model, experiment: bekker.Experiment, folder: Path) -> dict[str, float]:
    """RMS of measured minus what the model's FMU computes when FMPy steps it, by signal."""
    bekker.export_fmu(model, folder / "rover.fmu")
    squares: dict[str, list[NDArray[np.float64]]] = {name: [] for name in NOISE}
    for number, run in enumerate(experiment.runs):
        fmu = Slave(folder / "rover.fmu", folder / str(number))
        fmu.start()
        for row, (time, command) in enumerate(zip(TIME, run.data["wheel[1].speed_command"], strict=True)):
            for name, value in zip(NOISE, fmu.get(*NOISE), strict=True):
                squares[name].append((run.data[name][row] - value) ** 2)
            # A command holds until the next row.
            fmu.set(**{f"wheel[{k}].speed_command": command for k in (1, 2)})
            fmu.fmu.doStep(time, PERIOD)
        fmu.free()
    return {name: float(np.sqrt(np.mean(values))) for name, values in squares.items()}


def test_agreement_the_named_effect_lowers_the_error_through_the_fmu(experiment, tmp_path) -> None:
    found = bekker.diagnose(experiment, "two_wheeled_speed", candidates=["coulomb_friction", "drag"], draws=199)
    assert (found.verdict, found.effects) == ("effect_missing", ["coulomb_friction"])
    friction = next(p for p in found.steps[-1].parameters if p.name == "coulomb_friction.torque")
    assert abs(friction.value - HIDDEN) < 4.0 * friction.deviation
    without = bekker.calibrate(experiment, "two_wheeled_speed").model
    before, after = (error_of_fmu(model, experiment, tmp_path) for model in (without, found.improved))
    for name in ("wheel[1].torque", "wheel[2].torque"):
        # 164 values: their RMS scatters by 6 % about the noise.
        assert after[name] < 1.2 * NOISE[name] < before[name], (name, before, after)
