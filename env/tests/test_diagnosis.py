"""`diagnose` gives the core's numbers to the last digit, wherever the data come from and the fits are made."""

import csv
import dataclasses
import json
import pickle
import signal
import subprocess
import sys
import threading
import tomllib
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from conftest import core_program

import bekker
from bekker.levels import levels, set_points, smooth

mpl.use("Agg")

ROOT = Path(__file__).parents[2]
SAND = ROOT / "examples" / "sand_wheel"
# The hidden effect, its nearest rival and one that a wheel at a steady point does not show: quick, and pairs are tried.
CANDIDATES = ["slip_sinkage", "exit_angle", "coulomb_friction"]
DRAWS = 199


def sand(**options: Any) -> bekker.Diagnosis:
    return bekker.diagnose(SAND, candidates=CANDIDATES, draws=DRAWS, **options)


def frame(path: Path) -> pd.DataFrame:
    # Not by pandas' reader, whose numbers may be off in the last digit.
    with path.open() as file:
        return pd.DataFrame([{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)])


def as_arrays(convert: Callable[[pd.DataFrame], Any]) -> bekker.Experiment:
    """The shipped experiment without its folder."""
    settings = tomllib.loads((SAND / "experiment.toml").read_text())
    runs = [
        bekker.MeasuredRun(
            convert(frame(SAND / run["file"])), run["file"].removesuffix(".csv"), group=run.get("group"),
            parameters=run.get("parameters", {}),
        )
        for run in settings["run"]
    ]
    shared = {key: settings.get(key, {}) for key in ("parameters", "priors", "noise")}
    return bekker.Experiment(settings["kind"], runs, settings["name"], ignore=settings.get("ignore", []), **shared)


@pytest.fixture(scope="module")
def diagnosis() -> bekker.Diagnosis:
    return sand()


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
        assert {p.name for p in step.parameters if p.effect} == ({"slip_sinkage.n1"} if step.added else set())
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
        ("properties", (bekker.Diagnosis, bekker.diagnosis.Share)),
        ("properties/noise_models/additionalProperties/properties", (bekker.diagnosis.NoiseModel,)),
        ("properties/pairs/items/properties", (bekker.diagnosis.Pair,)),
        ("properties/lack_of_fit/properties", (bekker.diagnosis.LackOfFit,)),
        ("properties/suggestions/items/properties", (bekker.diagnosis.Suggestion,)),
        ("properties/unanswered/items/properties", (bekker.comparison.UnansweredRows,)),
        ("$defs/step/properties", (bekker.diagnosis.Step,)),
        ("$defs/candidate/properties", (bekker.diagnosis.Candidate,)),
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


class Counting(Executor):
    """Another executor that counts what it is given, and makes the last task first."""

    def __init__(self) -> None:
        self.waiting: list[tuple[Future[Any], Callable[..., Any], tuple[Any, ...]]] = []
        self.made = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        counting, (module, name) = self, (fn.__module__, fn.__qualname__)
        assert getattr(sys.modules[module], name) is fn, "a worker finds the function by its name"

        class Late(Future[Any]):
            def result(self, timeout: float | None = None) -> Any:
                while counting.waiting:
                    future, work, given = counting.waiting.pop()
                    future.set_result(work(*given))
                    counting.made += 1
                return super().result(timeout)

        future = Late()
        self.waiting.append((future, fn, args))
        return future


def test_agreement_an_executor_changes_nothing(diagnosis: bekker.Diagnosis) -> None:
    counting = Counting()
    assert sand(executor=counting).to_json() == diagnosis.to_json()
    assert counting.made >= len(CANDIDATES)
    with ThreadPoolExecutor(2) as pool:
        assert sand(executor=pool).to_json() == diagnosis.to_json()


@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_agreement_processes_change_nothing(diagnosis: bekker.Diagnosis, method: str) -> None:
    with warnings.catch_warnings():
        # Newer Pythons warn of forks beside threads; a worker waits for no thread of its parent.
        warnings.simplefilter("ignore", DeprecationWarning)
        with ProcessPoolExecutor(2, mp_context=get_context(method)) as pool:
            found = bekker.diagnose(as_arrays(lambda frame: frame), candidates=CANDIDATES, draws=DRAWS, executor=pool)
    assert found.to_json() == diagnosis.to_json()


