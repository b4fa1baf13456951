"""The shipped single-wheel experiment and a quick diagnosis of it."""

import csv
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

import bekker

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
