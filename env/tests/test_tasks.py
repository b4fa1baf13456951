"""What the tasks promise: drives of this world, and constants that do not solve what an oracle does."""

import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from environments import single

import bekker
from bekker import oracles

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples"))

import task_sweep  # noqa: E402

MOST_BY_CONSTANT = 0.6
LEAST_BY_ORACLE = 0.9

# Pairs of a successful and a failed episode in which the successful one has the higher return.
LEAST_ORDERED = 0.99

# The observations are of single precision.
SINGLE_PRECISION = 1e-6

# Angle beyond a stop that the drives of the presets reach, rad, as in the core's test.
BENT = 0.06

# Relative difference of the ways of the two plants after 24 s over rocks. Their integrators differ in order and meet the face of a rock in
# different steps; 4e-5 was found.
BOTH_PLANTS = 1e-3

ROWS = task_sweep.read()


def rows_of(task: str, policy: str) -> list[dict[str, str]]:
    return [row for row in ROWS if row["task"] == task and row["policy"] == policy]


def test_property_the_sweep_is_of_all_tasks_with_a_goal_and_as_it_was_fixed() -> None:
    assert set(task_sweep.TASKS) == set(bekker.TASKS) - {"Rover"}
    assert len(task_sweep.SEEDS) >= 50
    for task in task_sweep.TASKS:
        driven = [tuple(map(float, row["action"].split())) for row in rows_of(task, "constant")]
        constants = task_sweep.constants(bekker.RoverEnv(task=task).setup.model.wheels)
        assert driven == constants and len(set(constants)) == 31
        assert sum(len(set(action)) == 1 for action in constants) == 11


@pytest.mark.parametrize("task", task_sweep.TASKS)
def test_property_no_constant_action_solves_what_the_oracle_does(task: str) -> None:
    assert max(float(row["success"]) for row in rows_of(task, "constant")) <= MOST_BY_CONSTANT
    (oracle,) = rows_of(task, "oracle")
    assert float(oracle["success"]) >= LEAST_BY_ORACLE
    assert float(oracle["return"]) > max(float(row["return"]) for row in rows_of(task, "constant"))


@pytest.mark.parametrize("task", task_sweep.TASKS)
def test_property_the_return_grows_with_success(task: str) -> None:
    assert all(float(row["ordered"]) >= LEAST_ORDERED for row in ROWS if row["task"] == task)


def test_regress_the_rows_are_those_of_this_version() -> None:
    """The best constant of each task, driven again to the same digits."""
    assert task_sweep.check(1) == 0


@pytest.mark.parametrize("task", task_sweep.TASKS)
def test_regress_the_oracle_succeeds_on_seeds_of_the_sweep(task: str) -> None:
    env = gymnasium.make(f"bekker/{task}-v0", disable_env_checker=True)
    # One in five may fail where one in ten does on average.
    assert oracles.evaluate(env, task_sweep.SEEDS[:5]).success.sum() >= 4


def test_property_an_oracle_is_of_a_registered_task_with_a_goal() -> None:
    with pytest.raises(bekker.InputError, match="'Rover' has no oracle; expected one of SpeedHold"):
        oracles.drivers(single())
    with pytest.raises(bekker.InputError, match="wheel speeds as actions and a goal at a distance"):
        oracles.OnSchedule(single("bekker/SlipLimited-v0"))


def hard_actions(wheels: int) -> np.ndarray:
    """Full ahead, full astern, and wheels against each other, for a second each."""
    signs = [np.ones(wheels), -np.ones(wheels), np.resize([1.0, -1.0], wheels), np.resize([-1.0, 1.0], wheels)]
    return np.repeat(np.array([signs[k] for k in (0, 1, 0, 2, 3, 2, 0, 0, 0)], np.float32), 50, axis=0)


@pytest.mark.parametrize("task", bekker.TASKS)
def test_property_drives_keep_their_limits_and_observations_are_not_clipped(task: str) -> None:
    env = single(f"bekker/{task}-v0")
    model = env.setup.model
    constant = model.get("motor.gear_ratio") * model.get("motor.torque_constant")
    voltage, current = 1.0 / model.get("motor.inverse_voltage"), 1.0 / model.get("motor.inverse_current_limit")
    names = env.setup.observer.names
    moving = [k for k, name in enumerate(names) if name == "velocity" or name.endswith(".speed")]
    places = env.mechanics.places
    wheels = range(1, model.wheels + 1)
    for seed in range(3):
        env.reset(seed=seed)
        for action in hard_actions(model.wheels):
            observation, _, terminated, _, _ = env.step(action)
            assert np.abs(observation[moving]).max() < 1.0
            signals = env.mechanics.signals[0]
            for k in wheels:
                amperes, speed = signals[places[f"wheel[{k}].current"]], signals[places[f"wheel[{k}].speed"]]
                # Beyond the no-load speed the back-EMF drives a current against the supply, which no amplifier can limit.
                assert abs(amperes) <= current * (1.0 + SINGLE_PRECISION) or constant * abs(speed) > voltage
                assert abs(model.get("motor.resistance") * amperes + constant * speed) <= voltage * (1.0 + SINGLE_PRECISION)
            if terminated:
                break


