"""An exported FMU, in FMPy's hands: no complaint, the same vocabulary. `test_doors.py` drives it."""

from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

import bekker


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


def test_property_refusals_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="cannot write"):
        bekker.export_fmu("two_wheeled", tmp_path / "no_such_folder" / "rover.fmu")
    with pytest.raises(bekker.ModelError, match="cannot settle"):
        bekker.export_fmu("two_wheeled", tmp_path / "rover.fmu", {"rover.centre_of_mass_x": 3.0})
