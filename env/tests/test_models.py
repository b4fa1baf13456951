"""Models, runs and `simulate`: reading, setting, copying, and what is refused."""

import copy
import pickle
import threading
from pathlib import Path

import numpy as np
import pytest

import bekker

PRESETS = tuple(bekker.presets())


@pytest.mark.parametrize("preset", PRESETS)
def test_property_copies_and_texts_are_the_same_model(preset: str, tmp_path: Path) -> None:
    model = bekker.Model.from_preset(preset)
    model.set("soil.cohesion", 812.3456789012345)
    (tmp_path / "model.toml").write_text(model.to_toml())
    others = [
        bekker.Model.from_toml(model.to_toml()),
        bekker.Model.read(tmp_path / "model.toml"),
        pickle.loads(pickle.dumps(model)),
        copy.deepcopy(model),
        model.copy(),
    ]
    for other in others:
        assert other.parameters() == model.parameters()
        assert (other.to_toml(), other.name, other.control) == (model.to_toml(), model.name, model.control)
        other.set("soil.cohesion", 1.0)
    assert model.get("soil.cohesion") == 812.3456789012345


@pytest.mark.parametrize("preset", PRESETS)
def test_property_the_vocabulary_is_complete(preset: str) -> None:
    model = bekker.Model.from_preset(preset)
    everything = model.parameters() + model.inputs() + model.signals()
    names = [variable["name"] for variable in everything]
    assert len(set(names)) == len(names)
    for variable in everything:
        assert variable["doc"] and variable["unit"] and variable["source"]
        assert variable["min"] <= variable["value"] <= variable["max"]
        assert variable["min"] <= variable["default"] <= variable["max"]
    assert {variable["role"] for variable in model.parameters()} == {"fixed", "rig", "calibrated", "effect"}
    run = model.start()
    assert run.signal_names == [variable["name"] for variable in model.signals()]
    assert run.input_names == [variable["name"] for variable in model.inputs()]
    effects = {variable["name"].split(".")[0] for variable in model.parameters()}
    # A wheel whose speed is imposed does not feel its supply voltage, so the limit is not listed there; nor is
    # friction of joints on a rigid chassis.
    unfelt = {"voltage_limit"} if model.control == "speed" else set()
    if not any(variable["name"].startswith("link[") for variable in model.parameters()):
        unfelt.add("suspension_friction")
    assert set(bekker.effects()) - unfelt <= effects


def test_property_a_copied_run_goes_on_to_the_same_bits() -> None:
    run = bekker.Model.from_preset("gentle_rtc").start()
    run.step([0.3], 333)
    for twin in (run.copy(), copy.copy(run), copy.deepcopy(run)):
        ahead = run.copy()
        ahead.step([0.2], 400)
        twin.step([0.2], 400)
        assert np.array_equal(ahead.signals(), twin.signals()) and ahead.time == twin.time
        assert not np.array_equal(ahead.signals(), run.signals())


def test_property_inputs_in_every_form_are_the_same() -> None:
    names = ["wheel[1].torque_command", "wheel[2].torque_command"]
    ramp = np.linspace(0.0, 2.0, 50)
    forms = [
        {names[0]: ramp, names[1]: 1.0},
        lambda t: {names[0]: ramp[round(t / 0.02)], names[1]: 1.0},
        lambda t: [ramp[round(t / 0.02)], 1.0],
        lambda t: np.array([ramp[round(t / 0.02)], 1.0]),
    ]
    results = [bekker.simulate("two_wheeled", 1.0, form, 0.02) for form in forms]
    for result in results:
        assert all(np.array_equal(result[name], results[0][name]) for name in result)
        assert np.array_equal(result["wheel[1].torque"][1:], ramp)
    assert len(results[0].time) == 51 and results[0].time[-1] == 1.0
    assert list(results[0]) == list(results[0].units) and results[0].units["time"] == "s"


def test_property_an_event_ends_the_record() -> None:
    torques = {"wheel[1].torque_command": 8.0, "wheel[2].torque_command": 8.0}
    result = bekker.simulate("two_wheeled", 20.0, torques, parameters={"motor.inverse_voltage": 0.0})
    assert result.status == "stuck" and result.event is not None and result.event.startswith("stuck:")
    assert 0.0 < result.time[-1] < 20.0
    assert all(len(column) == len(result.time) for column in result.values())


def test_property_other_threads_run_meanwhile() -> None:
    turns, done = 0, threading.Event()

    def long_run() -> None:
        bekker.simulate("gentle_rtc", 20.0, period=0.02)
        done.set()

    thread = threading.Thread(target=long_run)
    thread.start()
    while not done.wait(0.001):
        turns += 1
    thread.join()
    assert turns > 5, "the interpreter was held during the run"


