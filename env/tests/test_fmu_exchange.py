"""Model exchange through FMPy's integrators: where they look, what they end in, and that co-simulation agrees.

See `fmus.py` for BEKKER_CLI.
"""

from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmus import VERSIONS, Make, make, write_fmu  # noqa: F401

# Torque of both wheels over time, N m, held or rising in between.
DRIVES = {
    "rest": [(0.0, 0.0), (1.0, 0.0)],
    "jump": [(0.0, 1.8), (1.0, 1.8)],
    "ramp": [(0.0, 0.0), (1.0, 2.0), (2.0, 2.0)],
    "reversal": [(0.0, 0.0), (0.5, 2.0), (1.0, -2.0), (1.5, -2.0), (2.0, 1.0)],
    "spin": [(0.0, 0.0), (0.2, 6.0), (0.6, 6.0)],
}
# On the Moon the ground drops by 5 cm, and both wheels leave it by more than 2 cm.
LEDGE = """name = "ledge"
preset = "two_wheeled"
[terrain]
preset = "step"
height = -0.05
length = 0.01
position = 1.0
[parameters]
gravity = 1.62
motor.inverse_voltage = 0.0
"""
OUTPUTS = ["x", "z", "pitch", "wheel[1].sinkage", "wheel[2].sinkage", "power", "wheel[1].torque", "wheel[2].current", "event"]
# Way by which the fixed step of 2 ms and an integrator of relative tolerance 1e-6 may differ, as a share of it; measured:
# 1.8 % where rims spin up to 20 m/s (without a supply limit), 0.8 % on a ramp and in reversals, 0.01 % under a held torque.
DIFFERENCE = 0.02
# The least way that the share belongs to, m.
LEAST = 0.05


def torques(rows: list[tuple[float, float]]) -> np.ndarray:
    names = ["time", "wheel[1].torque_command", "wheel[2].torque_command"]
    return np.array([(time, torque, torque) for time, torque in rows], dtype=[(name, float) for name in names])


def simulate(fmu: str, rows: list[tuple[float, float]], kind: str, **options: Any) -> np.ndarray:
    options = {"output_interval": 0.01, "record_events": False, **options}
    return fmpy.simulate_fmu(fmu, stop_time=rows[-1][0], input=torques(rows), output=OUTPUTS, fmi_type=kind, **options)


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("fmi", VERSIONS)
def test_agreement_of_cvode_with_co_simulation(make: Make, fmi: int, drive: str) -> None:
    fmu, rows = make("two_wheeled", fmi, "rover"), DRIVES[drive]
    steps = simulate(fmu, rows, "CoSimulation")
    solver = simulate(fmu, rows, "ModelExchange", solver="CVode", relative_tolerance=1e-6)
    assert len(steps) == len(solver) and solver["time"][-1] == pytest.approx(rows[-1][0])
    assert (solver["event"] == 0).all()
    way = max(np.ptp(steps["x"]), LEAST)
    assert np.abs(solver["x"] - steps["x"]).max() < DIFFERENCE * way
    assert np.abs(solver["pitch"] - steps["pitch"]).max() < 1e-3
    # At the start both have what the first torque gives, to the last bit.
    for name in ("power", "wheel[1].torque", "wheel[2].current"):
        assert solver[name][0] == steps[name][0]
        assert (steps[name][0] != 0.0) == (rows[0][1] != 0.0)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_property_solvers_follow_wheels_that_leave_the_ground(tmp_path: Path, fmi: int) -> None:
    model, fmu = tmp_path / "ledge.toml", tmp_path / "ledge.fmu"
    model.write_text(LEDGE)
    write_fmu(str(model), fmu, fmi, "rover")
    rows = [(0.0, 0.6), (4.0, 0.6)]
    steps = simulate(str(fmu), rows, "CoSimulation")
    solver = simulate(str(fmu), rows, "ModelExchange", solver="CVode", relative_tolerance=1e-6)
    # Rims in the air turn faster than on the ground, so that Euler's method needs smaller steps.
    euler = simulate(str(fmu), rows, "ModelExchange", solver="Euler", output_interval=5e-5, step_size=5e-5)
    for result in (steps, solver, euler):
        assert result["wheel[1].sinkage"].min() < -0.02 and result["wheel[2].sinkage"].min() < -0.02
    assert np.abs(solver["x"] - steps["x"]).max() < DIFFERENCE * np.ptp(steps["x"])
    assert euler["x"][-1] == pytest.approx(solver["x"][-1], rel=0.01)


@pytest.mark.parametrize("drive", ["rest", "ramp", "reversal"])
@pytest.mark.parametrize("fmi", VERSIONS)
def test_agreement_of_euler_with_cvode_at_its_largest_step(make: Make, fmi: int, drive: str) -> None:
    """FMPy's Euler makes steps of the output interval. 0.2 ms serves up to a rim of 5 m/s."""
    fmu, rows = make("two_wheeled", fmi, "rover"), DRIVES[drive]
    solver = simulate(fmu, rows, "ModelExchange", solver="CVode", relative_tolerance=1e-6)
    euler = simulate(fmu, rows, "ModelExchange", solver="Euler", output_interval=2e-4, step_size=2e-4)
    assert euler["x"][-1] == pytest.approx(solver["x"][-1], rel=0.01, abs=0.01 * LEAST)


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("step", [1e-3, 2e-3, 1e-2])
def test_property_euler_with_too_large_a_step_ends_with_an_error(
    make: Make, capfd: pytest.CaptureFixture[str], fmi: int, step: float
) -> None:
    with pytest.raises(FMICallException, match="CompletedIntegratorStep"):
        fmu = make("two_wheeled", fmi, "rover")
        simulate(fmu, DRIVES["ramp"], "ModelExchange", solver="Euler", output_interval=step, step_size=step)
    said = capfd.readouterr().out
    assert "does not follow the equations" in said and "implicit method" in said
