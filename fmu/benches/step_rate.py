#!/usr/bin/env python3
"""What a step of an FMU costs beside one of a minimal FMU, through C and through FMPy, in the same run.

    python fmu/benches/step_rate.py [--models two_wheeled,rocker_bogie,gentle_rtc] [--bekker target/release/bekker]

Needs FMPy, gcc, and the command line (`cargo build --release -p bekker-cli`). Each step sets the inputs and reads two
outputs. Steps of 2 ms make one inner step, steps of 20 ms ten; a tenth of their difference is one more inner step, and
what a step of 2 ms takes beyond that is the border: checks, locks, copies. CPU time of one core, the least of several
rounds. The minimal FMU (fmu/benches/minimal.c) does one multiplication a step.
"""

import argparse
import subprocess
import sys
import tempfile
import time
import uuid
import zipfile
from dataclasses import dataclass
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave

HERE = Path(__file__).resolve().parent
ROUNDS = 5
INNER = 0.002
SECONDS = 8.0  # simulated, a round

MINIMAL = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="minimal" guid="{guid}">
  <CoSimulation modelIdentifier="minimal"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="0" causality="output" variability="continuous"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>
"""


@dataclass
class Fmu:
    """An unpacked FMU and what a host sets and reads."""

    name: str
    folder: Path
    identifier: str
    guid: str
    inputs: list[int]
    command: float
    outputs: list[int]

    @property
    def library(self) -> Path:
        return self.folder / "binaries" / "linux64" / f"{self.identifier}.so"


def run(*command: object) -> str:
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def minimal(folder: Path) -> Fmu:
    guid = str(uuid.uuid4())
    place = folder / "minimal"
    (place / "binaries" / "linux64").mkdir(parents=True)
    (place / "modelDescription.xml").write_text(MINIMAL.format(guid=guid))
    run("gcc", "-O2", "-shared", "-fPIC", "-o", place / "binaries" / "linux64" / "minimal.so", HERE / "minimal.c")
    return Fmu("minimal", place, "minimal", guid, [], 0.0, [0, 0])


def rover(folder: Path, bekker: str, model: str) -> Fmu:
    path = folder / f"{model}.fmu"
    run(bekker, "fmu", model, "--fmi", "2", "--output", path)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder / model)
    description = fmpy.read_model_description(str(path))
    by_name = {v.name: v for v in description.modelVariables}
    inputs = [v for v in description.modelVariables if v.causality == "input"]
    # Half of what the thesis's rover needs on level ground, so that nothing ends the run; a velocity for controllers.
    command = 0.2 if inputs[0].name == "velocity_command" else 0.0
    outputs = [by_name[name].valueReference for name in ("x", "wheel[1].slip")]
    identifier = description.coSimulation.modelIdentifier
    references = [v.valueReference for v in inputs]
    return Fmu(model, folder / model, identifier, description.guid, references, command, outputs)


def through_c(host: Path, fmu: Fmu, step: float) -> tuple[float, float, float]:
    """Nanoseconds a step, to save a state, to restore it."""
    listed = [",".join(map(str, references)) for references in (fmu.inputs, fmu.outputs)]
    resources = (fmu.folder / "resources").as_uri()
    count = round(SECONDS / step)
    text = run(host, fmu.library, fmu.guid, resources, step, count, listed[0], fmu.command, listed[1])
    once, save, restore = map(float, text.split())
    return once, save, restore


def through_fmpy(fmu: Fmu, step: float) -> float:
    """Nanoseconds a step in a plain loop over FMPy's class."""
    best, count = float("inf"), round(SECONDS / step)
    slave = FMU2Slave(guid=fmu.guid, unzipDirectory=str(fmu.folder), modelIdentifier=fmu.identifier)
    for _ in range(ROUNDS):
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        start = time.process_time_ns()
        for k in range(count):
            if fmu.inputs:
                slave.setReal(fmu.inputs, [fmu.command] * len(fmu.inputs))
            slave.doStep(k * step, step)
            slave.getReal(fmu.outputs)
        best = min(best, (time.process_time_ns() - start) / count)
        slave.terminate()
        slave.fmi2FreeInstance(slave.component)
    return best


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", default="two_wheeled,rocker_bogie,gentle_rtc", help="presets, comma-separated")
    parser.add_argument("--bekker", default=str(HERE.parents[1] / "target" / "release" / "bekker"))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        host = folder / "host"
        run("gcc", "-O2", "-o", host, HERE / "host.c", "-ldl")
        fmus = [minimal(folder)] + [rover(folder, arguments.bekker, model) for model in arguments.models.split(",")]
        print(f"{'us a step':>14} {'C 2 ms':>9} {'C 20 ms':>9} {'FMPy 20 ms':>11} {'inner':>7} {'border':>7} "
              f"{'save':>7} {'restore':>8} {'simulated s/s':>14}")
        for fmu in fmus:
            short, save, restore = through_c(host, fmu, INNER)
            long, *_ = through_c(host, fmu, 10 * INNER)
            python = through_fmpy(fmu, 10 * INNER)
            inner = max((long - short) / 9.0, 0.0)
            times = [short, long, python, inner, short - inner, save, restore]
            cells = ["-" if t < 0.0 else f"{t / 1e3:.2f}" for t in times]
            widths = (9, 9, 11, 7, 7, 7, 8)
            rate = 10 * INNER / (long * 1e-9)
            print(f"{fmu.name:>14} " + " ".join(f"{c:>{w}}" for c, w in zip(cells, widths)) + f" {rate:>14.0f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
