"""FMI 2.0 and 3.0 of one model through FMPy: the same bits, any communication step, states across processes, arrays.

See `fmus.py` for BEKKER_CLI.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmus import DRIVING, SIGNALS, VERSIONS, Make, Slave, bits, make, write_fmu  # noqa: F401

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


@pytest.mark.parametrize("model", ["two_wheeled", "gentle_rtc"])
def test_property_a_default_simulation_has_the_same_rows_in_both_versions(make: Make, model: str) -> None:
    rows = [fmpy.simulate_fmu(make(model, fmi), stop_time=1.0, fmi_type="CoSimulation")["time"] for fmi in VERSIONS]
    assert len(rows[0]) == 101 and rows[0].tolist() == rows[1].tolist()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_property_the_importer_draws_noise_by_the_seed(make: Make, fmi: int) -> None:
    fmu = make("gentle_rtc", fmi, "rover")

    def pitch(seed: int) -> list[float]:
        start = {"simulation.seed": seed, "sensor.pitch_noise": 0.01}
        names = ["measured.pitch", "event", "event_code"]
        result = fmpy.simulate_fmu(fmu, stop_time=0.2, start_values=start, output=names, fmi_type="CoSimulation")
        assert result["event_code"].tolist() == result["event"].tolist()
        return result["measured.pitch"].tolist()

    assert pitch(1) == pitch(1)
    assert pitch(1) != pitch(2)


CONTINUE = """
import json, pathlib, sys
sys.path.insert(0, sys.argv[4])
from fmus import Slave
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
