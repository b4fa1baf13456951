"""`diagnose` gives the core's numbers to the last digit, wherever the data come from and the fits are made."""

import dataclasses
import json
import pickle
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import core_program
from sand_wheel import CANDIDATES, DRAWS, ROOT, SAND, as_arrays

import bekker


def core_json() -> Any:
    """What the Rust program `core_diagnosis` says, which shares nothing with the Python door."""
    program = core_program("core_diagnosis")
    command = [program, str(SAND), str(DRAWS), *CANDIDATES]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)


def test_agreement_json_equals_the_core(diagnosis: bekker.Diagnosis) -> None:
    assert json.loads(diagnosis.to_json()) == core_json()
    assert json.loads(diagnosis.to_json(indent=2)) == json.loads(diagnosis.to_json())


def test_property_objects_hold_the_numbers_of_the_json(diagnosis: bekker.Diagnosis) -> None:
    said = json.loads(diagnosis.to_json())
    assert (diagnosis.verdict, diagnosis.effects) == (said["verdict"], said["effects"]) == ("effect_missing", ["slip_sinkage"])
    assert {name: floor.value for name, floor in diagnosis.noise_floor.items()} == said["noise_floor"]
    assert [step.rmse for step in diagnosis.steps] == [step["rmse"] for step in said["steps"]]
    assert [step.heldout_rmse for step in diagnosis.steps] == [step["heldout_rmse"] for step in said["steps"]]
    for step, other in zip(diagnosis.steps, said["steps"], strict=True):
        assert {p.name: p.value for p in step.parameters} == {n: p["value"] for n, p in other["parameters"].items()}
        assert {p.name for p in step.parameters if p.effect} == ({"slip_sinkage.n1", "slip_sinkage.growth", "slip_sinkage.carried"} if step.added else set())
    for parameter in diagnosis.steps[-1].parameters:
        assert parameter.left_off == (parameter.effect and parameter.at_bound and parameter.value == 0.0)
    assert [c.effect for c in diagnosis.candidates] == [c["effect"] for c in said["candidates"]]
    assert [c.probability for c in diagnosis.candidates] == [c["probability"] for c in said["candidates"]]
    assert diagnosis.share.other == said["probability_other"] and diagnosis.share.enough == said["probability_enough"]
    for profile, other in zip(diagnosis.profiles, said["profiles"], strict=True):
        assert np.column_stack([profile.values, profile.rise]).tolist() == other["profile"]
    residual = diagnosis.steps[-1].fit.signal("torque").residual
    assert diagnosis.steps[-1].rmse["torque"] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-12)
    assert "effect missing: slip_sinkage" in str(diagnosis)
    with pytest.raises(bekker.UnknownNameError, match="slip_sinkage"):
        diagnosis.candidate("slip_sinkage_")


def test_property_objects_have_the_keys_of_the_schema() -> None:
    schema = json.loads((ROOT / "src" / "diagnosis" / "diagnose" / "result.schema.json").read_text())
    places: list[tuple[str, tuple[type, ...]]] = [
        ("properties", (bekker.Diagnosis, bekker.findings.Share)),
        ("properties/noise_models/additionalProperties/properties", (bekker.findings.NoiseModel,)),
        ("properties/pairs/items/properties", (bekker.findings.Pair,)),
        ("properties/lack_of_fit/properties", (bekker.findings.LackOfFit,)),
        ("properties/suggestions/items/properties", (bekker.findings.Suggestion,)),
        ("$defs/rows/items/properties", (bekker.comparison.UnansweredRows,)),
        ("properties/uncounted/items/properties", (bekker.comparison.UncountedRows,)),
        ("$defs/step/properties", (bekker.findings.Step,)),
        ("$defs/candidate/properties", (bekker.findings.Candidate,)),
        ("$defs/curves/properties", (bekker.curves.Curves,)),
        ("$defs/curves/properties/groups/items/properties", (bekker.curves.CurveGroup,)),
    ]
    for place, kinds in places:
        part = schema
        for key in place.split("/"):
            part = part[key]
        fields = [field for kind in kinds for field in dataclasses.fields(kind)]
        assert set(part) <= {field.metadata.get("json_key", field.name) for field in fields}, place


@pytest.mark.parametrize(
    "convert",
    [lambda frame: frame, lambda frame: {c: frame[c].to_numpy() for c in frame}, lambda frame: frame.to_records(index=False)],
    ids=["pandas", "dict", "structured"],
)
def test_agreement_data_from_arrays_equal_the_folder(diagnosis: bekker.Diagnosis, convert: Any) -> None:
    found = bekker.diagnose(as_arrays(convert), candidates=CANDIDATES, draws=DRAWS)
    assert found.to_json() == diagnosis.to_json()


def test_property_an_experiment_is_saved_as_a_folder(diagnosis: bekker.Diagnosis, tmp_path: Path) -> None:
    experiment = as_arrays(lambda frame: frame)
    experiment.save(tmp_path)
    assert bekker.compare(tmp_path).fit.rmse == bekker.compare(SAND).fit.rmse == bekker.compare(experiment).fit.rmse
    with pytest.raises(FileExistsError):
        experiment.save(tmp_path)