class Broken(Executor):
    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        raise ZeroDivisionError("no machine")


def test_property_what_others_raise_is_raised(diagnosis: bekker.Diagnosis) -> None:
    with pytest.raises(ZeroDivisionError, match="no machine"):
        sand(executor=Broken())

    def stop(progress: bekker.Progress) -> None:
        if progress.done > 0.0:
            raise LookupError(progress.stage)

    with pytest.raises(LookupError, match="noise"):
        sand(progress=stop)
    with pytest.raises(bekker.InputError, match="executor: expected a concurrent.futures.Executor, found int"):
        sand(executor=3)
    # Nothing of that is left behind.
    assert sand().to_json() == diagnosis.to_json()


def test_property_progress_is_told(diagnosis: bekker.Diagnosis) -> None:
    told: list[bekker.Progress] = []
    threads: set[int] = set()

    def tell(progress: bekker.Progress) -> None:
        told.append(progress)
        threads.add(threading.get_ident())

    assert sand(progress=tell).to_json() == diagnosis.to_json()
    assert threads == {threading.get_ident()}
    assert told[0].done == 0.0 and told[0].remaining is None and told[-1].done == 1.0
    assert all(0.0 <= p.done <= 1.0 for p in told) and "calibrating" in str(told[0])
    assert all(a.done <= b.done and a.elapsed <= b.elapsed for a, b in zip(told, told[1:], strict=False))
    assert any("slip_sinkage + exit_angle" in p.trying or p.trying.startswith("slip_sinkage (") for p in told)
    assert told[-1].remaining == 0.0


def test_property_a_budget_of_time_lists_what_was_not_tried(diagnosis: bekker.Diagnosis) -> None:
    short = sand(time_budget=1e-3)
    assert short.not_tried and not short.interrupted and not diagnosis.not_tried
    assert short.verdict == "undetermined" and not any(candidate.refitted for candidate in short.candidates)
    assert short.steps[0].rmse == diagnosis.steps[0].rmse and short.smallest_p == diagnosis.smallest_p
    # Plenty of time changes nothing.
    assert sand(time_budget=1e4).to_json() == diagnosis.to_json()
    for wrong in (0.0, -1.0, float("nan"), "long"):
        with pytest.raises(bekker.InputError, match="time_budget"):
            sand(time_budget=wrong)


