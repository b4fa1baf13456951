"""FMI 2.0 and 3.0 of one model through FMPy: valid, the same bits, any communication step, states across processes,
derivatives, model exchange, cross-check files.

With BEKKER_CLI, the path of the command line, the FMUs are made by it and the Python package is not needed
(``pytest --noconftest``).
"""

import ctypes
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu

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


def write_fmu(model: str, path: Path, fmi: int, kind: str | None) -> None:
    program = os.environ.get("BEKKER_CLI")
    if program is not None:
        command = [program, "fmu", model, "--output", str(path), "--fmi", str(fmi)]
        subprocess.run(command if kind is None else [*command, "--kind", kind], check=True)
    else:
        import bekker

        bekker.export_fmu(model, path, fmi=fmi, kind=kind)


@pytest.fixture(scope="module")
def make(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Make]:
    folder = tmp_path_factory.mktemp("fmus")

    def fmu(model: str, fmi: int, kind: str | None = None, ending: str = "fmu") -> str:
        path = folder / f"{model}_{fmi}_{kind}.{ending}"
        if not path.exists():
            write_fmu(model, path, fmi, kind)
        return str(path)

    yield fmu


def torques(level: float, stop: float) -> np.ndarray:
    names = ["time", "wheel[1].torque_command", "wheel[2].torque_command"]
    rows = [(0.0, level, level), (stop, level, level)]
    return np.array(rows, dtype=[(name, float) for name in names])


def bits(result: np.ndarray) -> list[bytes]:
    return [result[name].tobytes() for name in result.dtype.names]


@pytest.mark.parametrize("fmi", VERSIONS)
@pytest.mark.parametrize("model", MODELS)
def test_property_fmpy_has_no_remark(make: Make, model: str, fmi: int) -> None:
    assert validate_fmu(make(model, fmi)) == []
    description = fmpy.read_model_description(make(model, fmi))
    assert description.fmiVersion == f"{fmi}.0"
    assert {v.declaredType.name for v in description.modelVariables if v.declaredType} >= {"Length", "Angle", "Torque"}
    assert all(v.unit for v in description.modelVariables if v.type in ("Real", "Float64") and "indicator" not in v.name)


RIG = """name = "wheel"
[rig]
kind = "carriage"
[parameters]
wheel.radius = 0.058
wheel.width = 0.05
soil.k_phi = 1.5e6
"""


def test_agreement_a_wheel_on_a_carriage_is_the_same_map_in_both_versions(tmp_path: Path) -> None:
    model, found = tmp_path / "wheel.toml", []
    model.write_text(RIG)
    for fmi in VERSIONS:
        fmu = tmp_path / f"wheel_{fmi}.fmu"
        write_fmu(str(model), fmu, fmi, None)
        assert validate_fmu(str(fmu)) == []
        outputs = ["drawbar_pull", "torque", "sinkage"]
        start = {"load": 15.0, "slip": 0.3, "wheel_speed": 0.5, "soil.cohesion": 1200.0}
        # A step that is no whole number of the offered ones.
        result = fmpy.simulate_fmu(str(fmu), stop_time=0.5, output_interval=0.125, start_values=start, output=outputs)
        assert all(np.all(result[name] == result[name][0]) and np.all(result[name] != 0.0) for name in outputs)
        found.append(bits(result))
    assert found[0] == found[1]


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


