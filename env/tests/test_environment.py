"""The environment as gymnasium expects it: checker, seeds, reset and step, refusals."""

import copy
import importlib
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from environments import TASKS, assert_same, single

import bekker

sys.path.insert(0, str(Path(__file__).parents[1] / "benches"))
import endurance  # noqa: E402

ID = "bekker/Rover-v0"
PRESETS = tuple(bekker.presets())
# Sums of three products, in another order than the environment adds them.
ROUNDING = 1e-12


def rollout(env: gymnasium.Env[Any, Any], seed: int, steps: int = 50) -> list[Any]:
    """Two episodes from one seed, all that the environment says."""
    actions = np.random.default_rng(seed).uniform(-0.3, 0.8, (2, steps, *(env.action_space.shape or ())))
    said: list[Any] = []
    for k, episode in enumerate(actions):
        said.append(env.reset(seed=seed if k == 0 else None))
        for action in episode:
            said.append(env.step(action))
            if said[-1][2]:
                break
    return said


@pytest.mark.parametrize("preset", PRESETS)
def test_property_gymnasium_checker_has_no_complaint(preset: str) -> None:
    check_env(single(model=preset))


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("arguments", [{}, {"raw": True}, {"measured": True}, {"control": "speed"}])
def test_property_checker_has_no_complaint_about_any_task(task: str, arguments: dict[str, Any]) -> None:
    env = single(task, **arguments)
    check_env(env)
    assert env.observation_space.is_bounded() and env.action_space.is_bounded()


def test_property_checker_accepts_variation_and_other_signals() -> None:
    scatter = {"soil.cohesion": (500.0, 1500.0)}
    check_env(single(randomise=scatter, observe=["velocity", "wheel.sinkage", "power"], period=0.05))


def test_property_registration_is_idempotent() -> None:
    before = {task: gymnasium.spec(task) for task in TASKS}
    importlib.reload(bekker)
    assert all(gymnasium.spec(task) is spec for task, spec in before.items())
    assert before[ID].max_episode_steps == 1000
    assert len(TASKS) == 8


def test_property_gymnasium_imports_the_package_by_its_name() -> None:
    """Gymnasium 1 has no entry points for plug-ins; a module before the id is what it has."""
    script = "import gymnasium; gymnasium.make('bekker:bekker/SpeedHold-v0').reset(seed=0)"
    subprocess.run([sys.executable, "-c", script], check=True)


@pytest.mark.parametrize("preset", PRESETS)
def test_property_a_seed_decides_everything(preset: str) -> None:
    arguments: dict[str, Any] = {"model": preset, "randomise": {"soil.cohesion": (500.0, 1500.0), "x0": (-1.0, 1.0)}}
    env = gymnasium.make(ID, **arguments)
    first = rollout(env, seed=3)
    assert_same(first, rollout(env, seed=3))
    assert_same(first, rollout(gymnasium.make(ID, **arguments), seed=3))
    # What was drawn is what is driven.
    assert first[0][1]["x"] == first[0][1]["drawn"]["x0"]
    other = rollout(env, seed=4)
    assert other[0][1]["drawn"] != first[0][1]["drawn"]
    second_episode = next(k for k, said in enumerate(first) if k > 0 and len(said) == 2)
    assert first[second_episode][1]["drawn"] != first[0][1]["drawn"]


def test_property_sensor_noise_follows_the_seed() -> None:
    env = single(model="gentle_velocity", parameters={"sensor.wheel_speed_noise": 0.2})

    def end(seed: int | None) -> float:
        env.reset(seed=seed)
        return [env.step([0.5])[4]["x"] for _ in range(20)][-1]

    assert end(1) == end(1)
    assert end(1) != end(2)
    assert end(1) != end(None)


def test_property_a_copy_goes_on_alike() -> None:
    env = single(model="gentle_rtc")
    env.reset(seed=0)
    env.step([0.4])
    twin = copy.deepcopy(env)
    assert_same([env.step([0.4]) for _ in range(10)], [twin.step([0.4]) for _ in range(10)])


