"""FMUs through FMPy, an importer that shares no code with them."""

import shutil
from pathlib import Path

import bekker
import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu
from stepped_fmu import Slave

TORQUE = ["two_wheeled", "rocker_bogie"]
CONTROLLED = ["gentle_velocity", "gentle_rtc"]


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Makes the FMU of a model once; the result maps the model's name to the file."""
    folder = tmp_path_factory.mktemp("fmus")
    made = {}

    def make(model):
        if model not in made:
            made[model] = str(folder / f"{len(made)}.fmu")
            bekker.export_fmu(model, made[model])
        return made[model]

    return make


@pytest.fixture
def slave(fmus, tmp_path):
    made = []

    def make(model, **options):
        made.append(Slave(fmus(model), tmp_path / str(len(made)), **options))
        return made[-1]

    yield make
    for instance in made:
        instance.free()


def commands(wheels, torques):
    """FMPy's input signal: the torque of every wheel, held from each time on."""
    names = [f"wheel[{k + 1}].torque_command" for k in range(wheels)]
    rows = [(time, *[torque] * wheels) for time, torque in torques]
    return np.array(rows, dtype=[(name, float) for name in ["time", *names]])


@pytest.mark.parametrize("model", TORQUE + CONTROLLED)
def test_property_fmpy_has_no_complaint(fmus, model):
    assert validate_fmu(fmus(model)) == []


@pytest.mark.parametrize("model", TORQUE + CONTROLLED)
def test_property_variables_have_units_bounds_and_starts(fmus, model):
    description = read_model_description(fmus(model))
    units = {unit.name: unit for unit in description.unitDefinitions}
    variables = {v.name: v for v in description.modelVariables}
    cohesion = variables["soil.cohesion"]
    assert (cohesion.unit, cohesion.displayUnit) == ("Pa", "kPa")
    assert (float(cohesion.min), float(cohesion.max)) == (0.0, 50_000.0)
    pascal = units["Pa"].baseUnit
    assert (int(pascal.kg), int(pascal.m), int(pascal.s)) == (1, -1, -2)
    (kilopascal,) = units["Pa"].displayUnits
    assert kilopascal.name == "kPa" and float(kilopascal.factor) == 1e-3
    for variable in description.modelVariables:
        assert variable.description, variable.name
        if variable.causality in ("parameter", "input"):
            start = float(variable.start)
            assert float(variable.min or -np.inf) <= start <= float(variable.max or np.inf), variable.name


def test_property_a_rover_drives_with_torques(fmus):
    """Without torque it stands; with torque it drives forward, and backward with the opposite torque."""
    velocity = {}
    for sign in (-1, 0, 1):
        result = fmpy.simulate_fmu(
            fmus("two_wheeled"),
            stop_time=2.0,
            step_size=0.01,
            input=commands(2, [(0.0, 2.0 * sign), (2.0, 2.0 * sign)]),
            output=["x", "velocity", "wheel[1].slip", "wheel[2].sinkage", "event"],
        )
        assert all(np.isfinite(result[name]).all() for name in result.dtype.names)
        assert (result["event"] == 0).all()
        assert (result["wheel[2].sinkage"] > 0).all()
        velocity[sign] = result["velocity"][-1]
    assert abs(velocity[0]) < 1e-6 and velocity[1] > 0.01
    # Rover, ground and soil are symmetric; the solver's rounding is not.
    assert velocity[-1] == pytest.approx(-velocity[1], rel=1e-6)


@pytest.mark.parametrize("model", CONTROLLED)
def test_property_a_built_in_controller_follows_its_command(fmus, model):
    """More speed asked for is more speed; velocity control turns the wheels as fast as rolling would need."""
    velocity, speed = [], []
    for command in (0.1, 0.2):
        rows = np.array([(0.0, command), (3.0, command)], dtype=[("time", float), ("velocity_command", float)])
        result = fmpy.simulate_fmu(
            fmus(model), stop_time=3.0, step_size=0.02, input=rows, output=["velocity", "wheel[1].speed"]
        )
        velocity.append(result["velocity"][-1])
        speed.append(result["wheel[1].speed"][-1])
    assert 0.01 < velocity[0] < velocity[1]
    if model == "gentle_velocity":
        # The wheel's radius is 0.1 m; the integral part of the controller leaves less than a per cent after 3 s.
        assert speed == pytest.approx([1.0, 2.0], rel=0.01)


def test_agreement_the_fmu_gives_the_bits_of_the_python_door(fmus, slave):
    """Two doors to one core: `bekker.simulate` and the FMU."""
    simulate = getattr(bekker, "simulate", None)
    if simulate is None:
        pytest.skip("this build has no bekker.simulate")
    result = simulate("gentle_velocity", duration=2.0)
    instance = slave("gentle_velocity")
    instance.start()
    step = result["time"][1] - result["time"][0]
    for k in range(len(result["time"]) - 1):
        instance.fmu.doStep(k * step, step)
        assert instance.get("velocity", "x") == [result["velocity"][k + 1], result["x"][k + 1]], k


def test_property_start_values_set_by_the_importer_matter(fmus):
    def sinkage(cohesion, k_phi):
        return fmpy.simulate_fmu(
            fmus("two_wheeled"),
            stop_time=0.1,
            step_size=0.01,
            start_values={"soil.cohesion": cohesion, "soil.k_phi": k_phi},
            output=["wheel[1].sinkage"],
        )["wheel[1].sinkage"][-1]

    assert sinkage(1000.0, 4e5) > sinkage(1000.0, 8e5) > 0.0