def test_property_the_improved_model_is_one(diagnosis: bekker.Diagnosis, tmp_path: Path) -> None:
    n1 = next(p.value for p in diagnosis.steps[-1].parameters if p.name == "slip_sinkage.n1")
    assert n1 > 0.0 and diagnosis.improved.get("slip_sinkage.n1") == n1
    diagnosis.save_model(tmp_path / "improved.toml")
    assert diagnosis.improved.kind == "carriage", "a single wheel was measured, and no rover is named"
    points = bekker.steady_points(tmp_path / "improved.toml", 20.0, [0.1, 0.4], 0.5)
    same, before = (bekker.steady_points(model, 20.0, [0.1, 0.4], 0.5) for model in (diagnosis.improved, "two_wheeled"))
    assert np.array_equal(points["sinkage"], same["sinkage"]) and points["sinkage"].shape == (2,)
    assert not np.any(points["sinkage"] == before["sinkage"])
    with pytest.raises(bekker.ModelError, match="wheel on a carriage"):
        bekker.simulate(diagnosis.improved)
    rover = bekker.Model.from_preset("two_wheeled").with_rig_of(diagnosis.improved)
    rover.check_drive()
    assert rover.kind == "rover" and rover.get("slip_sinkage.n1") == n1
    # The effect lives in the model: compared again, without any fit, it leaves what the diagnosis said.
    again = bekker.compare(SAND, diagnosis.improved)
    assert again.fit.rmse == pytest.approx(diagnosis.steps[-1].rmse, rel=1e-9)
    env = bekker.RoverEnv(model=rover)
    env.reset(seed=0)
    env.close()


def test_property_a_diagnosis_travels(diagnosis: bekker.Diagnosis) -> None:
    copy = pickle.loads(pickle.dumps(diagnosis))
    assert copy.to_json() == diagnosis.to_json() and copy.steps[0].rmse == diagnosis.steps[0].rmse
    assert copy.improved.to_toml() == diagnosis.improved.to_toml()


def test_property_the_report_is_one_page(diagnosis: bekker.Diagnosis, tmp_path: Path) -> None:
    diagnosis.save_html(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert page.lstrip().lower().startswith("<!doctype html") and "slip_sinkage" in page
    with pytest.raises(bekker.BekkerError, match="pickled"):
        pickle.loads(pickle.dumps(diagnosis)).save_html(tmp_path / "other.html")


def test_property_calibrate_with_an_effect(diagnosis: bekker.Diagnosis, tmp_path: Path) -> None:
    plain, added = bekker.calibrate(SAND), bekker.calibrate(SAND, added=["slip_sinkage"])
    assert added.calibration is not None and plain.calibration is not None
    names = {parameter.name for parameter in added.calibration.parameters}
    assert names - {parameter.name for parameter in plain.calibration.parameters} >= {"slip_sinkage.n1"}
    assert added.fit.rmse["sinkage"] < 0.5 * plain.fit.rmse["sinkage"]
    assert bekker.compare(SAND, added.model).fit.rmse == pytest.approx(added.fit.rmse, rel=1e-9)
    added.save_model(tmp_path / "calibrated.toml")
    assert bekker.Model.read(tmp_path / "calibrated.toml").to_toml() == added.model.to_toml()
    assert bekker.compare(SAND, calibrate=True, added=["slip_sinkage"]).fit.rmse == added.fit.rmse
    with pytest.raises(bekker.InputError, match="calibrate=True"):
        bekker.compare(SAND, added=["slip_sinkage"])


def test_property_an_added_effect_is_part_of_the_baseline() -> None:
    found = bekker.diagnose(
        SAND, candidates=["exit_angle"], added=["slip_sinkage"], draws=DRAWS
    )
    assert found.effects == [] and [c.effect for c in found.candidates] == ["exit_angle"]
    assert "slip_sinkage.n1" in {parameter.name for parameter in found.steps[0].parameters}


def test_property_bad_arguments_are_named() -> None:
    with pytest.raises(bekker.UnknownNameError, match="no candidate effect `slip_sinkag`"):
        bekker.diagnose(SAND, candidates=["slip_sinkag"])
    with pytest.raises(bekker.InputError, match="candidates: expected a list of names"):
        bekker.diagnose(SAND, candidates="slip_sinkage")
    for options, message in (({"draws": 99}, "draws = 99"), ({"windows": 7}, "windows = 7"), ({"max_effects": -1}, "max_effects = -1")):
        with pytest.raises(bekker.InputError, match=message):
            bekker.diagnose(SAND, **options)
    with pytest.raises(bekker.InputError, match="expected a folder or a bekker.Experiment, found dict"):
        bekker.diagnose({})
    with pytest.raises(bekker.ModelError, match=r"no_such.*experiment\.toml"):
        bekker.diagnose("no_such")