def test_property_reward_is_the_sum_of_its_terms() -> None:
    weights = {"progress": 2.0, "energy": 0.3, "end": 5.0}
    # Without the limit by the supply the wheels can dig in.
    unlimited = {"motor.inverse_voltage": 0.0}
    env = single(model="rocker_bogie", reward_weights=weights, action_scale=5.0, parameters=unlimited)
    _, info = env.reset(seed=0)
    keys, weight = info.keys(), 3.05 * 9.81
    assert env.mechanics.models[0].total_mass * env.mechanics.models[0].get("gravity") == pytest.approx(weight, rel=ROUNDING)
    # Gentle driving, then torques that dig the wheels in.
    for action in [0.06] * 50 + [1.0] * 50:
        before = info
        _, reward, terminated, truncated, info = env.step([action] * 3)
        assert info.keys() == keys and not truncated
        assert reward == pytest.approx(sum(info[f"reward_{term}"] for term in weights), rel=ROUNDING)
        assert info["reward_progress"] == pytest.approx(2.0 * (info["x"] - before["x"]), rel=ROUNDING)
        energy = info["electrical_energy"] - before["electrical_energy"]
        assert info["reward_energy"] == pytest.approx(-0.3 * energy / weight, rel=ROUNDING)
        assert info["reward_end"] == (-5.0 if terminated else 0.0)
        if terminated:
            break
    assert info["status"] == "tipped_over" and info["time"] > 1.0


def test_property_time_truncates_and_events_terminate() -> None:
    env = gymnasium.make(ID, max_episode_steps=5)
    env.reset(seed=0)
    assert [env.step([0.0, 0.0])[2:4] for _ in range(5)] == [(False, False)] * 4 + [(False, True)]
    buried = single(parameters={"rover.belly_z": -0.12})
    buried.reset(seed=0)
    assert buried.step([0.0, 0.0])[2:4] == (True, False)
    with pytest.raises(gymnasium.error.ResetNeeded, match="belly_contact"):
        buried.step([0.0, 0.0])
    buried.reset(seed=0)
    assert buried.step([0.0, 0.0])[4]["time"] <= 0.02


def test_property_options_set_parameters_for_one_episode() -> None:
    env = single(randomise={"soil.cohesion": (500.0, 1500.0)})
    plain, info = env.reset(seed=1)
    assert env.reset(seed=1, options={"x0": 2.5})[1]["x"] == 2.5
    heavy = env.reset(seed=1, options={"parameters": {"rover.mass": 20.0, "x0": 1.0}})[1]
    assert heavy["sinkage"][0] > 1.5 * info["sinkage"][0] and heavy["x"] == 1.0
    # The drawing goes on as if there had been no options.
    assert heavy["drawn"] == info["drawn"]
    assert_same(env.reset(seed=1), (plain, info))