def test_property_a_model_file_becomes_the_defaults(fmus):
    text = 'name = "my rover"\npreset = "two_wheeled"\n[parameters]\nsoil.cohesion = 1234.5\n'
    description = read_model_description(fmus(text))
    assert description.modelName == "my rover"
    assert description.coSimulation.modelIdentifier == "my_rover"
    starts = {v.name: v.start for v in description.modelVariables}
    assert float(starts["soil.cohesion"]) == 1234.5
    assert validate_fmu(fmus(text)) == []


def test_property_the_same_model_gives_the_same_bytes(fmus, tmp_path):
    again = tmp_path / "again.fmu"
    bekker.export_fmu("two_wheeled", str(again))
    assert again.read_bytes() == Path(fmus("two_wheeled")).read_bytes()


def test_property_without_a_resource_path_the_library_finds_its_files(slave):
    """FMI 3.0.2 passes NULL where there is no path."""
    instance = slave("two_wheeled", give_resources=False)
    instance.start()
    assert instance.get("wheel[1].sinkage")[0] > 0.0


def test_property_state_is_saved_and_restored_to_the_bit(slave):
    instance = slave("two_wheeled")
    instance.start()
    names = ["x", "velocity", "wheel[1].slip", "dissipated_energy"]

    def drive(begin, torque):
        for k in range(begin, begin + 50):
            instance.set(**{"wheel[1].torque_command": torque, "wheel[2].torque_command": torque})
            instance.fmu.doStep(k * 0.01, 0.01)
        return instance.get(*names)

    drive(0, 1.8)
    state = instance.fmu.getFMUState()
    first = drive(50, 2.0)
    instance.fmu.setFMUState(state)
    other = drive(50, 1.6)
    instance.fmu.setFMUState(state)
    assert drive(50, 2.0) == first != other
    instance.fmu.freeFMUState(state)


def test_property_two_instances_do_not_meet(slave):
    one, two = slave("two_wheeled"), slave("two_wheeled")
    for instance in (one, two):
        instance.start()
    for k in range(50):
        one.set(**{"wheel[1].torque_command": 2.0, "wheel[2].torque_command": 2.0})
        one.fmu.doStep(k * 0.01, 0.01)
        two.fmu.doStep(k * 0.01, 0.01)
    assert one.get("x")[0] > 1e-3 and abs(two.get("x")[0]) < 1e-6


def test_property_an_end_event_asks_to_terminate(slave):
    text = (
        'preset = "two_wheeled"\n[parameters]\n'
        "soil.cohesion = 0.0\nsoil.friction_angle = 0.2\n"
    )
    instance = slave(text)
    instance.start()
    instance.set(**{"wheel[1].torque_command": 20.0, "wheel[2].torque_command": 20.0})
    event, terminate, early, time = instance.fmu.doStep(0.0, 60.0)
    assert (event, terminate, early) == (False, True, False)
    assert 0.0 < time < 60.0
    assert instance.fmu.getInt64([instance.references["event"]]) != [0]
    assert any("the simulation ends at" in message for message in instance.log)


@pytest.mark.parametrize(
    "refused, words",
    [
        (lambda s: s.set(x=1.0), "output"),
        (lambda s: s.set(**{"wheel.radius": 0.2}), "fixed parameter"),
        (lambda s: s.set(**{"wheel[1].torque_command": float("nan")}), "finite number"),
        (lambda s: s.fmu.getFloat64([10**6]), "no variable has the value reference 1000000"),
        (lambda s: s.fmu.doStep(0.0, -0.01), "positive"),
        (lambda s: s.fmu.doStep(0.0, 0.0), "positive"),
        (lambda s: s.fmu.doStep(1.0, 0.01), "this instance is at 0 s"),
        (lambda s: s.fmu.enterEventMode(), "eventModeUsed = false"),
        (lambda s: s.fmu.exitInitializationMode(), "expected `initialization mode`"),
    ],
)
def test_property_misuse_is_answered_with_a_message(slave, refused, words):
    instance = slave("two_wheeled")
    instance.start()
    with pytest.raises(FMICallException):
        refused(instance)
    assert any(words in message for message in instance.log), instance.log
    instance.fmu.doStep(0.0, 0.01)


def test_property_files_of_two_exports_do_not_mix(fmus, tmp_path):
    folder = str(fmpy.extract(fmus("two_wheeled"), unzipdir=str(tmp_path / "one")))
    other = fmpy.extract(fmus("rocker_bogie"), unzipdir=str(tmp_path / "two"))
    shutil.copy(f"{other}/resources/model.toml", f"{folder}/resources/model.toml")
    log = []
    with pytest.raises(Exception, match="instantiate"):
        fmpy.simulate_fmu(folder, stop_time=0.1, step_size=0.01, logger=lambda *a: log.append(a[-1]))


def test_property_export_says_what_is_wrong(tmp_path):
    with pytest.raises(Exception, match="no_such_preset"):
        bekker.export_fmu("no_such_preset", str(tmp_path / "a.fmu"))
    with pytest.raises(Exception, match="soil.cohesion"):
        bekker.export_fmu("[parameters]\nsoil.cohesion = -1.0\n", str(tmp_path / "a.fmu"))
    with pytest.raises(Exception, match="missing"):
        bekker.export_fmu("two_wheeled", str(tmp_path / "missing" / "a.fmu"))
