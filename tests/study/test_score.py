"""The rules of scoring, on made-up diagnoses. `python3 -m pytest tests/study`."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import plan  # noqa: E402, F401  (puts the generators on the path)
import score  # noqa: E402
import table  # noqa: E402

import alike  # noqa: E402
import bench_wheel  # noqa: E402
import cases  # noqa: E402
import detect  # noqa: E402


def effect(case, ties=(), outside=False, visible=True):
    return {"case": case, "allowed_ties": list(ties), "outside": outside, "visible": visible}


def said(verdict, *effects, tied=(), confused=(), beside=()):
    candidates = [{"effect": name, "tied": True} for name in tied]
    result = {"verdict": verdict, "effects": list(effects), "candidates": candidates, "confused_with": [list(c) for c in confused]}
    return result | {"possible_beside": list(beside)}


def test_analytic_what_a_condition_is_besides_is_not_wrong():
    late = {"conditions": ["delay"]}
    assert score.outcome({"case": "clean", "effects": [], **late}, said("effect_missing", "sensor_lag")) == "right"
    assert score.outcome({"case": "clean", "effects": []}, said("effect_missing", "sensor_lag")) == "false_alarm"
    assert score.outcome({"case": "a", "effects": [effect("a")], **late}, said("effect_missing", "a", "sensor_lag")) == "right"
    assert score.outcome({"case": "a", "effects": [effect("a")], **late}, said("effect_missing", "b", "sensor_lag")) == "wrong"
    tie = said("undetermined", tied=("a", "b", "tracking_delay"))
    assert score.outcome({"case": "a", "effects": [effect("a", ["b"])], **late}, tie) == "right_tie"
    assert score.outcome({"case": "a", "effects": [effect("a", ["b"])]}, tie) == "broad_tie"
    open_beside = lambda *names: score.outcome({"case": "a", "effects": [effect("a", ["b"])], **late}, said("effect_missing", "tracking_delay", beside=names))
    assert open_beside("a", "b") == "right_tie"
    assert open_beside("a", "b", "sensor_lag") == "right_tie"
    assert open_beside("b", "c") == "missed"
    assert open_beside("a", "c") == "broad_tie"
    nothing = {"case": "clean", "effects": [], **late}
    assert score.outcome(nothing, said("effect_missing", "tracking_delay", beside=["a"])) == "false_alarm"
    hidden = {"case": "sensor_lag", "effects": [effect("sensor_lag")], **late}
    assert score.outcome(hidden, said("effect_missing", "sensor_lag")) == "right"


CASES = [
    ("clean", [], said("explained"), "right"),
    ("clean", [], said("effect_missing", "drag"), "false_alarm"),
    ("clean", [], said("undetermined"), "false_alarm"),
    ("a", [effect("a")], said("effect_missing", "a"), "right"),
    ("a", [effect("a")], said("effect_missing", "b"), "wrong"),
    ("a", [effect("a")], said("effect_missing", "a", "b"), "extra"),
    ("a", [effect("a", ["b"])], said("effect_missing", "b"), "wrong"),
    ("a", [effect("a", ["b"])], said("effect_missing", "b", confused=[("a", "b")]), "wrong"),
    ("a", [effect("a", ["b"])], said("undetermined", tied=("a", "b")), "right_tie"),
    ("a", [effect("a")], said("undetermined", tied=("a", "b", "c")), "broad_tie"),
    ("a", [effect("a", ["b"])], said("undetermined", tied=("a",)), "right_tie"),
    ("a", [effect("a", "bcd")], said("undetermined", tied="abcd"), "broad_tie"),
    ("a", [effect("a", ["b"])], said("undetermined", tied=("b",)), "undecided"),
    ("a+b", [effect("a", ["c"]), effect("b")], said("undetermined", tied=("a", "b", "c")), "right_tie"),
    ("a+b", [effect("a"), effect("b")], said("undetermined", tied=("a", "b", "c")), "undecided"),
    ("a", [effect("a")], said("undetermined", tied=("b", "c")), "undecided"),
    ("a", [effect("a")], said("unexplained", "a"), "partial"),
    ("a", [effect("a")], said("explained"), "missed"),
    ("a", [effect("a", visible=False)], said("explained"), "cautious"),
    ("a", [effect("a", visible=False)], said("effect_missing", "b"), "wrong"),
    ("hump", [effect("hump", outside=True)], said("unexplained", "drag"), "right"),
    ("hump", [effect("hump", outside=True)], said("effect_missing", "drag"), "wrong"),
    ("a+b", [effect("a"), effect("b")], said("effect_missing", "b", "a"), "right"),
    ("a+b", [effect("a"), effect("b")], said("effect_missing", "a"), "one_of_two"),
    ("a+b", [effect("a"), effect("b")], said("effect_missing", "a", "c"), "wrong"),
    ("a+b", [effect("a"), effect("b")], said("effect_missing", "a", beside=["b"]), "right_tie"),
    ("a+b", [effect("a"), effect("b", ["c"])], said("effect_missing", "a", beside=["b", "c"]), "right_tie"),
    ("a+b", [effect("a"), effect("b")], said("effect_missing", "a", beside=["b", "c"]), "one_of_two"),
    ("a+b", [effect("a"), effect("b", "cde")], said("effect_missing", "a", beside="bcde"), "one_of_two"),
    ("a", [effect("a")], said("effect_missing", "a", beside=["b"]), "right"),
    ("a", [effect("a")], said("effect_missing", "b", beside=["a"]), "wrong"),
    ("wrong_prior", [], said("effect_missing", "a"), "wrong"),
    ("wrong_prior", [], said("unexplained"), "cautious"),
    ("poor", [effect("a")], said("undetermined", tied=("a", "b")), "cautious"),
    ("a", [effect("a")], {"error": "no diagnosis"}, "error"),
]


@pytest.mark.parametrize("case, effects, result, expected", CASES)
def test_property_outcome(case, effects, result, expected):
    assert score.outcome({"case": case, "effects": effects}, result) == expected


def test_analytic_removed_share():
    truth = {"effects": [effect("a")], "deviation": {"x": 1.0}}
    step = lambda rmse: {"heldout_rmse": {"x": rmse}}
    assert score.removed_share(truth, {"steps": [step(3.0), step(1.0)]}) == pytest.approx(1.0)
    assert score.removed_share(truth, {"steps": [step(3.0), step(5.0**0.5)]}) == pytest.approx(0.5)
    assert score.removed_share(truth, {"steps": [step(1.1), step(1.0)]}) is None


def test_published_wilson_interval():
    # Newcombe 1998, Statistics in Medicine 17: 81 of 263 gives 0.2553 .. 0.3662.
    assert table.wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)


def test_property_what_was_said_beside_the_truth_is_judged_where_that_counts():
    detector = detect.Detector(bench_wheel.WheelBench(5), 0.02, 3, cases.library(cases.WHEEL))
    hidden = lambda case, form, outside=False: {"case": case, "form": form, "strength": 0.2, "outside": outside}
    effects = [hidden("gear_efficiency", "constant")]
    result = said("undetermined", tied=("gear_efficiency", "torque_scale", "tether"))
    assert alike.beside(effects, result) == ["tether", "torque_scale"]
    alike.judge(detector, cases.WHEEL, effects, alike.beside(effects, result))
    # A tether is no effect of a wheel on a carriage.
    assert set(effects[0]["cosines"]) == {"torque_scale"} and effects[0]["allowed_ties"] == ["torque_scale"]
    # Of a pair each has its own look-alikes.
    pair = [hidden("gear_efficiency", "constant"), hidden("slip_sinkage", "ding")]
    alike.judge(detector, cases.WHEEL, pair, ["torque_scale"])
    assert pair[0]["allowed_ties"] == ["torque_scale"] and pair[1]["allowed_ties"] == []
    # An outsider has none, and where nothing was said no fit is made.
    outside = [hidden("hump", "slip", outside=True)]
    alike.judge(None, cases.WHEEL, outside, ["drag"])
    alike.judge(None, cases.WHEEL, effects, alike.beside(effects, {"error": "stopped"}))
    assert outside[0]["allowed_ties"] == effects[0]["allowed_ties"] == []


def test_property_forms_that_joined_later_stand_behind_all_others_once_a_seed():
    seeds = 3
    jobs = plan.jobs("report", (cases.WHEEL, cases.ROVER), "reduced", None, [0.02], seeds)
    later = [(job.case, job.form) in plan.MORE_FORMS[job.kind] for job in jobs]
    assert sum(later) == seeds * sum(map(len, plan.MORE_FORMS.values()))
    assert later == sorted(later)
    assert len({job.name for job in jobs}) == len(jobs)