def test_property_action_scale_is_what_one_commands() -> None:
    env = single(action_scale=2.0)
    env.reset(seed=0)
    observation = env.step([0.25, -0.5])[0]
    torque = observation[env.setup.observer.names.index("wheel[1].torque") :][:2] * env.setup.observer.scales[5:7]
    assert torque == pytest.approx([0.5, -1.0], rel=1e-6)  # observations are 32-bit floats


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"model": "two_weeled"}, "unknown preset `two_weeled`"),
        ({"model": 3}, "model: expected .* found int"),
        ({"parameters": {"soil.cohesin": 1.0}}, "unknown parameter `soil.cohesin`; did you mean soil.cohesion"),
        ({"parameters": {"soil.cohesion": -1.0}}, r"`soil.cohesion` = -1 is outside its allowed range 0 \.\. "),
        ({"period": 0.003}, r"period = 0.003 s: expected a whole number of inner steps of 0.002 s"),
        ({"period": float("nan")}, "period = nan"),
        ({"randomise": {"soil.cohesio": (1.0, 2.0)}}, "unknown parameter `soil.cohesio`"),
        ({"vary": {"soil.cohesion": (1.0, 2.0)}}, "unknown argument `vary`"),
        ({"task": "SpeedHould"}, "unknown task `SpeedHould`"),
        ({"task": "SpeedHold", "target_velocity": float("nan")}, "target_velocity = nan"),
        ({"slip_limit": 0.0}, "slip_limit = 0.0: expected a finite number above 0"),
        ({"control": "torqe"}, "control: unknown variant `torqe`"),
        ({"terrain": {"preset": "wavy"}}, "terrain: unknown variant `wavy`"),
        ({"terrain": {"preset": "waves", "amplitud": 1.0}}, "unknown parameter `terrain.amplitud`"),
        ({"parameters": {"terrain.seed": 3}}, "terrain.seed: expected the terrain preset `random`"),
        ({"parameters": {"sensor.pich_noise": 0.1}}, "unknown parameter `sensor.pich_noise`"),
        ({"measured": True, "observe": ["power"]}, "observe `power`: no sensor reads it; expected "),
        ({"rewards": "progress"}, "rewards = 'progress': expected a list"),
        ({"rewards": []}, "rewards: expected one term at least"),
        ({"rewards": ["progres"]}, "unknown reward term `progres`"),
        ({"level": -0.1}, "level = -0.1"),
        ({"observe": ["pich"]}, "unknown observable signal `pich`; did you mean pitch"),
        ({"observe": []}, "observe: expected at least one"),
        ({"observation_scales": {"pitch": 0.0}}, "scale of `pitch` = 0.0"),
        ({"action_scale": float("inf")}, "action_scale = inf"),
        ({"reward_weights": {"progres": 1.0}}, "unknown reward term `progres`; expected progress, energy, end"),
        ({"reward_weights": {"energy": float("nan")}}, "weight of the reward term `energy` = nan"),
        ({"goal": 3.0}, r"goal = 3.0: expected a goal of bekker.goals, such as Reach\(3.0\)"),
        ({"level": "hard"}, "level = 'hard': expected a number, found str"),
        ({"slip_limit": "0.3"}, "slip_limit = '0.3': expected a number, found str"),
        ({"parameters": {"soil.cohesion": "1 kPa"}}, "soil.cohesion = '1 kPa': expected a number, found str"),
        ({"parameters": {"soil.cohesion": [1.0]}}, r"soil.cohesion = \[1.0\]: expected a number, found list"),
        ({"terrain": "slope"}, r"terrain = 'slope': expected the keys of the section \[terrain\]"),
    ],
)
def test_property_bad_arguments_are_named(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message) as refused:
        bekker.RoverEnv(**arguments)
    assert isinstance(refused.value, bekker.BekkerError)


@pytest.mark.parametrize(
    ("action", "message"),
    [
        ([0.1, float("nan")], r"action\[1\] = nan: expected a number within -1 .. 1"),
        ([1.1, 0.0], r"action\[0\] = 1.1"),
        ([0.1], r"the action has shape \(1,\), expected \(2,\)"),
        (0.5, r"the action has shape \(\), expected \(2,\)"),
        ([[0.1, 0.1, 0.1], [0.1, 0.1, 0.1]], r"the action has shape \(2, 3\), expected \(2,\)"),
        ([0.1 + 0.1j, 0.0], "the action is of type complex128: expected real numbers"),
        (["a", "b"], "expected real numbers"),
        ([[0.1], [0.1, 0.2]], "rows of different lengths"),
    ],
)
def test_property_a_bad_action_is_named_and_moves_nothing(action: Any, message: str) -> None:
    env = single()
    with pytest.raises(gymnasium.error.ResetNeeded, match="no episode yet"):
        bekker.RoverEnv().step([0.0, 0.0])
    env.reset(seed=0)
    with pytest.raises(bekker.InputError, match=message):
        env.step(action)
    assert env.step([0.1, 0.1])[4]["time"] == 0.02


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"mass": 3.0}, "unknown option `mass`; expected parameters, x0, level, randomise, worlds, target_velocity"),
        ({"parameters": {"rover.mas": 3.0}}, "unknown parameter `rover.mas`"),
        ({"x0": 1e9}, "`x0` = 1000000000 is outside"),
    ],
)
def test_property_bad_options_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(bekker.BekkerError, match=message):
        single().reset(options=options)