def test_agreement_of_the_versions_with_each_other_and_the_core(make: Make, tmp_path: Path) -> None:
    results = [
        fmpy.simulate_fmu(
            make("two_wheeled", fmi),
            stop_time=2.0,
            output_interval=0.02,
            # Held from the start; FMPy's interpolation of a constant input rounds.
            start_values={f"wheel[{k}].torque_command": DRIVING for k in (1, 2)},
            output=SIGNALS,
            fmi_type="CoSimulation",
        )
        for fmi in VERSIONS
    ]
    assert bits(results[0]) == bits(results[1])
    assert results[0]["x"][-1] > 0.05, "the rover has moved"
    program = os.environ.get("BEKKER_CLI")
    if program is None:
        import bekker

        names = ["wheel[1].torque_command", "wheel[2].torque_command"]
        drive = bekker.simulate("two_wheeled", duration=2.0, inputs=dict.fromkeys(names, DRIVING), period=0.02)
        core = {name: np.asarray(drive[name]) for name in SIGNALS}
    else:
        path = tmp_path / "core.csv"
        inputs = [f"--input=wheel[{k}].torque_command={DRIVING}" for k in (1, 2)]
        command = [program, "simulate", "two_wheeled", "--duration", "2", "--every", "0.02", "--csv", str(path)]
        subprocess.run([*command, *inputs], check=True)
        table = np.genfromtxt(path, delimiter=",", names=None, dtype=str)
        header = [name.split(" ")[0].strip('"') for name in table[0]]
        core = {name: table[1:, header.index(name)].astype(float) for name in SIGNALS}
    for name in SIGNALS:
        ours = results[0][name]
        theirs = core[name]
        assert ours[-len(theirs) + 1 :].tobytes() == theirs[1:].tobytes(), name


@pytest.mark.parametrize("fmi", VERSIONS)
def test_property_any_communication_step_gives_the_same_simulation(make: Make, fmi: int) -> None:
    def at_the_end(step: float) -> list[bytes]:
        result = fmpy.simulate_fmu(
            make("two_wheeled", fmi),
            stop_time=0.6,
            output_interval=step,
            start_values={f"wheel[{k}].torque_command": DRIVING for k in (1, 2)},
            output=SIGNALS,
            fmi_type="CoSimulation",
        )
        assert abs(result["time"][-1] - 0.6) < 1e-9
        return [result[name][-1].tobytes() for name in SIGNALS]

    # 0.6 s is on the grid of inner steps; 0.03 too, 0.0125 and 0.6 / 7 are not.
    assert at_the_end(0.03) == at_the_end(0.0125) == at_the_end(0.6 / 7)


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


CONTINUE = """
import json, pathlib, sys
sys.path.insert(0, sys.argv[4])
from test_fmu_versions import Slave
slave = Slave(sys.argv[1], pathlib.Path(sys.argv[2]))
state = slave.fmu.deSerializeFMUstate(pathlib.Path(sys.argv[3]).read_bytes())
slave.fmu.setFMUstate(state)
print("VALUES", json.dumps([value.hex() for value in slave.drive(50, 50, 2.0)]))
"""


def test_property_a_state_goes_on_in_a_new_process(make: Make, tmp_path: Path) -> None:
    fmu = make("two_wheeled", 2)
    if not fmpy.read_model_description(fmu).coSimulation.canSerializeFMUstate:
        pytest.skip("this model cannot serialise its state")
    slave = Slave(fmu, tmp_path / "here")
    slave.drive(0, 50, DRIVING)
    state = slave.fmu.getFMUstate()
    file = tmp_path / "state"
    file.write_bytes(slave.fmu.serializeFMUstate(state))
    here = slave.drive(50, 50, 2.0)
    arguments = [fmu, str(tmp_path / "there"), str(file), str(Path(__file__).parent)]
    run = subprocess.run([sys.executable, "-c", CONTINUE, *arguments], capture_output=True, text=True)
    line = next((line for line in run.stdout.splitlines() if line.startswith("VALUES ")), None)
    assert line is not None, run.stderr
    assert json.loads(line.removeprefix("VALUES ")) == [value.hex() for value in here]


