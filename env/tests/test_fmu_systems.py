"""FMUs together: the thesis's chapter 4 by hand, an SSP package, and the files of the cross-check.

See `fmus.py` for BEKKER_CLI.
"""

import shutil
from pathlib import Path

import fmpy
import numpy as np
from fmpy.ssp.simulation import simulate_ssp
from fmus import Make, load, make  # noqa: F401


def test_agreement_of_cross_check_files_with_the_other_version(make: Make, tmp_path: Path) -> None:
    cross_check = load("fmu/scripts/cross_check.py")
    for model in ("two_wheeled", "gentle_rtc"):
        base = cross_check.write(make(model, 3), tmp_path)
        reference = fmpy.util.read_csv(f"{base}_ref.csv")
        assert Path(f"{base}_ref.csv").stat().st_size < 1_000_000
        assert '"wheel[1].slip"' in Path(f"{base}_ref.csv").read_text().splitlines()[0]
        again = cross_check.rerun(base, make(model, 2))
        for name in reference.dtype.names:
            # The file has the digits that FMPy writes, fifteen or more.
            np.testing.assert_allclose(again[name], reference[name], rtol=1e-12, atol=1e-14)
        assert reference["x"][-1] > 0.05


def test_agreement_of_chapter_4_by_hand_with_the_closed_loop(make: Make, tmp_path: Path) -> None:
    """A second of the example's co-simulation: the controller first, and both by the control period."""
    chapter4 = load("examples/fmpy_chapter4.py")
    for kind in ("rover", "controller"):
        shutil.copy(make("gentle_rtc", 2, kind), tmp_path / f"gentle_rtc_{kind}.fmu")
    chapter4.TIME_LIMIT = 1.0
    drive = chapter4.drive(tmp_path, "gentle_rtc", 0.01, chapter4.SPEED)
    closed = chapter4.Part(make("gentle_rtc", 2, "closed-loop"), "whole", {"soil.shear_modulus": 0.01})
    closed.set({"velocity_command": chapter4.SPEED})
    closed.fmu.doStep(0.0, 1.0)
    x, heat = closed.get(["x", "dissipated_energy"])
    closed.free()
    assert (drive.speed, drive.power) == (x / 1.0, heat / 1.0) and x > 0.05


def test_agreement_of_the_system_with_its_parts(make: Make, tmp_path: Path) -> None:
    """FMPy runs the SSP package: all parts step, then values go along the wires. The same by hand gives the same bits."""
    step, count = 0.01, 100
    result = simulate_ssp(
        make("gentle_rtc", 2, None, "ssp", system_inputs=True),
        stop_time=count * step - 0.5 * step,
        step_size=step,
        input={"velocity_command": lambda _: 0.25},
    )
    chapter4 = load("examples/fmpy_chapter4.py")
    rover, controller = (chapter4.Part(make("gentle_rtc", 2, kind), kind, {}) for kind in ("rover", "controller"))
    measured = [name for name in controller.inputs if name != "velocity_command"]
    sources = [f"measured.{name}" if f"measured.{name}" in rover.references else name for name in measured]
    torques = [f"wheel[{k}].torque_command" for k in (1, 2)]
    seen, told, time = dict.fromkeys(measured, 0.0), dict.fromkeys(torques, 0.0), 0.0
    places = []
    for _ in range(count):
        # FMPy brings the system's own inputs along the wires after the first step, as all others.
        controller.set({"velocity_command": 0.25 if time > 0.0 else 0.0, **seen})
        controller.fmu.doStep(time, step)
        rover.set(told)
        rover.fmu.doStep(time, step)
        seen = dict(zip(measured, rover.get(sources), strict=True))
        told = dict(zip(torques, controller.get(torques), strict=True))
        places.append(rover.get(["x"])[0])
        time += step
    rover.free()
    controller.free()
    assert places[-1] > 0.05
    assert result["rover.x"].tolist() == places
