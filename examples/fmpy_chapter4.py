"""Chapter 4's comparison driven from FMPy alone: a rover's FMU and its controller's, co-simulated by hand.

Velocity control and rough-terrain control (RTC), by torques as in the thesis and by wheel speeds, drive the two-wheeled rover
over 5 m of gently rolling sand, on the stated soil (K = 30 mm) and a firmer one (K = 10 mm). Each drive is two FMUs of FMI 2.0, wired by the names of their
variables and stepped by the control period: the controller decides on what is measured, the rover moves on.

    python examples/fmpy_chapter4.py [--cli PATH] [--plot FILE]

needs FMPy and NumPy, for the FMUs the Python package `bekker` or, with --cli, the command line, and for --plot matplotlib.
"""

import argparse
import math
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave

LENGTH = 5.0  # of the course, m
TIME_LIMIT = 120.0  # s
SPEED = 0.25  # the thesis's: 2.5 rad/s at a radius of 0.1 m, m/s
WHEELS = (1, 2)


class Part:
    """An FMU in its simulation, read and set by name."""

    def __init__(self, fmu: Path, name: str, parameters: dict[str, float]) -> None:
        self.folder = fmpy.extract(str(fmu))
        description = fmpy.read_model_description(self.folder)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.inputs = [v.name for v in description.modelVariables if v.causality == "input"]
        self.step = float(description.defaultExperiment.stepSize)
        identifier = description.coSimulation.modelIdentifier
        self.fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName=name
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        self.set({name: value for name, value in parameters.items() if name in self.references})
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, values: dict[str, float]) -> None:
        self.fmu.setReal([self.references[name] for name in values], list(values.values()))

    def get(self, names: list[str]) -> list[float]:
        return list(self.fmu.getReal([self.references[name] for name in names]))

    def ended(self) -> bool:
        return int(self.fmu.getInteger([self.references["event"]])[0]) != 0

    def free(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


@dataclass
class Drive:
    """Means over a drive."""

    power: float  # in the windings (4.6), W
    electrical_power: float  # W
    energy_per_metre: float  # J/m
    slip: float
    speed: float  # m/s
    trace: dict[str, list[float]] = field(repr=False)  # by step: x (m), mean slip, torque of each wheel (N m), energy (J)


def drive(folder: Path, preset: str, shear_modulus: float, speed: float) -> Drive:
    """One drive over the course at a commanded speed, m/s."""
    parameters = {"soil.shear_modulus": shear_modulus}
    controller = Part(folder / f"{preset}_controller.fmu", "controller", parameters)
    rover = Part(folder / f"{preset}_rover.fmu", "rover", parameters)
    measured = [name for name in controller.inputs if name != "velocity_command"]
    # What sensors make of a signal, where the rover has them; else the signal.
    sources = [f"measured.{name}" if f"measured.{name}" in rover.references else name for name in measured]
    torques = [f"wheel[{k}].torque_command" for k in WHEELS]
    slips = [f"wheel[{k}].slip" for k in WHEELS]
    controller.set({"velocity_command": speed})
    (start,) = rover.get(["x"])
    watched = ["x", "electrical_energy", *slips, *torques]
    trace: dict[str, list[float]] = {name: [] for name in ("x", "slip", "rear", "front", "energy")}
    steps, x = 0, start
    while x - start < LENGTH and steps * controller.step < TIME_LIMIT and not rover.ended():
        time = steps * controller.step
        controller.set(dict(zip(measured, rover.get(sources), strict=True)))
        controller.fmu.doStep(time, controller.step)
        rover.set(dict(zip(torques, controller.get(torques), strict=True)))
        rover.fmu.doStep(time, controller.step)
        x, energy, rear_slip, front_slip, rear, front = rover.get(watched)
        row = (x - start, (rear_slip + front_slip) / 2.0, rear, front, energy)
        for column, value in zip(trace.values(), row, strict=True):
            column.append(value)
        steps += 1
    time = steps * controller.step
    heat, energy = rover.get(["dissipated_energy", "electrical_energy"])
    controller.free()
    rover.free()
    slip = sum(trace["slip"]) / steps
    return Drive(heat / time, energy / time, energy / (x - start), slip, (x - start) / time, trace)


def drive_at(folder: Path, preset: str, shear_modulus: float, wanted: float) -> Drive:
    """The drive whose mean speed is the wanted one to a thousandth, by the secant method on the command."""
    (a, there), b = (SPEED, drive(folder, preset, shear_modulus, SPEED)), wanted
    for _ in range(8):
        here = drive(folder, preset, shear_modulus, b)
        if math.isclose(here.speed, wanted, rel_tol=1e-3):
            return here
        a, b, there = b, b + (wanted - here.speed) * (b - a) / (here.speed - there.speed), here
    raise RuntimeError(f"{preset} does not reach {wanted} m/s")


def plot(drives: dict[str, Drive], file: str) -> None:
    """Slip, torques and energy along the course."""
    import matplotlib.pyplot as plt

    figure, (slip, torque, energy) = plt.subplots(3, 1, figsize=(7.5, 7.0), sharex=True, layout="constrained")
    for (label, drive), colour in zip(drives.items(), ("#c44e52", "#2b6ca3", "#7f7f7f"), strict=True):
        x = drive.trace["x"]
        slip.plot(x, [100.0 * value for value in drive.trace["slip"]], color=colour, label=label, linewidth=1.2)
        torque.plot(x, drive.trace["rear"], color=colour, linewidth=1.2)
        torque.plot(x, drive.trace["front"], color=colour, linewidth=1.2, linestyle=":")
        energy.plot(x, drive.trace["energy"], color=colour, linewidth=1.2)
    slip.set_ylabel("mean slip, %")
    slip.set_ylim(0.0, 100.0)
    slip.legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    torque.set_ylabel("torque, N m\nrear (line), front (dots)")
    energy.set_ylabel("electrical energy, J")
    energy.set_xlabel("way, m")
    for axes in (slip, torque, energy):
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(file, metadata={"Date": None} if file.endswith(".svg") else None)


def write_fmus(folder: Path, cli: str | None) -> None:
    """Rover and controller of both presets."""
    for preset in ("gentle_velocity", "gentle_rtc", "gentle_rtc_speed"):
        for kind in ("rover", "controller"):
            path = folder / f"{preset}_{kind}.fmu"
            if cli is not None:
                command = [cli, "fmu", preset, "--fmi", "2", "--kind", kind, "--output", str(path)]
                subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            else:
                import bekker

                bekker.export_fmu(preset, path, fmi=2, kind=kind)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cli", help="the program `bekker`, which makes the FMUs in place of the Python package")
    parser.add_argument("--plot", metavar="FILE", help="draws the drives on the stated soil")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_fmus(folder, arguments.cli)
        print(f"{'':36}{'windings, W':>12}{'electric, W':>12}{'J/m':>8}{'slip, %':>9}{'cm/s':>7}")
        for shear_modulus in (0.03, 0.01):
            velocity = drive(folder, "gentle_velocity", shear_modulus, SPEED)
            rtc = drive(folder, "gentle_rtc", shear_modulus, SPEED)
            equal = drive_at(folder, "gentle_velocity", shear_modulus, rtc.speed)
            speeds = drive(folder, "gentle_rtc_speed", shear_modulus, SPEED)
            equal_speeds = drive_at(folder, "gentle_velocity", shear_modulus, speeds.speed)
            soil = f"K = {1e3 * shear_modulus:.0f} mm"
            if arguments.plot and shear_modulus == 0.03:
                drives = {"velocity control": velocity, "RTC": rtc, "velocity control at RTC's speed": equal}
                plot(drives, arguments.plot)
            rows = [
                (f"velocity control, {soil}", velocity),
                (f"RTC by torques, {soil}", rtc),
                ("  velocity control at that speed", equal),
                (f"RTC by wheel speeds, {soil}", speeds),
                ("  velocity control at that speed", equal_speeds),
            ]
            for label, row in rows:
                print(
                    f"{label:36}{row.power:12.2f}{row.electrical_power:12.2f}{row.energy_per_metre:8.1f}"
                    f"{100 * row.slip:9.1f}{100 * row.speed:7.1f}"
                )


if __name__ == "__main__":
    main()
