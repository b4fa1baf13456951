"""Scripted tests: drives written down with what they must give; see ``examples/scripts.md``."""

import os
import sys
import tempfile
from argparse import ArgumentParser
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ._bekker import CheckReport, Script
from .env import RoverEnv
from .errors import BekkerError, InputError
from .models import export_fmu

__all__ = ["CheckReport", "Door", "Script", "check", "main"]

Floats = NDArray[np.float64]


class Door(Protocol):
    """What can be driven through a script besides the core, FMUs and the environment: a program of your own, a rover on
    the bench."""

    name: str
    """For people."""
    time: float
    """Since the start, s."""
    status: str
    """"running", or the id of the event that ended the drive."""

    def reset(self) -> None:
        """To the start of the script's model, whatever was before."""

    def step(self, inputs: Floats) -> None:
        """On for one interval with these inputs held, in the vocabulary's order."""

    def signals(self) -> Floats:
        """The signals ``script.signals``, in that order."""


class EnvironmentDoor:
    """``bekker/Rover-v0`` as a door: its actions command the script's inputs, its period is the script's interval."""

    name = "environment"

    def __init__(self, script: Script) -> None:
        self._model = script.model
        # A power of two: the division here and the product in the environment are exact, so the inputs keep their bits.
        largest = float(np.abs(script.inputs).max(initial=0.0))
        self._scale = 2.0 ** np.ceil(np.log2(max(largest, 2.0**-20)))
        self._env = RoverEnv(self._model, period=script.interval, action_scale=self._scale)
        order = [variable["name"] for variable in self._model.signals()]
        self._places = np.array([order.index(name) for name in script.signals], dtype=np.intp)
        self.time = 0.0
        self.status = "running"

    def reset(self) -> None:
        _, info = self._env.reset(seed=self._model.seed)
        self.time, self.status = info["time"], info["status"]

    def step(self, inputs: Floats) -> None:
        _, _, _, _, info = self._env.step(inputs / self._scale)
        self.time, self.status = info["time"], info["status"]

    def signals(self) -> Floats:
        row: Floats = self._env.mechanics.signals[0, self._places]
        return row


def check(
    script: str | os.PathLike[str] | Script,
    on: str | Door = "core",
    *,
    fmu: str | os.PathLike[str] | None = None,
    fmi: int = 3,
) -> CheckReport:
    """Drives a scripted test and compares what comes with what it expects: ``assert bekker.check("drive.toml")``.

    Args:
        script: path of the script (TOML), or one that is read.
        on: what to drive: "core", "fmu", "environment", or a :class:`Door` of your own.
        fmu: with "fmu", the file of an FMU of any tool; else one of the script's model is packed.
        fmi: version of the standard of the FMU that is packed, 2 or 3.

    Returns:
        A report, true where all is as expected; ``print`` it for the first and the largest deviation of each signal.

    Raises:
        InputError, ModelError, OSError: the script or its model is refused, or a file cannot be read.
        SimulationError: the drive cannot start or go on.
    """
    own = script if isinstance(script, Script) else Script(script)
    if not isinstance(on, str):
        return own.check_door(on)
    if on == "core":
        return own.check_core()
    if on == "environment":
        return own.check_door(EnvironmentDoor(own))
    if on != "fmu":
        raise InputError(f"on = {on!r}: expected core, fmu, environment, or a door")
    if fmu is not None:
        return own.check_fmu(fmu)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.fmu"
        export_fmu(own.model, path, fmi=fmi)
        return own.check_fmu(path)


def main(arguments: list[str] | None = None) -> int:
    """``python -m bekker check``: exit codes as ``bekker check`` has them, 0 as expected, 1 not, 2 could not be driven."""
    parser = ArgumentParser("python -m bekker check", description="Drive scripted tests and compare.")
    parser.add_argument("scripts", nargs="+", type=Path, metavar="SCRIPT")
    parser.add_argument("--on", default="environment", choices=("core", "fmu", "environment"))
    parser.add_argument("--fmi", type=int, default=3, choices=(2, 3), help="version of the FMU that is packed")
    given = parser.parse_args(arguments)
    code = 0
    for script in given.scripts:
        try:
            report = check(script, given.on, fmi=given.fmi)
        except (BekkerError, OSError) as refused:
            print(f"bekker: {refused}", file=sys.stderr)
            code = 2
            continue
        print(report)
        code = max(code, 0 if report else 1)
    return code
