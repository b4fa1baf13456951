"""FMUs of every kind, and a system of two, in Ecos, libcosim and the Rust crate `fmi`, beside FMPy and the core.

See `fmus.py` for BEKKER_CLI. BEKKER_FMU_JUDGE is the program of `fmu/judge`, which `tests/run.sh` builds.
"""

import os
import re
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import masters
import numpy as np
import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmus import DRIVING, Make, load, make, write_fmu  # noqa: F401

STEP, COUNT = 0.01, 100
RIG = """name = "wheel"
[rig]
kind = "carriage"
[parameters]
wheel.radius = 0.058
soil.k_phi = 1.5e6
"""
# What is set and read of each kind.
DRIVES: dict[str, tuple[str, str | None, dict[str, float], list[str]]] = {
    "rover": ("two_wheeled", "rover", {f"wheel[{k}].torque_command": DRIVING for k in (1, 2)}, ["x", "wheel[1].slip"]),
    "speeds": ("two_wheeled_speed", "rover", {f"wheel[{k}].speed_command": 2.0 for k in (1, 2)}, ["x", "wheel[2].slip"]),
    "closed-loop": ("gentle_rtc", "closed-loop", {"velocity_command": 0.2, "soil.shear_modulus": 0.01}, ["x", "power"]),
    "controller": ("gentle_rtc", "controller", {"velocity_command": 0.2}, [f"wheel[{k}].torque_command" for k in (1, 2)]),
    "carriage": ("wheel", None, {"load": 15.0, "slip": 0.3, "wheel_speed": 0.5}, ["drawbar_pull", "torque", "sinkage"]),
}
VERSIONS_OF = {"ecos": (2, 3), "libcosim": (2,)}


@pytest.fixture(scope="module")
def fmu(make: Make, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, int], str]:
    folder = tmp_path_factory.mktemp("carriage")

    def made(drive: str, fmi: int) -> str:
        model, kind, _, _ = DRIVES[drive]
        if kind is not None:
            return make(model, fmi, kind)
        path, file = folder / f"wheel_{fmi}.fmu", folder / "wheel.toml"
        if not path.exists():
            file.write_text(RIG)
            write_fmu(str(file), path, fmi, None)
        return str(path)

    return made


def in_fmpy(path: str, values: dict[str, float], names: list[str]) -> list[float]:
    result = fmpy.simulate_fmu(
        path, stop_time=STEP * COUNT, output_interval=STEP, start_values=values, output=names, fmi_type="CoSimulation"
    )
    return [float(result[name][-1]) for name in names]


def in_core(drive: str) -> list[float]:
    """Of a drive that is a whole model by itself."""
    bekker = pytest.importorskip("bekker")
    model, _, values, names = DRIVES[drive]
    inputs = {name: value for name, value in values.items() if name.endswith("_command")}
    parameters = {name: value for name, value in values.items() if name not in inputs}
    result = bekker.simulate(model, duration=STEP * COUNT, inputs=inputs, parameters=parameters, period=STEP)
    return [float(result[name][-1]) for name in names]


@pytest.mark.parametrize("drive", ["rover", "speeds", "closed-loop"])
def test_agreement_of_fmpy_with_the_core(fmu: Callable[[str, int], str], drive: str) -> None:
    for fmi in (2, 3):
        assert in_fmpy(fmu(drive, fmi), *DRIVES[drive][2:]) == in_core(drive)


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(("master", "fmi"), [(master, fmi) for master in masters.MASTERS for fmi in VERSIONS_OF[master]])
def test_agreement_of_masters_with_fmpy(fmu: Callable[[str, int], str], master: str, fmi: int, drive: str) -> None:
    """To the last bit: masters add nothing to the values of an FMU that is alone."""
    if not masters.installed(master):
        pytest.skip(f"needs the wheel {masters.MASTERS[master]}")
    _, _, values, names = DRIVES[drive]
    path = fmu(drive, fmi)
    found = masters.run(master, path, STEP, COUNT, values, names)
    assert found == in_fmpy(path, values, names)
    assert all(np.isfinite(found)) and any(found)


def side_by_side(make: Make, values: dict[str, float]) -> list[float]:
    """Rover and controller by hand, both stepped on what was exchanged after the step before."""
    chapter4 = load("examples/fmpy_chapter4.py")
    soil = {name: value for name, value in values.items() if name.startswith("soil.")}
    rover, controller = (chapter4.Part(make("gentle_rtc", 2, kind), kind, soil) for kind in ("rover", "controller"))
    measured = [name for name in controller.inputs if name != "velocity_command"]
    torques = [f"wheel[{k}].torque_command" for k in (1, 2)]
    controller.set({"velocity_command": values["velocity_command"]})

    def exchange() -> None:
        controller.set(dict(zip(measured, rover.get([f"measured.{name}" for name in measured]), strict=True)))
        rover.set(dict(zip(torques, controller.get(torques), strict=True)))

    exchange()
    for k in range(COUNT):
        controller.fmu.doStep(k * STEP, STEP)
        rover.fmu.doStep(k * STEP, STEP)
        exchange()
    found = list(rover.get(["x", "electrical_energy"]))
    rover.free()
    controller.free()
    return found


