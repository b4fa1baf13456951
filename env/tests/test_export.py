"""An exported FMU, in FMPy's hands: no complaint, the same vocabulary, the same bits."""

from pathlib import Path

import fmpy
import numpy as np
import pytest
from conftest import SEEDS, Drive
from fmpy.validation import validate_fmu
from numpy.typing import NDArray
from test_agreement import simulated

import bekker

Floats = NDArray[np.float64]


def test_property_fmpy_accepts_every_preset(tmp_path: Path) -> None:
    for preset in bekker.presets():
        path = tmp_path / f"{preset}.fmu"
        bekker.export_fmu(preset, path, {"soil.cohesion": 901.0})
        assert validate_fmu(str(path)) == []
        described = fmpy.read_model_description(str(path))
        start = {variable.name: variable.start for variable in described.modelVariables}
        model = bekker.Model.from_preset(preset)
        model.set("soil.cohesion", 901.0)
        for parameter in model.parameters():
            assert float(start[parameter["name"]]) == parameter["value"], parameter["name"]
        assert {signal["name"] for signal in model.signals()} <= start.keys()


@pytest.mark.parametrize("drive", SEEDS, indirect=True)
def test_agreement_fmu_equals_simulate(drive: Drive, tmp_path: Path) -> None:
    python = simulated(drive)
    path = tmp_path / "rover.fmu"
    bekker.export_fmu(drive.model, path)
    period = drive.steps * drive.model.step_size
    inputs = [variable["name"] for variable in drive.model.inputs()]
    signals = [name for name in python if name != "time"]
    commands = drive.commands[: len(python.time) - 1]
    from_fmu = stepped(path, commands, inputs, signals, period)
    assert np.array_equal(from_fmu, np.stack([python[name] for name in signals], axis=1))


def stepped(
    path: Path, commands: Floats, inputs: list[str], signals: list[str], period: float
) -> Floats:
    """Signals at the start and after every step of the FMU's own co-simulation interface."""
    described = fmpy.read_model_description(str(path))
    reference = {variable.name: variable.valueReference for variable in described.modelVariables}
    unpacked = fmpy.extract(str(path), unzipdir=str(path.with_suffix("")))
    fmu = fmpy.instantiate_fmu(unpacked, described, "CoSimulation")
    ins, outs = [reference[name] for name in inputs], [reference[name] for name in signals]
    fmu.enterInitializationMode()
    fmu.setFloat64(ins, commands[0].tolist())
    fmu.exitInitializationMode()
    said = [fmu.getFloat64(outs)]
    for k, row in enumerate(commands):
        fmu.setFloat64(ins, row.tolist())
        fmu.doStep(currentCommunicationPoint=k * period, communicationStepSize=period)
        said.append(fmu.getFloat64(outs))
    fmu.terminate()
    fmu.freeInstance()
    return np.array(said)


def test_property_refusals_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="cannot write"):
        bekker.export_fmu("two_wheeled", tmp_path / "no_such_folder" / "rover.fmu")
    with pytest.raises(bekker.ModelError, match="cannot settle"):
        bekker.export_fmu("two_wheeled", tmp_path / "rover.fmu", {"rover.centre_of_mass_x": 3.0})
