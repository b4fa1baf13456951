"""What the tests share: rovers, terrains and commands drawn at random, and a diagnosis."""

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from sand_wheel import sand

import bekker

# Soil, vehicle and effects that a drawn model changes, with ranges that leave a rover able to drive.
RANGES = {
    "gravity": (1.6, 12.0),
    "rover.centre_of_mass_x": (-0.05, 0.05),
    "soil.cohesion": (300.0, 2000.0),
    "soil.friction_angle": (0.45, 0.65),
    "soil.exponent": (0.8, 1.1),
    "soil.shear_modulus": (0.008, 0.03),
    "slip_sinkage.n1": (0.0, 0.3),
    "drag.force": (0.0, 1.0),
}
# Every preset, and drives that hold their wheel speeds themselves, which no preset has.
KINDS = [*((preset, "") for preset in bekker.presets()), ("two_wheeled", "[control]\nkind = 'speed_loop'\n")]
SEEDS = range(3 * len(KINDS))
TERRAINS = (
    "preset = 'waves'\namplitude = {a}\nwavelength = 1.7\nstart = 0.2",
    "preset = 'slope'\nslope = {a}",
    "preset = 'random'\nseed = {seed}",
)


def core_program(name: str) -> Path:
    """A program of the core's, an example of the root package: from BEKKER_EXAMPLES, where the Rust tests have just built
    all of them, or built here."""
    built = os.environ.get("BEKKER_EXAMPLES")
    if built is not None:
        return Path(built) / name
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("needs cargo")
    build = [cargo, "build", "--quiet", "--example", name, "--message-format", "json"]
    root = Path(__file__).resolve().parents[2]
    lines = subprocess.run(build, cwd=root, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    programs = [json.loads(line).get("executable") for line in lines]
    return Path(next(program for program in reversed(programs) if program))


@dataclass
class Drive:
    """A model and commands for it: one row a period, of `steps` inner steps."""

    model: bekker.Model
    commands: NDArray[np.float64]
    steps: int


def drawn(seed: int) -> Drive:
    """A random rover on random ground under random commands."""
    random = np.random.default_rng(seed)
    preset, control = KINDS[seed % len(KINDS)]
    terrain = TERRAINS[random.integers(len(TERRAINS))].format(a=random.uniform(0.01, 0.05), seed=random.integers(1000))
    model = bekker.Model.from_toml(f"preset = '{preset}'\n{control}[terrain]\n{terrain}")
    names = {variable["name"] for variable in model.parameters()}
    for name, (low, high) in RANGES.items():
        assert name in names, name
        model.set(name, random.uniform(low, high))
    # Everything else a little, but for periods (whole numbers of steps) and neutral values.
    for variable in model.parameters():
        name, value = variable["name"], variable["value"]
        if name not in RANGES and not name.endswith("period") and value != 0.0:
            varied = value * random.uniform(0.95, 1.05)
            model.set(name, min(max(varied, variable["min"]), variable["max"]))
    usual = {"speed": 5.0, "speed_loop": 5.0, "velocity": 0.4, "rtc": 0.4, "rtc_speed": 0.4}
    largest = 0.2 * model.total_mass if model.control == "torque" else usual[model.control]
    commands = np.repeat(random.uniform(-0.2, 1.0, (20, len(model.inputs()))), 5, axis=0) * largest
    return Drive(model, commands, steps=10)


@pytest.fixture
def drive(request: pytest.FixtureRequest) -> Drive:
    return drawn(request.param)


@pytest.fixture(scope="session")
def diagnosis() -> bekker.Diagnosis:
    return sand()