@pytest.mark.parametrize(
    ("text", "error", "message"),
    [
        ("preset = 'moon'", bekker.UnknownNameError, "unknown preset `moon`; the presets are two_wheeled"),
        ("speed = 3", bekker.ModelError, "unknown field `speed`"),
        ("[parameters]\nsoil.cohesion = 'a'", bekker.ModelError, "`soil.cohesion`: expected a number, found string"),
        ("[terrain]\nfile = 'no_such.csv'", FileNotFoundError, "no_such.csv"),
        ("[terrain]\npreset = 'slope'\nslop = 0.1", bekker.UnknownNameError, "`terrain.slop`"),
        ("[vehicle]\nwheels = [0]", bekker.ModelError, "expected 2 to 8 wheels, found 1"),
        ("[simulation]\nstep_size = 1.0", bekker.ModelError, "simulation.step_size = 1"),
    ],
)
def test_property_bad_models_are_named(text: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        bekker.Model.from_toml(text)


def test_property_bad_files_and_values_are_named() -> None:
    model = bekker.Model.from_preset("two_wheeled")
    with pytest.raises(FileNotFoundError, match=r"no_such\.toml"):
        bekker.Model.read("no_such.toml")
    with pytest.raises(KeyError) as unknown:
        model.get("rover.mas")
    assert str(unknown.value).startswith("unknown parameter `rover.mas`; did you mean rover.mass")
    with pytest.raises(ValueError, match="`rover.mass` = NaN is outside its allowed range"):
        model.set("rover.mass", float("nan"))
    assert model.get("rover.mass") == 10.0
    with pytest.raises(OverflowError):
        model.seed = -1
    model.set("rover.centre_of_mass_x", 3.0)
    with pytest.raises(bekker.SimulationError, match="cannot settle the rover"):
        model.start()
    late = bekker.Model.from_toml("preset = 'gentle_rtc'\n[parameters]\nrtc.period = 0.003")
    with pytest.raises(bekker.ModelError, match="control period 0.003 s is not a whole multiple"):
        late.start()


def test_property_bad_inputs_are_named_and_move_nothing() -> None:
    run = bekker.Model.from_preset("two_wheeled").start()
    before = run.signals()
    out = np.zeros(len(before))
    cases = [
        ([1.0], 1, out, "1 input values were given, this model has 2 inputs"),
        ([1.0, float("nan")], 1, out, r"input `wheel\[2\].torque_command` = NaN is outside"),
        ([1.0, 1e9], 1, out, r"`wheel\[2\].torque_command` = 1000000000 is outside"),
    ]
    for inputs, steps, place, message in cases:
        with pytest.raises(bekker.InputError, match=message):
            run.step(inputs, steps, place)
        assert run.time == 0.0 and np.array_equal(run.signals(), before)
    with pytest.raises(bekker.InputError, match="out has 3 places, this run has"):
        run.read(np.zeros(3))
    with pytest.raises(bekker.InputError, match="contiguous"):
        run.read(np.zeros(2 * len(before))[::2])
    frozen = np.zeros(len(before))
    frozen.flags.writeable = False
    with pytest.raises(bekker.InputError, match="out: "):
        run.read(frozen)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"inputs": {"wheel[3].torque_command": 1.0}}, r"unknown input `wheel\[3\].torque_command`; expected wheel\[1\]"),
        ({"inputs": {"wheel[1].torque_command": [1.0, 2.0]}}, r"has shape \(2,\), expected one value or 50"),
        ({"inputs": lambda t: [1.0]}, r"inputs gave values of shape \(1,\), expected \(2,\)"),
        ({"inputs": 1.0}, "expected a mapping by name or a function of time, found float"),
        ({"inputs": {"wheel[1].torque_command": float("nan")}}, r"input `wheel\[1\].torque_command` = NaN"),
        ({"duration": 1.01}, "duration = 1.01 s: expected a whole number of periods of 0.02 s"),
        ({"duration": -1.0}, "duration = -1.0 s"),
        ({"period": 0.001}, "period = 0.001 s: expected a whole number of inner steps"),
    ],
)
def test_property_bad_simulations_are_named(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(bekker.BekkerError, match=message):
        bekker.simulate(**({"model": "two_wheeled", "duration": 1.0, "period": 0.02} | arguments))
    with pytest.raises(KeyError, match="unknown signal `velocit`; did you mean velocity"):
        bekker.simulate("two_wheeled", 0.02)["velocit"]
