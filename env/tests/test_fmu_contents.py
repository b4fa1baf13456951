"""FMUs of both versions: valid for FMPy and fmutool, and what is packed.

See `fmus.py` for BEKKER_CLI.
"""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from fmus import KINDS, MODELS, VERSIONS, Make, make  # noqa: F401


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_property_fmpy_has_no_remark(make: Make, model: str, fmi: int) -> None:
    assert validate_fmu(make(model, fmi)) == []
    description = fmpy.read_model_description(make(model, fmi))
    assert description.fmiVersion == f"{fmi}.0"
    assert {v.declaredType.name for v in description.modelVariables if v.declaredType} >= {"Length", "Angle", "Torque"}
    assert all(v.unit for v in description.modelVariables if v.type in ("Real", "Float64") and "indicator" not in v.name)


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_property_fmpy_has_no_remark_on_any_kind(make: Make, kind: str, fmi: int) -> None:
    fmu = make("gentle_rtc", fmi, kind)
    assert validate_fmu(fmu) == []
    description = fmpy.read_model_description(fmu)
    assert (description.modelExchange is not None) == (kind == "rover")
    names = {v.name: v.causality for v in description.modelVariables}
    torque = {"rover": "input", "controller": "output", "closed-loop": None}[kind]
    assert names.get("wheel[2].torque_command") == torque


@pytest.mark.parametrize("fmi", VERSIONS)
def test_property_fmutool_has_no_remark(make: Make, fmi: int) -> None:
    program = Path(sys.executable).with_name("fmutool")
    if not program.exists():
        pytest.skip("needs fmu-manipulation-toolbox")
    run = subprocess.run([program, "-input", make("two_wheeled", fmi), "-check"], capture_output=True, text=True)
    said = run.stdout + run.stderr
    assert run.returncode == 0 and not any(word in said for word in ("ERROR", "CRITICAL", "WARNING")), said


def test_property_what_is_packed(make: Make) -> None:
    for fmi, icon in ((2, "model.png"), (3, "terminalsAndIcons/icon.png")):
        with zipfile.ZipFile(make("two_wheeled", fmi)) as archive:
            names = set(archive.namelist())
            assert {"modelDescription.xml", "resources/model.toml", "documentation/index.html", icon} <= names
            assert archive.read(icon).startswith(b"\x89PNG")
    text = zipfile.ZipFile(make("two_wheeled", 3)).read("terminalsAndIcons/terminalsAndIcons.xml")
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
    from lxml import etree

    etree.XMLSchema(etree.parse(str(schema))).assertValid(etree.fromstring(text))


def test_property_the_libraries_of_both_versions_are_the_same(make: Make) -> None:
    def library(fmi: int) -> bytes:
        with zipfile.ZipFile(make("two_wheeled", fmi)) as archive:
            (name,) = [name for name in archive.namelist() if name.startswith("binaries/")]
            return archive.read(name)

    assert library(2) == library(3)


def test_property_needs_no_other_libraries(make: Make, tmp_path: Path) -> None:
    if shutil.which("ldd") is None:
        pytest.skip("needs ldd")
    folder = fmpy.extract(make("two_wheeled", 2), unzipdir=str(tmp_path))
    (library,) = Path(folder).glob("binaries/*/*")
    said = subprocess.run(["ldd", str(library)], capture_output=True, text=True, check=True).stdout
    assert "libgcc_s" not in said and "not found" not in said, said