@pytest.mark.parametrize("task", ["DitchCrossing", "EnergyTraverse", "RockTraverse"])
def test_property_the_bogie_keeps_within_its_stops(task: str) -> None:
    env = single(f"bekker/{task}-v0")
    stop, place = env.setup.model.get("link[1].stop"), env.mechanics.places["link[1].angle"]
    assert stop == pytest.approx(np.pi / 4)
    for seed in range(3):
        env.reset(seed=seed)
        for action in hard_actions(3):
            terminated = env.step(action)[2]
            assert abs(env.mechanics.signals[0, place]) < stop + BENT
            if terminated:
                break


def driven(env: bekker.RoverEnv, seed: int, driver: bekker.baselines.Policy, **options: float) -> tuple[dict[str, Any], list[float]]:
    """The last info of an episode, and the pitch rate after each of its steps, rad/s."""
    observation, info = env.reset(seed=seed, options=options)
    place, rates, start, over = env.mechanics.places["pitch_rate"], [], True, False
    while not over:
        action, _ = driver.predict(observation, episode_start=start)
        observation, _, over, _, info = env.step(action)
        start = False
        rates.append(float(env.mechanics.signals[0, place]))
    return info, rates


def test_property_rocks_want_a_gentle_drive_that_is_in_time() -> None:
    env = single("bekker/RockTraverse-v0")
    # A seed of the sweep whose first drive, at an even speed, is in time and not gentle.
    survey = oracles.Survey()
    even, rates = driven(env, 20_001, oracles.OnSchedule(env, 0.97, survey))
    fast = env.setup.period * float((np.abs(rates) > bekker.rewards.PITCH_RATE).sum())
    assert even["status"] == "goal" and not even["success"] and fast > env.setup.goal.seconds
    gentle, rates = driven(env, 20_001, oracles.Gentle(env, 0.99, survey, 0.04))
    assert gentle["success"] and env.setup.period * float((np.abs(rates) > bekker.rewards.PITCH_RATE).sum()) <= env.setup.goal.seconds
    assert gentle["time"] * gentle["target_velocity"] <= 5.0
    # A rover that arrives late has no success, however gently it drove.
    late, _ = driven(env, 20_001, oracles.Gentle(env, 1.1, survey, 0.04))
    assert late["status"] == "goal" and not late["success"]


def test_property_a_rule_that_sees_rocks_returns_more_than_an_even_speed() -> None:
    env = gymnasium.make("bekker/RockTraverse-v0", disable_env_checker=True)
    seeds = task_sweep.SEEDS[:8]
    careful = bekker.baselines.evaluate(env, bekker.baselines.CarefulSpeeds(env), seeds)
    blind = bekker.baselines.evaluate(env, oracles.OnSchedule(env, 0.97), seeds)
    assert careful.returns.mean() > blind.returns.mean()
    with pytest.raises(bekker.InputError, match="a map of the ground ahead in the observation, which lacks goal_distance, time_left"):
        bekker.baselines.CarefulSpeeds(single("bekker/SpeedHold-v0", control="speed_loop"))


def test_property_a_new_seed_of_the_ground_keeps_its_rocks() -> None:
    env = single("bekker/RockTraverse-v0", observe=["height_ahead"], raw=True, ahead=bekker.Ahead(np.arange(0.0, 20.0, 0.01)))
    bare = single(
        "bekker/RockTraverse-v0", observe=["height_ahead"], raw=True, ahead=bekker.Ahead(np.arange(0.0, 20.0, 0.01)),
        parameters={"terrain.rock_coverage": 0.0},
    )  # fmt: skip
    raised = [env.reset(seed=seed)[0] - bare.reset(seed=seed)[0] for seed in (0, 1)]
    for rise in raised:
        # 0.3 of the largest diameter; the wheels stand on ground without rocks.
        assert 0.015 < rise.max() <= 0.3 * 0.08 + SINGLE_PRECISION and rise.min() > -SINGLE_PRECISION
    assert not np.array_equal(*raised)


def test_property_both_plants_drive_over_rocks() -> None:
    """The same ground and wheel speeds: rigid bodies of order 1 and joint coordinates of order 2, on soil whose forces agree."""
    distances = []
    for plant in ("joint_coordinates", "rigid_bodies"):
        model = f"preset = 'rocker_bogie_velocity'\n[simulation]\nplant = '{plant}'\n"
        env = single("bekker/RockTraverse-v0", model=model, randomise={"terrain.seed": (20_003, 20_003)})
        env.reset(seed=0)
        for _ in range(1200):
            _, _, terminated, _, info = env.step(np.full(3, 0.3, np.float32))
            assert not terminated
        distances.append(info["distance"])
    assert min(distances) > 2.0 and distances[0] == pytest.approx(distances[1], rel=BOTH_PLANTS)


def test_property_the_schedule_wants_neither_early_nor_late() -> None:
    env = single("bekker/SlopeClimb-v0", level=0.0)
    for target, asked, success in ((0.2, 0.2, True), (0.2, 0.15, False), (0.2, 0.28, False)):
        env.reset(seed=0, options={"target_velocity": target})
        driver = oracles.OnSchedule(env, aim=target / asked)
        terminated, start = False, True
        while not terminated:
            action, _ = driver.predict(None, episode_start=start)
            observation, _, terminated, _, info = env.step(action)
            start = False
        assert info["status"] == "goal" and info["success"] == success
        assert info["reward_goal"] == (3.0 if success else 0.0)
        left = observation[env.setup.observer.names.index("time_left")]
        assert left == pytest.approx(1.0 - info["time"] * target / 3.0, abs=SINGLE_PRECISION)
