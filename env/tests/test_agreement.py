"""The same inputs give the same bits in the core, through `simulate`, by stepping, and in the environment."""

import subprocess
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from conftest import SEEDS, Drive, core_program
from environments import TASKS, actions_of
from stepped_fmu import Slave

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
    scales = rover.setup.observer.scales
    for k, action in enumerate(actions[: len(python.time) - 1]):
        observation, _, terminated, _, info = env.step(action)
        assert info["x"] == python["x"][k + 1] and info["time"] == python.time[k + 1]
        assert info["electrical_energy"] == python["electrical_energy"][k + 1]
        assert np.array_equal(info["slip"], [python[name][k + 1] for name in slip])
        expected = np.array([python[name][k + 1] for name in rover.setup.observer.names]) / scales
        assert np.array_equal(observation, np.clip(expected, -1.0, 1.0).astype(np.float32))
    assert terminated == (python.status != "running") and info["status"] == python.status


@pytest.mark.parametrize("task", TASKS)
def test_agreement_task_core_and_fmu_follow_one_trajectory(task: str, core: Path, tmp_path: Path) -> None:
    """An episode of a task, its ground and soil drawn: the same bits in the environment, the core and the FMU."""
    env = gymnasium.make(task).unwrapped
    assert isinstance(env, bekker.RoverEnv)
    env.reset(seed=1)
    model, mechanics = env.mechanics.models[0], env.mechanics
    actions = actions_of(env, 60)
    commands = actions.astype(np.float64) * env.setup.action_scale
    rows = [mechanics.signals[0].copy()]
    for action in actions:
        assert not env.step(action)[2], "the drive ended before it began"
        rows.append(mechanics.signals[0].copy())

    file, table = tmp_path / "model.toml", tmp_path / "commands"
    file.write_text(model.to_toml())
    table.write_text("\n".join(" ".join(f"{bits:016x}" for bits in row) for row in commands.view(np.uint64)))
    out = subprocess.run([core, file, table, "10"], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    # The core prints the time first.
    expected = np.array([[int(word, 16) for word in line.split()[1:]] for line in out], np.uint64)
    assert np.array_equal(np.array(rows).view(np.uint64), expected)

    fmu = tmp_path / "task.fmu"
    bekker.export_fmu(model, fmu, kind="closed-loop" if model.control == "speed_loop" else None)
    slave = Slave(fmu, tmp_path / "fmu")
    names = [variable["name"] for variable in model.signals()]
    inputs = [variable["name"] for variable in model.inputs()]
    slave.start(startTime=0.0)
    assert slave.get(*names) == rows[0].tolist()
    for k, (command, row) in enumerate(zip(commands, rows[1:], strict=False)):
        slave.set(**dict(zip(inputs, command.tolist(), strict=True)))
        slave.fmu.doStep(currentCommunicationPoint=k * 0.02, communicationStepSize=0.02)
        assert slave.get(*names) == row.tolist(), k
    slave.free()
