"""Several experiments on one soil from Python."""

import json
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import bekker
import numpy as np
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SLIPS = np.array([0.02, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
NOISE = {"drawbar_pull": 0.2, "torque": 0.02, "sinkage": 2e-4}  # N, N m, m
QUICK = {"candidates": ["slip_sinkage", "torque_scale"], "draws": 199}


def wheel(name, width, n1, seed):
    """A wheel of this width with slip-sinkage n1, measured three times."""
    rng = np.random.default_rng(seed)
    changed = {"wheel.width": width, "slip_sinkage.n1": n1}
    runs = []
    for load in (25.0, 50.0):
        points = bekker.steady_points("two_wheeled", load, SLIPS, 0.5, changed)
        for _ in range(3):
            columns = {"load": np.full(SLIPS.size, load), "slip": SLIPS, "wheel_speed": np.full(SLIPS.size, 0.5)}
            columns |= {signal: points[signal] + noise * rng.standard_normal(SLIPS.size) for signal, noise in NOISE.items()}
            runs.append(bekker.MeasuredRun(columns, group=f"load{load:g}"))
    return bekker.Experiment(name=name, kind="single_wheel", parameters={"wheel.width": width}, runs=runs)


@pytest.fixture(scope="module")
def pair():
    return [wheel("narrow", 0.10, 0.0, 1), wheel("wide", 0.16, 0.25, 2)]


def test_agreement_the_effect_is_named_with_its_place(pair):
    found = bekker.diagnose(pair, **QUICK)
    assert (found.verdict, found.effects, found.where) == ("effect_missing", ["slip_sinkage"], {"slip_sinkage": ["wide"]})
    assert list(found.improved_parts) == ["narrow", "wide"]
    strengths = [model.get("slip_sinkage.n1") for model in found.improved_parts.values()]
    assert strengths[0] == 0.0 and abs(strengths[1] - 0.25) < 0.05
    assert set(found.noise_floor) == {f"{part}.{signal}" for part in ("narrow", "wide") for signal in NOISE}


def test_agreement_an_executor_gives_the_same_bits(pair):
    here = bekker.diagnose(pair, soil_scatter=0.02, **QUICK)
    with ThreadPoolExecutor(2) as pool:
        there = bekker.diagnose(pair, soil_scatter=0.02, executor=pool, **QUICK)
    assert json.loads(here.to_json()) == json.loads(there.to_json())


def test_property_a_calibration_of_several_has_a_model_of_each(pair):
    together = bekker.calibrate(pair, soil_scatter=0.0)
    names = [parameter.name for parameter in together.calibration.parameters]
    # Two widths tell k_c from k_phi.
    assert "soil.k_c" in names and len(names) == len(set(names))
    assert list(together.part_models) == ["narrow", "wide"]
    assert {model.get("soil.k_phi") for model in together.part_models.values()} == {together.part_models["wide"].get("soil.k_phi")}
    assert together.soil is not None


@pytest.mark.parametrize("experiment", [EXAMPLES / "sand_wheel", [EXAMPLES / "sand_wheel"]])
def test_property_a_single_experiment_has_no_place(experiment):
    found = bekker.diagnose(experiment, **QUICK)
    assert (found.where, found.improved_parts, found.effects) == ({}, {}, ["slip_sinkage"])


@pytest.mark.parametrize(
    ("experiments", "scatter", "words"),
    [
        ([], None, "at least two"),
        (EXAMPLES / "sand_wheel", 0.05, "soil_scatter: expected several experiments"),
        ([EXAMPLES / "sand_wheel", EXAMPLES / "sand_plates"], 0.9, "from 0 to 0.5"),
        ([EXAMPLES / "sand_wheel", EXAMPLES / "sand_plates"], "much", "soil_scatter: expected a share"),
        ([EXAMPLES / "sand_wheel", 3], None, "expected a folder"),
    ],
)
def test_property_what_is_no_set_is_refused(experiments, scatter, words):
    with pytest.raises(bekker.InputError, match=words):
        bekker.diagnose(experiments, soil_scatter=scatter, **QUICK)


def test_property_each_of_several_has_its_page_with_the_effects_that_were_tried(pair, tmp_path):
    bekker.diagnose(pair, **QUICK).save_html(tmp_path / "report.html")
    assert sorted(page.name for page in tmp_path.iterdir()) == ["report-narrow.html", "report-wide.html"]
    for page in tmp_path.iterdir():
        text = page.read_text(encoding="utf-8")
        saved = json.loads(re.search(r'<script[^>]*id="saved"[^>]*>(.*?)</script>', text, re.DOTALL)[1])
        # The wheels have one effect under its plain name, wherever it was tried; both can be moved.
        assert [found["effects"] for found in saved["snapshot"]["found"]] == [[], ["slip_sinkage"], ["torque_scale"]]
        assert {response["parameter"] for response in saved["responses"]} == {"slip_sinkage.n1", "slip_sinkage.growth", "slip_sinkage.carried", "torque_scale.deviation"}
        assert {candidate["effect"] for candidate in saved["snapshot"]["diagnosis"]["candidates"]} == {"slip_sinkage", "torque_scale"}
        assert "fitted together" in text


def test_property_what_is_shared_is_said_by_name():
    tests = [EXAMPLES / "sand_plates", EXAMPLES / "sand_shear"]
    apart = bekker.calibrate(tests, share=[])
    names = {parameter.name for parameter in apart.calibration.parameters}
    assert {"soil in sand_plates.k_phi", "soil in sand_shear.cohesion"} <= names
    assert "a soil of its own in each experiment" in apart.sources


def test_property_what_is_shared_is_read_from_the_experiments():
    columns = {"load": np.array([30.0, 30.0, 30.0]), "slip": SLIPS[:3], "wheel_speed": np.full(3, 0.5), "torque": np.ones(3)}
    with pytest.raises(bekker.InputError, match="soul"):
        bekker.Experiment(kind="single_wheel", runs=[columns], shared={"soul": "pit"})
    assert bekker.Experiment(kind="single_wheel", runs=[columns], shared={"soil": "pit"}).shared == {"soil": "pit"}


@pytest.mark.parametrize(
    ("experiments", "share", "message"),
    [
        (["sand_plates", "sand_shear"], ["wheels"], "share: expected some of soil, vehicle, drive"),
        (["sand_plates", "sand_shear"], "soil", "in a list"),
        (["sand_wheel"], ["soil"], "share: expected several experiments"),
    ],
)
def test_property_what_cannot_be_shared_is_refused(experiments, share, message):
    folders = [EXAMPLES / name for name in experiments]
    with pytest.raises(bekker.InputError, match=message):
        bekker.calibrate(folders if len(folders) > 1 else folders[0], share=share)