@pytest.fixture
def ctrl_c() -> Iterator[None]:
    """Ctrl-C as in a terminal: a process started in the background by a script ignores it, and hands that down."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("ctrl_c")
def test_property_ctrl_c_leaves_what_was_found(diagnosis: bekker.Diagnosis) -> None:
    pressed: list[str] = []

    def press(progress: bekker.Progress) -> None:
        # Once: a second time ends the work without a result.
        if "left out" in progress.stage and not pressed:
            pressed.append(progress.stage)
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(bekker.DiagnosisInterrupted) as caught:
        sand(progress=press)
    assert isinstance(caught.value, KeyboardInterrupt) and not isinstance(caught.value, Exception)
    partial = caught.value.partial
    assert partial is not None and partial.interrupted and not diagnosis.interrupted
    # After a stop the baseline's values come from those with derivatives, whose rounding differs.
    assert partial.steps[0].rmse == pytest.approx(diagnosis.steps[0].rmse, rel=1e-12) and not partial.profiles
    with pytest.raises(bekker.InputError, match="interrupted"):
        partial.plot_profiles()


@pytest.mark.usefixtures("ctrl_c")
def test_property_ctrl_c_during_fits_elsewhere() -> None:
    class Pressing(Executor):
        def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            signal.raise_signal(signal.SIGINT)
            return Future()

    with pytest.raises(bekker.DiagnosisInterrupted) as caught:
        sand(executor=Pressing())
    assert caught.value.partial is None or caught.value.partial.interrupted


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


ROW = {"load": [30.0, 30.0], "slip": [0.1, 0.2], "wheel_speed": [0.2, 0.2], "sinkage": [0.012, 0.014]}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sinkage": [0.012, np.inf]}, r"run `run1`, row 1, column `sinkage`: `inf` is not a finite number"),
        ({"slip": [0.1, np.nan]}, r"run `run1`, row 1, column `slip`: an input may not be missing"),
        ({"slip": [10.0, 20.0]}, r"run `run1`, row 0, column `slip`: 10 cannot be right: .*per cent"),
        ({"slip": [0.1]}, r"run `run1`, column `slip`: 1 rows where `load` has 2"),
        ({"slip": [[0.1], [0.2]]}, r"run `run1`, column `slip`: expected one number a row: the shape is \(2, 1\)"),
        ({"slip": ["a", "b"]}, r"run `run1`, column `slip`: expected one number a row"),
        ({"slop": [0.1, 0.2]}, r"run `run1`, column `slop`: unknown column"),
        ({"sinkage": [np.nan, np.nan]}, r"run `run1`: nothing is measured"),
    ],
)
def test_property_bad_data_are_named(change: dict[str, Any], message: str) -> None:
    with pytest.raises(bekker.InputError, match=message):
        bekker.Experiment("single_wheel", [ROW | change])


def test_property_bad_settings_are_named() -> None:
    with pytest.raises(bekker.InputError, match=r"experiment, key `noise\.sinkage`: a standard deviation is positive"):
        bekker.Experiment("single_wheel", [ROW], noise={"sinkage": -1.0})
    with pytest.raises(bekker.InputError, match="experiment: unknown variant `wheel`"):
        bekker.Experiment("wheel", [ROW])
    with pytest.raises(bekker.InputError, match="run `a`: 1 rows, where b|not a repeat"):
        short = {name: values[:1] for name, values in ROW.items()}
        bekker.Experiment(
            "single_wheel", [bekker.MeasuredRun(ROW, "b", group="g"), bekker.MeasuredRun(short, "a", group="g")]
        )
    with pytest.raises(bekker.InputError, match="two runs are called `a`"):
        bekker.Experiment("single_wheel", [bekker.MeasuredRun(ROW, "a"), bekker.MeasuredRun(ROW, "a")])
    with pytest.raises(bekker.InputError, match="below the experiment's folder"):
        bekker.Experiment("single_wheel", [bekker.MeasuredRun(ROW, "../a")])
    with pytest.raises(bekker.InputError, match="terrain of run `a`, row 1, column `x`"):
        commands = {"time": np.arange(12.0), "wheel[1].speed_command": np.ones(12), "pitch": np.zeros(12)}
        bekker.Experiment("traverse", [bekker.MeasuredRun(commands, "a", terrain=([0.0, -1.0], [0.0, 0.0]))])
    # Names and texts of any kind come through.
    odd = bekker.Experiment("single_wheel", [bekker.MeasuredRun(ROW, 'a "b", c')], name="ü \x7f 'q' \\ \U0001f600")
    assert odd.signals == ("sinkage",)


def test_property_missing_values_of_every_kind() -> None:
    missing = [
        [0.012, None],
        pd.array([0.012, None], dtype="Float64"),
        np.ma.MaskedArray([0.012, 7.0], [False, True]),
        pd.Series([0.012, np.nan]),
    ]
    for column in missing:
        compared = bekker.compare(bekker.Experiment("single_wheel", [ROW | {"sinkage": column}]))
        assert np.isnan(compared.fit.signal("sinkage").residual).tolist() == [False, True]


def test_property_bad_arguments_are_named() -> None:
    with pytest.raises(bekker.UnknownNameError, match="no candidate effect `slip_sinkag`"):
        bekker.diagnose(SAND, candidates=["slip_sinkag"])
    with pytest.raises(bekker.InputError, match="candidates: expected a list of names"):
        bekker.diagnose(SAND, candidates="slip_sinkage")
    for options, message in (({"draws": 99}, "draws = 99"), ({"max_effects": -1}, "max_effects = -1")):
        with pytest.raises(bekker.InputError, match=message):
            bekker.diagnose(SAND, **options)
    with pytest.raises(bekker.InputError, match="expected a folder or a bekker.Experiment, found dict"):
        bekker.diagnose({})
    with pytest.raises(bekker.ModelError, match=r"no_such.*experiment\.toml"):
        bekker.diagnose("no_such")


def test_property_levels_follow_gaps_then_counts() -> None:
    assert levels(np.array([20.0, 20.1, 40.0, np.nan, 70.0]), most=5) == [(20.0, 20.1), (40.0, 40.0), (70.0, 70.0)]
    spread = levels(np.linspace(0.0, 1.0, 100), most=4)
    assert len(spread) == 4 and all(a[1] < b[0] for a, b in zip(spread, spread[1:], strict=False))
    assert levels(np.array([3.0, 3.0]), most=4) == [(3.0, 3.0)]


def test_property_set_points_are_told_from_accidental_differences() -> None:
    held = np.array([20.1, 39.8, 60.0, 19.9, 40.3, 60.2, 40.0, 20.0, np.nan])
    assert set_points(held, 3.0) == [(19.9, 20.1), (39.8, 40.3), (60.0, 60.2)]
    assert set_points(np.array([21.6, 24.0, 24.3, 24.5, 24.8, 25.3, 26.1]), 1.3) == [(21.6, 26.1)]


def test_analytic_a_smooth_meets_a_straight_line() -> None:
    x = np.arange(20.0) ** 2
    at, y = smooth(np.append(x, np.nan), np.append(3.0 - 0.5 * x, 1.0))
    assert at[0] == 0.0 and at[-1] == 361.0
    # Rounding of sums of some twenty terms of the size of the largest.
    assert np.abs(y - (3.0 - 0.5 * at)).max() < 361.0 * 1e-12


def test_property_plots_show_the_numbers(diagnosis: bekker.Diagnosis, tmp_path: Path) -> None:
    for name in ("overlay", "residuals", "steps", "candidates", "profiles", "heatmap"):
        figure = getattr(diagnosis, f"plot_{name}")()
        figure.savefig(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000
        mpl.pyplot.close(figure)
    figure = diagnosis.plot_steps(["torque"])
    heights = [bar.get_height() for bar in figure.axes[0].patches]
    assert heights == [step.rmse["torque"] for step in diagnosis.steps]
    figure = diagnosis.plot_candidates()
    assert {bar.get_width() for bar in figure.axes[0].patches} >= {c.probability for c in diagnosis.candidates}
    figure = diagnosis.plot_overlay(["sinkage"])
    axis = figure.axes[0]
    assert (axis.get_ylabel(), axis.get_xlabel()) == ("sinkage (m)", "slip")
    # The curves that are drawn are those of the result: before and after in each group of rows.
    drawn = [line.get_ydata() for line in axis.lines if len(line.get_ydata()) > 50]
    groups = diagnosis.curves[0].groups
    last = len(diagnosis.steps) - 1
    expected = [group.curve(step, "sinkage") for group in groups for step in (0, last)]
    assert len(drawn) == len(expected) == 12
    for line, curve in zip(drawn, expected, strict=True):
        assert curve is not None and np.array_equal(line, curve.value)
    assert [curves.axis for curves in diagnosis.curves] == ["slip", "load", "wheel_speed"]
    assert diagnosis.plot_overlay(["torque"], axis="load").axes[0].get_xlabel() == "load (N)"
    with pytest.raises(bekker.UnknownNameError, match="unknown varied input `lode`"):
        diagnosis.plot_overlay(axis="lode")
    with pytest.raises(bekker.UnknownNameError, match="unknown measured signal `sinkag`"):
        diagnosis.plot_residuals(["sinkag"])
    with pytest.raises(bekker.UnknownNameError, match="unknown column `lode`"):
        diagnosis.plot_heatmap(y="lode")
    mpl.pyplot.close("all")