def test_property_measured_observations_have_the_errors_of_the_sensors() -> None:
    observe = ["pitch", "velocity", "wheel.speed", "wheel.torque"]
    parameters = {"sensor.pitch_bias": 0.05, "sensor.wheel_speed_resolution": 0.5, "sensor.torque_noise": 0.1}
    true, seen = single(observe=observe, raw=True), single(observe=observe, raw=True, measured=True, parameters=parameters)
    ideal = single(observe=observe, raw=True, measured=True)
    for env in (true, seen, ideal):
        env.reset(seed=0)
    noise = []
    for action in np.random.default_rng(0).uniform(0.0, 1.0, (200, 2)).astype(np.float32):
        truth, measured, perfect = (env.step(action)[0] for env in (true, seen, ideal))
        # Sensors without errors say the truth; the body is the same body.
        assert np.array_equal(truth, perfect)
        assert measured[0] == pytest.approx(truth[0] + 0.05, abs=1e-6)  # 32-bit floats
        assert measured[1] == truth[1]
        assert measured[2:4] / 0.5 == pytest.approx(np.round(measured[2:4] / 0.5), abs=1e-5)
        noise.append(measured[4:] - truth[4:])
    # Four standard errors of a standard deviation.
    assert np.std(noise) == pytest.approx(0.1, abs=4 * 0.1 / np.sqrt(2 * np.size(noise)))


def test_property_raw_observations_are_the_normalised_ones_in_si() -> None:
    raw, normal = single(raw=True), single()
    raw.reset(seed=0)
    normal.reset(seed=0)
    scales = normal.setup.observer.scales
    for _ in range(50):
        si, unit = (env.step(np.array([0.4, 0.6], np.float32))[0] for env in (raw, normal))
        inside = np.abs(unit) < 1.0
        assert si[inside] == pytest.approx((unit * scales)[inside], rel=1e-6)  # 32-bit floats
    assert np.array_equal(raw.observation_space.high, (10.0 * scales).astype(np.float32))


def test_property_a_term_of_the_users_own_joins_the_others() -> None:
    def level(step: bekker.rewards.Step) -> Any:
        return -np.abs(step.signal("pitch"))

    env = single(rewards=["progress", bekker.rewards.Term("level", 2.0, "keeps level", level)])
    env.reset(seed=0)
    _, reward, _, _, info = env.step([0.5, 0.5])
    pitch = env.mechanics.signals[0, env.mechanics.places["pitch"]]
    assert info["reward_level"] == -2.0 * abs(pitch) and reward == info["reward_progress"] + info["reward_level"]
    assert not any(name in info for name in ("reward_energy", "reward_end"))


@pytest.mark.parametrize("task", ["SlopeClimb", "SlipLimited", "EnergyTraverse", "RockTraverse", "DitchCrossing"])
def test_property_the_goal_ends_the_episode_and_says_so(task: str) -> None:
    """Easy ground and a drive of even speed, 0.2 m/s with the slip of this ground: what each task asks for can be done."""
    env = single(f"bekker/{task}-v0", control="speed_loop", level=0.0)
    # One task allows no delay, so that it is asked for less.
    env.reset(seed=0, options={"target_velocity": 0.15 if task == "RockTraverse" else 0.2})
    even = 1.2 * 0.2 / (env.setup.model.get("wheel.radius") * env.setup.action_scale)
    for _ in range(3000):
        _, _, terminated, _, info = env.step(np.full(env.action_space.shape, even, np.float32))
        if terminated:
            break
        assert not info["success"] and info["status"] == "running" and info["reward_goal"] == 0.0
    assert info["status"] == "goal" and info["success"]
    assert info["distance"] >= env.setup.goal.way() > 0.0 and info["reward_end"] == 0.0
    assert info["reward_goal"] == next(term.weight for term in env.setup.terms if term.name == "goal")
    with pytest.raises(gymnasium.error.ResetNeeded, match="goal"):
        env.step(np.zeros(env.action_space.shape, np.float32))


