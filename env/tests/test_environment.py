"""The environment as gymnasium expects it: checker, seeds, reset and step, refusals."""

import copy
import importlib
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import bekker

ID = "bekker/Rover-v0"
PRESETS = tuple(bekker.presets())
# Sums of three products, in another order than the environment adds them.
ROUNDING = 1e-12


def made(**arguments: Any) -> bekker.RoverEnv:
    rover = gymnasium.make(ID, **arguments).unwrapped
    assert isinstance(rover, bekker.RoverEnv)
    return rover


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


def assert_same(a: Any, b: Any) -> None:
    if isinstance(a, dict):
        assert a.keys() == b.keys()
        [assert_same(a[key], b[key]) for key in a]
    elif isinstance(a, list | tuple):
        assert len(a) == len(b)
        [assert_same(*pair) for pair in zip(a, b, strict=True)]
    else:
        assert np.array_equal(a, b), (a, b)


@pytest.mark.parametrize("preset", PRESETS)
def test_property_gymnasium_checker_has_no_complaint(preset: str) -> None:
    check_env(made(model=preset))


def test_property_checker_accepts_variation_and_other_signals() -> None:
    vary = {"soil.cohesion": (500.0, 1500.0)}
    check_env(made(vary=vary, observe=["velocity", "wheel.sinkage", "power"], period=0.05))


def test_property_registration_is_idempotent() -> None:
    before = gymnasium.spec(ID)
    importlib.reload(bekker)
    assert gymnasium.spec(ID) is before
    assert before.max_episode_steps == 1000


@pytest.mark.parametrize("preset", PRESETS)
def test_property_a_seed_decides_everything(preset: str) -> None:
    arguments: dict[str, Any] = {"model": preset, "vary": {"soil.cohesion": (500.0, 1500.0), "x0": (-1.0, 1.0)}}
    env = gymnasium.make(ID, **arguments)
    first = rollout(env, seed=3)
    assert_same(first, rollout(env, seed=3))
    assert_same(first, rollout(gymnasium.make(ID, **arguments), seed=3))
    other = rollout(env, seed=4)
    assert other[0][1]["drawn"] != first[0][1]["drawn"]
    second_episode = next(k for k, said in enumerate(first) if k > 0 and len(said) == 2)
    assert first[second_episode][1]["drawn"] != first[0][1]["drawn"]


def test_property_sensor_noise_follows_the_seed() -> None:
    env = made(model="gentle_velocity", parameters={"sensor.wheel_speed_noise": 0.2})

    def end(seed: int | None) -> float:
        env.reset(seed=seed)
        return [env.step([0.5])[4]["x"] for _ in range(20)][-1]

    assert end(1) == end(1)
    assert end(1) != end(2)
    assert end(1) != end(None)


def test_property_a_copy_goes_on_alike() -> None:
    env = made(model="gentle_rtc")
    env.reset(seed=0)
    env.step([0.4])
    twin = copy.deepcopy(env)
    assert_same([env.step([0.4]) for _ in range(10)], [twin.step([0.4]) for _ in range(10)])


def test_property_reward_is_the_sum_of_its_terms() -> None:
    weights = {"progress": 2.0, "energy": 0.3, "end": 5.0}
    env = made(model="rocker_bogie", reward_weights=weights, action_scale=5.0)
    _, info = env.reset(seed=0)
    keys, weight = info.keys(), 3.05 * 9.81
    assert env._weight == pytest.approx(weight, rel=ROUNDING)
    # Gentle driving, then torques that dig the wheels in.
    for action in [0.06] * 50 + [1.0] * 50:
        before = info
        _, reward, terminated, truncated, info = env.step([action] * 3)
        assert info.keys() == keys and not truncated
        assert reward == pytest.approx(sum(info[f"reward_{term}"] for term in weights), rel=ROUNDING)
        assert info["reward_progress"] == pytest.approx(2.0 * (info["x"] - before["x"]), rel=ROUNDING)
        energy = info["electrical_energy"] - before["electrical_energy"]
        assert info["reward_energy"] == pytest.approx(-0.3 * energy / env._weight, rel=ROUNDING)
        assert info["reward_end"] == (-5.0 if terminated else 0.0)
        if terminated:
            break
    assert info["status"] == "tipped_over" and info["time"] > 1.0


