"""Scripts: the project's own in every door to the same bits, and what the doors of Python add."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import bekker
from bekker.checks import main

SCRIPTS = sorted((Path(__file__).resolve().parents[2] / "tests/scripts").glob("*.toml"))

DOORS = [("fmu", 2), ("fmu", 3), ("environment", 3)]


@pytest.mark.parametrize(("on", "fmi"), DOORS)
@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_regress_scripts_hold_in_every_door(path: Path, on: str, fmi: int) -> None:
    report = bekker.check(path, on, fmi=fmi)
    assert report, str(report)
    assert report.signals and all(signal["compared"] > 0 for signal in report.signals)


@pytest.mark.parametrize(("on", "fmi"), DOORS)
def test_agreement_doors_give_the_bits_that_the_core_records(on: str, fmi: int, tmp_path: Path) -> None:
    script = tmp_path / "drive.toml"
    script.write_text(
        "interval = 0.02\nduration = 1.0\nreset_after = 0.3\nseed = 5\nmodel = 'gentle_rtc'\n"
        "[inputs]\nvelocity_command = 0.17\n[expect]\nsignals = 'drive.csv'\ntolerance = { default = 0.0 }\n"
    )
    assert bekker.Script(script, to_record=True).record() == tmp_path / "drive.csv"
    report = bekker.check(script, on, fmi=fmi)
    assert report, str(report)
    names = {variable["name"] for variable in bekker.Model.from_preset("gentle_rtc").signals()}
    assert {signal["name"] for signal in report.signals} == names


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    script = tmp_path / "drive.toml"
    rows = "[[expect.signals]]\ntime = 0.0\nvelocity = 0.0\n[[expect.signals]]\ntime = 0.1\nvelocity = 5.0\n"
    head = "interval = 0.02\nduration = 0.1\nmodel = 'two_wheeled'\n"
    script.write_text(head + "[expect]\ntolerance = { velocity = 1e-3 }\n" + rows)
    return script


def test_property_the_report_tells_the_deviation(drive: Path) -> None:
    report = bekker.check(drive)
    assert not report and not report.passed and report.status == "running" and report.remarks == []
    (signal,) = report.signals
    assert (signal["name"], signal["compared"], signal["failed"]) == ("velocity", 2, 1)
    first = signal["first"]
    assert first is not None and first["time"] == pytest.approx(0.1) and first["expected"] == 5.0
    assert signal["largest"] == first and "velocity: 1 of 2 values off" in str(report)


class Recorded:
    """A door that plays numbers back."""

    name = "playback"

    def __init__(self, rows: list[list[float]], interval: float) -> None:
        self._rows, self._interval = rows, interval
        self.time, self.status = 0.0, "running"
        self.inputs: list[np.ndarray] = []

    def reset(self) -> None:
        self.time = 0.0
        self.inputs.clear()

    def step(self, inputs: np.ndarray) -> None:
        self.inputs.append(inputs.copy())
        self.time = len(self.inputs) * self._interval

    def signals(self) -> np.ndarray:
        return np.array(self._rows[len(self.inputs)])


def test_property_a_door_of_ones_own_is_driven(drive: Path) -> None:
    script = bekker.Script(drive)
    door = Recorded([[0.0], [1.0], [2.0], [3.0], [4.0], [5.0005]], script.interval)
    assert bekker.check(script, on=door)
    assert np.array_equal(door.inputs, script.inputs)


def test_property_what_a_door_raises_comes_through(drive: Path) -> None:
    class Broken(Recorded):
        def step(self, inputs: np.ndarray) -> None:
            raise ZeroDivisionError("the bench is off")

    with pytest.raises(ZeroDivisionError, match="the bench is off"):
        bekker.check(drive, on=Broken([[0.0]] * 6, 0.02))
    with pytest.raises(bekker.SimulationError, match=r"signals\(\) gave 2 values, expected 1"):
        bekker.check(drive, on=Recorded([[0.0, 0.0]] * 6, 0.02))


def test_property_an_fmu_without_a_variable_says_which(drive: Path, tmp_path: Path) -> None:
    bekker.export_fmu("gentle_velocity", tmp_path / "other.fmu")
    with pytest.raises(bekker.ModelError, match=r"no variable `wheel\[1\].torque_command`"):
        bekker.check(drive, on="fmu", fmu=tmp_path / "other.fmu")
    (tmp_path / "none.fmu").write_text("no archive")
    with pytest.raises(bekker.ModelError, match=r"none.fmu` cannot be unpacked"):
        bekker.check(drive, on="fmu", fmu=tmp_path / "none.fmu")


def test_property_an_fmu_of_another_model_takes_the_scripts_parameters(tmp_path: Path) -> None:
    script = tmp_path / "drive.toml"
    script.write_text(
        "interval = 0.02\nduration = 0.6\n[model]\npreset = 'gentle_velocity'\n[model.parameters]\nsoil.cohesion = 700.0\n"
        "[inputs]\nvelocity_command = 0.2\n[expect]\nsignals = 'drive.csv'\ntolerance = { default = 0.0 }\n"
    )
    bekker.Script(script, to_record=True).record()
    bekker.export_fmu("gentle_velocity", tmp_path / "plain.fmu", fmi=2)
    report = bekker.check(script, on="fmu", fmu=tmp_path / "plain.fmu")
    assert report, str(report)


def test_property_wrong_calls_are_refused(drive: Path, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="missing.toml"):
        bekker.check(tmp_path / "missing.toml")
    with pytest.raises(bekker.InputError, match="expected core, fmu, environment"):
        bekker.check(drive, on="simulink")
    drive.write_text("interval = 0.02\nduration = 0.1\nmodel = 'two_weeled'\n[expect]\nstatus = 'running'")
    with pytest.raises(bekker.ModelError, match="unknown preset `two_weeled`"):
        bekker.check(drive)


def test_property_exit_codes(drive: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = tmp_path / "good.toml"
    good.write_text("interval = 0.02\nduration = 0.1\nmodel = 'two_wheeled'\n[expect]\nstatus = 'running'")
    assert main([str(good)]) == 0
    assert main([str(good), str(drive)]) == 1
    assert main([str(good), str(tmp_path / "missing.toml"), "--on", "core"]) == 2
    out = capsys.readouterr()
    assert out.out.count("ok  ") == 3 and "missing.toml" in out.err
    run = subprocess.run([sys.executable, "-m", "bekker", "check", str(drive)], stdout=subprocess.PIPE, text=True)
    assert run.returncode == 1 and run.stdout.startswith("FAIL drive on environment")
