"""The improved model of a diagnosis shows the smaller error in other doors too: effects live in the physics."""

from pathlib import Path

import fmpy
import numpy as np
import pytest

import bekker

TIME = np.arange(0.0, 4.05, 0.1)
# What the rover that was "measured" has and the model has not: dry friction of the drives, N m at the wheel.
HIDDEN = 0.12
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
    steps = round((TIME[1] - TIME[0]) / run.step_size)
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
    """RMS of measured minus what FMPy computes with the model's FMU, by signal."""
    fmu = folder / "rover.fmu"
    bekker.export_fmu(model, fmu)
    squares: dict[str, list[np.ndarray]] = {name: [] for name in NOISE}
    for run in experiment.runs:
        names = [f"wheel[{k}].speed_command" for k in (1, 2)]
        # A command holds until the next row.
        inputs = np.array(
            [(t, c, c) for t, c in zip(TIME, run.data[names[0]], strict=True)],
            dtype=[("time", float), *((name, float) for name in names)],
        )
        result = fmpy.simulate_fmu(
            str(fmu), stop_time=TIME[-1], step_size=0.01, output_interval=0.01, input=inputs, output=list(NOISE)
        )
        at = np.array([np.argmin(np.abs(result["time"] - t)) for t in TIME])
        for name in NOISE:
            # FMPy ramps inputs between rows, so rows next to a change of speed are left out.
            steady = np.abs(np.gradient(run.data[names[0]])) < 1e-9
            squares[name].append((np.asarray(run.data[name]) - result[name][at])[steady] ** 2)
    return {name: float(np.sqrt(np.mean(np.concatenate(all_runs)))) for name, all_runs in squares.items()}


def test_agreement_the_named_effect_lowers_the_error_through_the_fmu(experiment, tmp_path) -> None:
    found = bekker.diagnose(experiment, "two_wheeled_speed", candidates=["coulomb_friction", "drag"], draws=199)
    assert (found.verdict, found.effects) == ("effect_missing", ["coulomb_friction"])
    friction = next(p for p in found.steps[-1].parameters if p.name == "coulomb_friction.torque")
    assert abs(friction.value - HIDDEN) < 4.0 * friction.deviation
    without = bekker.calibrate(experiment, "two_wheeled_speed").model
    before, after = (error_of_fmu(model, experiment, tmp_path) for model in (without, found.improved))
    for name in ("wheel[1].torque", "wheel[2].torque"):
        # To the noise, give or take what FMPy's ramps leave.
        assert after[name] < 1.3 * NOISE[name] < before[name], (name, before, after)