def test_property_time_truncates_and_events_terminate() -> None:
    env = gymnasium.make(ID, max_episode_steps=5)
    env.reset(seed=0)
    assert [env.step([0.0, 0.0])[2:4] for _ in range(5)] == [(False, False)] * 4 + [(False, True)]
    buried = made(parameters={"rover.belly_z": -0.12})
    buried.reset(seed=0)
    assert buried.step([0.0, 0.0])[2:4] == (True, False)
    with pytest.raises(gymnasium.error.ResetNeeded, match="belly contact"):
        buried.step([0.0, 0.0])
    buried.reset(seed=0)
    assert buried.step([0.0, 0.0])[4]["time"] <= 0.02


def test_property_options_set_parameters_for_one_episode() -> None:
    env = made(vary={"soil.cohesion": (500.0, 1500.0)})
    plain, info = env.reset(seed=1)
    assert env.reset(seed=1, options={"x0": 2.5})[1]["x"] == 2.5
    heavy = env.reset(seed=1, options={"parameters": {"rover.mass": 20.0, "x0": 1.0}})[1]
    assert heavy["sinkage"][0] > 1.5 * info["sinkage"][0] and heavy["x"] == 1.0
    # The drawing goes on as if there had been no options.
    assert heavy["drawn"] == info["drawn"]
    assert_same(env.reset(seed=1), (plain, info))


def test_property_action_scale_is_what_one_commands() -> None:
    env = made(action_scale=2.0)
    env.reset(seed=0)
    observation = env.step([0.25, -0.5])[0]
    torque = observation[env.observer.names.index("wheel[1].torque") :][:2] * env.observer.scales[5:7]
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
        ({"vary": {"soil.cohesion": (1.0,)}}, r"vary `soil.cohesion` = \(1.0,\): expected a pair"),
        ({"vary": {"soil.cohesion": (2.0, 1.0)}}, "vary `soil.cohesion`"),
        ({"vary": {"soil.cohesion": (1.0, 1e9)}}, "`soil.cohesion` = 1000000000 is outside"),
        ({"vary": {"soil.cohesio": (1.0, 2.0)}}, "unknown parameter `soil.cohesio`"),
        ({"observe": ["pich"]}, "unknown observable signal `pich`; did you mean pitch"),
        ({"observe": []}, "observe: expected at least one"),
        ({"observation_scales": {"pitch": 0.0}}, "scale of `pitch` = 0.0"),
        ({"action_scale": float("inf")}, "action_scale = inf"),
        ({"reward_weights": {"progres": 1.0}}, "unknown reward term `progres`; expected progress, energy, end"),
        ({"reward_weights": {"energy": float("nan")}}, "weight of the reward term `energy` = nan"),
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
    ],
)
def test_property_a_bad_action_is_named_and_moves_nothing(action: Any, message: str) -> None:
    env = made()
    with pytest.raises(gymnasium.error.ResetNeeded, match="no episode yet"):
        bekker.RoverEnv().step([0.0, 0.0])
    env.reset(seed=0)
    with pytest.raises(bekker.InputError, match=message):
        env.step(action)
    assert env.step([0.1, 0.1])[4]["time"] == 0.02


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"mass": 3.0}, "unknown option `mass`; expected parameters, x0"),
        ({"parameters": {"rover.mas": 3.0}}, "unknown parameter `rover.mas`"),
        ({"x0": 1e9}, "`x0` = 1000000000 is outside"),
    ],
)
def test_property_bad_options_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(bekker.BekkerError, match=message):
        made().reset(options=options)
