"""The same inputs give the same bits in the core, through `simulate`, by stepping, and in the environment."""

import subprocess
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from conftest import SEEDS, Drive, core_program

import bekker

all_drives = pytest.mark.parametrize("drive", SEEDS, indirect=True)


def simulated(drive: Drive) -> bekker.Result:
    names = [variable["name"] for variable in drive.model.inputs()]
    return bekker.simulate(
        drive.model,
        duration=len(drive.commands) * drive.steps * drive.model.step_size,
        period=drive.steps * drive.model.step_size,
        inputs=dict(zip(names, drive.commands.T, strict=True)),
    )


@pytest.fixture(scope="module")
def core() -> Path:
    """The Rust program `core_drive`, which shares nothing with the Python door."""
    return core_program("core_drive")


@all_drives
def test_agreement_simulate_equals_the_core(drive: Drive, core: Path, tmp_path: Path) -> None:
    model, commands = tmp_path / "model.toml", tmp_path / "commands"
    model.write_text(drive.model.to_toml())
    commands.write_text("\n".join(" ".join(f"{bits:016x}" for bits in row) for row in drive.commands.view(np.uint64)))
    out = subprocess.run([core, model, commands, str(drive.steps)], check=True, stdout=subprocess.PIPE, text=True)
    lines = out.stdout.splitlines()
    python = simulated(drive)
    if python.event is not None:
        assert lines.pop() == python.event
    expected = np.array([[int(word, 16) for word in line.split()] for line in lines], dtype=np.uint64)
    got = np.stack(list(python.values()), axis=1).view(np.uint64)
    # At an event on the very first inner step of a period the core prints the last instant twice.
    assert np.array_equal(got, expected[: len(got)])
    assert len(expected) - len(got) in (0, 1)
    # A rover that was drawn top-heavy may hit the ground with its belly at once.
    assert len(got) > 3, "the drive ended before it began"


@all_drives
def test_agreement_stepping_equals_simulate(drive: Drive) -> None:
    python, run = simulated(drive), drive.model.start()
    out = run.signals()
    for k, row in enumerate(drive.commands[: len(python.time) - 1]):
        # One step at a time, where `simulate` makes them in one go.
        for _ in range(drive.steps):
            status = run.step(row, 1, out)
        assert np.array_equal(out, [python[name][k + 1] for name in run.signal_names])
    assert status == python.status


@all_drives
def test_agreement_environment_equals_simulate(drive: Drive) -> None:
    scale = float(np.abs(drive.commands).max())
    env = gymnasium.make("bekker/Rover-v0", model=drive.model, action_scale=scale, observe=["velocity", "wheel.slip"])
    rover = env.unwrapped
    assert isinstance(rover, bekker.RoverEnv)
    actions = drive.commands / scale
    python = simulated(Drive(drive.model, actions * scale, drive.steps))
    env.reset(seed=drive.model.seed)
    slip = [f"wheel[{k + 1}].slip" for k in range(drive.model.wheels)]
    scales = rover.observer.scales
    for k, action in enumerate(actions[: len(python.time) - 1]):
        observation, _, terminated, _, info = env.step(action)
        assert info["x"] == python["x"][k + 1] and info["time"] == python.time[k + 1]
        assert info["electrical_energy"] == python["electrical_energy"][k + 1]
        assert np.array_equal(info["slip"], [python[name][k + 1] for name in slip])
        expected = np.array([python[name][k + 1] for name in rover.observer.names]) / scales
        assert np.array_equal(observation, np.clip(expected, -1.0, 1.0).astype(np.float32))
    assert terminated == (python.status != "running") and info["status"] == python.status