def test_agreement_of_directional_derivatives_with_differences(make: Make, tmp_path: Path) -> None:
    """The derivatives of the states by the states: the model's against central differences through the border."""
    fmu = make("two_wheeled", 2, "rover")
    description = fmpy.read_model_description(fmu)
    if description.modelExchange is None or not description.modelExchange.providesDirectionalDerivative:
        pytest.skip("this model has no directional derivatives in model exchange")
    folder = fmpy.extract(fmu, unzipdir=str(tmp_path))
    identifier = description.modelExchange.modelIdentifier
    model = FMU2Model(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="rover")
    model.instantiate()
    model.setupExperiment()
    references = {v.name: v.valueReference for v in description.modelVariables}
    torque = [references[f"wheel[{k}].torque_command"] for k in (1, 2)]
    model.setReal(torque, [DRIVING, DRIVING])
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    states = [d.variable.derivative.valueReference for d in description.derivatives]
    rates = [d.variable.valueReference for d in description.derivatives]
    x = np.array(model.getReal(states))

    def slopes(at: np.ndarray) -> np.ndarray:
        values = np.ascontiguousarray(at)
        pointer = values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        model.setContinuousStates(pointer, len(values))
        return np.array(model.getReal(rates))

    # Away from rest, where slip has no derivative: 0.3 s by Euler's method.
    for _ in range(3000):
        x = x + 1e-4 * slopes(x)
    worst = 0.0
    for k, state in enumerate(states):
        # Steps in proportion to the state, for truncation and rounding of the same size in double precision.
        h = 1e-6 * max(abs(x[k]), 1e-2)
        step = np.zeros(len(x))
        step[k] = h
        differences = (slopes(x + step) - slopes(x - step)) / (2.0 * h)
        slopes(x)
        exact = np.array(model.getDirectionalDerivative(rates, [state], [1.0]))
        scale = np.abs(exact).max()
        assert np.isfinite(exact).all()
        if scale > 0.0:
            worst = max(worst, float(np.abs(exact - differences).max() / scale))
    model.freeInstance()
    # Central differences with these steps have seven digits at best, in stiff directions fewer.
    assert worst < 1e-4, worst


@pytest.mark.parametrize("fmi", VERSIONS)
def test_agreement_of_model_exchange_with_cosimulation(make: Make, fmi: int) -> None:
    fmu = make("two_wheeled", fmi, "rover")
    if fmpy.read_model_description(fmu).modelExchange is None:
        pytest.skip("this model is no system of differential equations")

    def simulate(kind: str, **options: Any) -> np.ndarray:
        return fmpy.simulate_fmu(
            fmu,
            stop_time=1.0,
            output_interval=0.02,
            input=torques(DRIVING, 1.0),
            output=["x", "velocity", "pitch", "wheel[1].slip"],
            fmi_type=kind,
            **options,
        )

    steps = simulate("CoSimulation")
    solver = simulate("ModelExchange", solver="CVode", relative_tolerance=1e-7)
    at = np.interp(steps["time"], solver["time"], solver["x"])
    # The integrator inside has a fixed step of 2 ms and is of first order in the stiff parts.
    assert np.abs(at - steps["x"]).max() < 0.01 * steps["x"][-1]


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
        make("gentle_rtc", 2, None, "ssp"),
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


def test_agreement_of_arrays_through_fmpy(make: Make, tmp_path: Path) -> None:
    """FMPy's own reading of arrays: one variable for all wheels, the same bits as one variable a wheel."""
    bekker = pytest.importorskip("bekker")
    path = tmp_path / "arrays.fmu"
    bekker.export_fmu("two_wheeled", path, fmi=3, arrays=True)
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(str(path))
    shapes = {v.name: v.shape for v in description.modelVariables if v.dimensions}
    assert shapes["wheels.slip"] == shapes["wheels.torque_command"] == (2,)
    start = {"wheels.torque_command": [DRIVING, DRIVING]}
    result = fmpy.simulate_fmu(str(path), stop_time=1.0, output=["x", "wheels.slip"], start_values=start)
    names = ["x", "wheel[1].slip", "wheel[2].slip"]
    start = {f"wheel[{k}].torque_command": DRIVING for k in (1, 2)}
    single = fmpy.simulate_fmu(make("two_wheeled", 3), stop_time=1.0, output=names, start_values=start)
    assert result["x"].tobytes() == single["x"].tobytes()
    for k in (1, 2):
        assert result["wheels.slip"][:, k - 1].tobytes() == single[f"wheel[{k}].slip"].tobytes()
    with pytest.raises(bekker.errors.ModelError, match="FMI 2.0 has no arrays"):
        bekker.export_fmu("two_wheeled", tmp_path / "arrays_2.fmu", fmi=2, arrays=True)
