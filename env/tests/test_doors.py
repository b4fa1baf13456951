"""The FMU, loaded by FMPy, gives the bits of the other doors over random rovers, grounds and commands."""

from pathlib import Path

import numpy as np
import pytest
from conftest import Drive
from test_agreement import SEEDS, simulated
from test_fmu import Slave

import bekker

# FMPy leaves the archive open when it reads a description.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

SIGNALS = ("x", "z", "pitch", "electrical_energy", "wheel[1].slip", "wheel[2].normal_force", "wheel[2].torque")


@pytest.mark.parametrize("drive", SEEDS, indirect=True)
def test_agreement_fmu_equals_simulate(drive: Drive, tmp_path: Path) -> None:
    python = simulated(drive)
    bekker.export_fmu(drive.model, tmp_path / "rover.fmu")
    slave = Slave(str(tmp_path / "rover.fmu"), tmp_path / "unzipped")
    try:
        slave.start(startTime=0.0)
        inputs = [variable["name"] for variable in drive.model.inputs()]
        period = drive.steps * drive.model.step_size
        last = len(python.time) - 1
        for k, row in enumerate(drive.commands[:last]):
            slave.set(**dict(zip(inputs, row, strict=True)))
            slave.fmu.doStep(k * period, period)
            if k + 1 == last and python.event is not None:
                break  # the run ended within this step: the FMU stops there as well
            expected = [python[name][k + 1] for name in SIGNALS]
            assert np.array_equal(slave.get(*SIGNALS), expected), f"step {k + 1}"
        assert np.array_equal(slave.get(*SIGNALS), [python[name][last] for name in SIGNALS])
    finally:
        slave.free()


@pytest.mark.parametrize("drive", SEEDS[:6], indirect=True)
def test_agreement_parameters_set_by_an_importer_equal_those_of_the_model(drive: Drive, tmp_path: Path) -> None:
    """A plain FMU of the same structure whose importer sets every parameter drives like the model itself."""
    kind = bekker.Model.from_toml(drive.model.to_toml())
    changed = {"soil.cohesion": 700.0, "soil.shear_modulus": 0.012, "drag.force": 0.4, "slip_sinkage.n1": 0.1}
    for name, value in changed.items():
        kind.set(name, value)
    python = simulated(Drive(kind, drive.commands, drive.steps))
    bekker.export_fmu(drive.model, tmp_path / "rover.fmu")
    slave = Slave(str(tmp_path / "rover.fmu"), tmp_path / "unzipped")
    try:
        slave.set(**changed)
        slave.start(startTime=0.0)
        inputs = [variable["name"] for variable in drive.model.inputs()]
        period = drive.steps * drive.model.step_size
        for k, row in enumerate(drive.commands[: len(python.time) - 1]):
            slave.set(**dict(zip(inputs, row, strict=True)))
            slave.fmu.doStep(k * period, period)
        assert np.array_equal(slave.get(*SIGNALS), [python[name][-1] for name in SIGNALS])
    finally:
        slave.free()