@pytest.mark.parametrize("master", masters.MASTERS)
def test_agreement_of_the_system_in_masters_with_its_parts(make: Make, master: str, tmp_path: Path) -> None:
    """The package as it is by default: it loads, wires by name, and both FMUs have the soil of its parameter set."""
    if not masters.installed(master):
        pytest.skip(f"needs the wheel {masters.MASTERS[master]}")
    package, changed = make("gentle_rtc", 2, None, "ssp"), tmp_path / "changed.ssp"
    with zipfile.ZipFile(package) as old, zipfile.ZipFile(changed, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "resources/soil.ssv":
                text = content.decode()
                content = re.sub(r'(soil.shear_modulus">\s*<ssv:Real value=")[^"]*', r"\g<1>0.01", text).encode()
            new.writestr(name, content)
    for path, shear_modulus in ((package, 0.03), (str(changed), 0.01)):
        names = ["rover.x", "rover.electrical_energy", "rover.soil.shear_modulus", "controller.soil.shear_modulus"]
        found = masters.run(master, path, STEP, COUNT, {"controller.velocity_command": 0.25}, names)
        assert found[2:] == [shear_modulus, shear_modulus]
        assert found[:2] == side_by_side(make, {"velocity_command": 0.25, "soil.shear_modulus": shear_modulus})
        assert found[0] > 0.1


def test_property_fmpy_loads_the_system_and_drives_one_with_inputs(make: Make) -> None:
    options = {"stop_time": (COUNT - 0.5) * STEP, "step_size": STEP, "input": {"velocity_command": lambda _: 0.25}}
    assert simulate_ssp(make("gentle_rtc", 2, None, "ssp"), **options)["rover.x"][-1] == pytest.approx(0.0, abs=1e-9)
    path = make("gentle_rtc", 2, None, "ssp", system_inputs=True)
    assert simulate_ssp(path, **options)["rover.x"][-1] > 0.1


# Attributes for which fmi-schema 0.8 has no place in FMI 3.0: it refuses every description that has one.
REFUSED = ("unit", "displayUnit", "nominal")


def without_what_the_schema_refuses(path: str, to: Path) -> str:
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(to, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "modelDescription.xml":
                head, variables, rest = re.split("(?=<ModelVariables>)|(?=<ModelStructure>)", content.decode())
                for exponent in "AK":
                    head = re.sub(rf'(<BaseUnit[^>]*?) {exponent}="[^"]*"', r"\1", head)
                for attribute in REFUSED:
                    variables = re.sub(f' {attribute}="[^"]*"', "", variables)
                content = (head + variables + rest).encode()
            new.writestr(name, content)
    return str(to)


def judge(path: str, values: dict[str, float], names: list[str]) -> subprocess.CompletedProcess[str]:
    program = os.environ.get("BEKKER_FMU_JUDGE")
    if program is None or not Path(program).exists():
        pytest.skip("needs BEKKER_FMU_JUDGE, the program of fmu/judge, which tests/run.sh builds")
    references = {v.name: v.valueReference for v in fmpy.read_model_description(path).modelVariables}
    sets = ",".join(f"{references[name]}={value!r}" for name, value in values.items())
    gets = ",".join(str(references[name]) for name in names)
    return subprocess.run([program, path, str(STEP), str(COUNT), sets, gets], capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("fmi", [2, 3])
def test_agreement_of_the_crate_fmi_with_fmpy(fmu: Callable[[str, int], str], tmp_path: Path, fmi: int, drive: str) -> None:
    _, _, values, names = DRIVES[drive]
    path = fmu(drive, fmi)
    readable = path if fmi == 2 else without_what_the_schema_refuses(path, tmp_path / "readable.fmu")
    done = judge(readable, values, names)
    assert done.returncode == 0, done.stderr
    lines = dict(line.split(" ", 1) for line in done.stdout.splitlines() if not line.startswith("kept"))
    expected = np.array(in_fmpy(path, values, names)).view(np.uint64)
    assert [int(word, 16) for word in lines["values"].split()] == expected.tolist()
    outputs = [v for v in fmpy.read_model_description(path).outputs]
    assert int(lines["unknowns"]) == len(outputs)
    assert int(lines["dependent"]) == sum(bool(unknown.dependencies) for unknown in outputs)
    if fmi == 3:
        # Where a newer schema reads the whole description, the page can say so.
        refused = judge(path, values, names)
        assert refused.returncode != 0 and "UnknownField" in refused.stderr