def test_property_slip_beyond_the_limit_spoils_success_at_the_goal() -> None:
    env = single("bekker/SlipLimited-v0", slip_limit=0.02)
    env.reset(seed=0)
    for _ in range(3000):
        _, _, terminated, _, info = env.step(np.array([0.75, 0.75], np.float32))
        if terminated:
            break
    assert info["status"] == "goal" and not info["success"]


def test_property_held_speed_is_success_and_lost_speed_is_not() -> None:
    env = single("bekker/SpeedHold-v0", level=0.0, control="velocity", action_scale=1.0)
    velocity = env.mechanics.places["velocity"]

    def drive(gain: float) -> tuple[list[bool], list[float]]:
        """Commands that follow the target by an integral of the error; with no gain, a command that is too slow."""
        env.reset(seed=0, options={"target_velocity": 0.25})
        command, said, speeds = 0.15, [], []
        for _ in range(1000):
            info = env.step(np.array([command], np.float32))[4]
            speeds.append(float(env.mechanics.signals[0, velocity]))
            said.append(bool(info["success"]))
            command = min(command + gain * (0.25 - speeds[-1]), 1.0)
        return said, speeds

    slow, _ = drive(0.0)
    assert not any(slow)
    held, speeds = drive(0.01)
    assert held[-1]
    # By the words of the task: nothing before 3 s, then the mean error so far.
    errors = np.abs(np.array(speeds[150:]) - 0.25)
    means = np.cumsum(errors) / np.arange(1, len(errors) + 1)
    clear = np.abs(means - 0.025) > 1e-9
    assert not any(held[:150]) and np.array_equal(np.array(held[150:])[clear], (means <= 0.025)[clear])


def test_property_snapshots_of_one_rover_go_on_to_the_same_bits() -> None:
    env = single("bekker/EnergyTraverse-v0")
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(0.0, 1.0, (60, 3)).astype(np.float32)
    for action in actions[:20]:
        env.step(action)
    snapshot = env.snapshot()

    def rest() -> list[Any]:
        return [env.step(action) for action in actions[20:]] + [env.reset()]

    first = rest()
    env.restore(snapshot)
    assert_same(first, rest())


@pytest.mark.parametrize("seed", range(25))
def test_property_random_configurations_stay_finite(seed: int) -> None:
    """A part of benches/endurance.py, which makes ten million such steps."""
    endurance.endure(steps=4000, seed=seed)


def test_property_rigid_bodies_are_copied_and_refuse_to_be_pickled() -> None:
    model = (
        "preset = 'two_wheeled'\n[simulation]\nplant = 'rigid_bodies'\n"
        "[[obstacle]]\nkind = 'rock'\nx = 0.8\nheight = 0.03\nwidth = 0.2\n"
    )
    env = single(model=model)
    env.reset(seed=0)
    actions = np.full((60, 2), 0.8, np.float32)
    for action in actions[:20]:
        env.step(action)
    twin, snapshot = copy.deepcopy(env), env.snapshot()
    first = [env.step(action) for action in actions[20:]]
    assert_same(first, [twin.step(action) for action in actions[20:]])
    env.restore(snapshot)
    assert_same(first, [env.step(action) for action in actions[20:]])
    with pytest.raises(bekker.SimulationError, match="joint_coordinates"):
        pickle.dumps(env)
