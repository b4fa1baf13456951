"""FMUs of the presets in both versions, as the tests load them.

With BEKKER_CLI, the path of the command line, the FMUs are made by it and the Python package is not needed
(``pytest --noconftest``).
"""

import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

VERSIONS = (2, 3)
TORQUE = ["two_wheeled", "rocker_bogie"]
MODELS = [*TORQUE, "gentle_velocity", "gentle_rtc"]
SIGNALS = ["x", "z", "pitch", "velocity", "wheel[1].slip", "wheel[2].sinkage", "dissipated_energy"]
# Torque that drives the preset `two_wheeled` forward, N m.
DRIVING = 1.8
ROOT = Path(__file__).resolve().parents[2]

KINDS = ("rover", "controller", "closed-loop")

Make = Callable[..., str]


def load(script: str) -> Any:
    """A script of the project as a module."""
    spec = importlib.util.spec_from_file_location(Path(script).stem, ROOT / script)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def write_fmu(model: str, path: Path, fmi: int, kind: str | None, system_inputs: bool = False) -> None:
    program = os.environ.get("BEKKER_CLI")
    if program is not None:
        command = [program, "fmu", model, "--output", str(path), "--fmi", str(fmi)]
        command += [] if kind is None else ["--kind", kind]
        subprocess.run([*command, "--system-inputs"] if system_inputs else command, check=True)
    else:
        import bekker

        bekker.export_fmu(model, path, fmi=fmi, kind=kind, system_inputs=system_inputs)


@pytest.fixture(scope="module")
def make(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Make]:
    folder = tmp_path_factory.mktemp("fmus")

    def fmu(model: str, fmi: int, kind: str | None = None, ending: str = "fmu", system_inputs: bool = False) -> str:
        path = folder / f"{model}_{fmi}_{kind}_{system_inputs}.{ending}"
        if not path.exists():
            write_fmu(model, path, fmi, kind, system_inputs)
        return str(path)

    yield fmu


def bits(result: np.ndarray) -> list[bytes]:
    return [result[name].tobytes() for name in result.dtype.names]


class Slave:
    """An FMI 2.0 instance, driven call by call."""

    def __init__(self, fmu: str, folder: Path) -> None:
        self.folder = fmpy.extract(fmu, unzipdir=str(folder))
        self.description = fmpy.read_model_description(self.folder)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        identifier = self.description.coSimulation.modelIdentifier
        guid = self.description.guid
        self.fmu = FMU2Slave(guid=guid, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName="rover")
        self.fmu.instantiate()
        self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def drive(self, begin: int, count: int, level: float) -> list[float]:
        inputs = [self.references[f"wheel[{k}].torque_command"] for k in (1, 2)]
        for k in range(begin, begin + count):
            self.fmu.setReal(inputs, [level, level])
            self.fmu.doStep(k * 0.01, 0.01)
        return self.get()

    def get(self) -> list[float]:
        return self.fmu.getReal([self.references[name] for name in SIGNALS])  # type: ignore[no-any-return]
