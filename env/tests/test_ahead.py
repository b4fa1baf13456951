"""The ground ahead in observations: heights, missing cells and other soils."""

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from environments import actions_of, assert_same, single, vector

import bekker

# Heights are observed as float32, of some decimetres.
ROUNDING = 1e-6
SLOPE = {"preset": "slope", "slope": 0.2}
DITCH = {"preset": "ditch", "depth": 0.2, "width": 0.5, "position": 1.5}
OBSERVE = ("pitch", "height_ahead", "seen_ahead", "soil_ahead", "target_velocity")


def test_analytic_heights_follow_the_slope() -> None:
    distances = [-0.4, 0.5, 2.0]
    env = single(terrain=SLOPE, observe=OBSERVE, ahead=bekker.Ahead(distances))
    observation, _ = env.reset(seed=1)
    names = env.setup.observer.names
    assert names[1:4] == ["height_ahead[1]", "height_ahead[2]", "height_ahead[3]"] and names[-1] == "target_velocity"
    # A height of one is half of the farthest distance.
    assert observation[1:4] == pytest.approx(np.tan(0.2) * np.array(distances) / 1.0, abs=ROUNDING)
    assert observation[4:7].tolist() == [1.0] * 3 and observation[7:10].tolist() == [1.0] * 3
    doubled = single(terrain=SLOPE, observe=OBSERVE, ahead=bekker.Ahead(distances), observation_scales={"height_ahead": 2.0})
    assert doubled.reset(seed=1)[0][1:4] == pytest.approx(observation[1:4] / 2.0, abs=ROUNDING)
    raw = single(terrain=SLOPE, observe=OBSERVE, ahead=bekker.Ahead(distances), raw=True)
    assert raw.reset(seed=1)[0][1:4] == pytest.approx(np.tan(0.2) * np.array(distances), abs=ROUNDING)


def test_property_a_ditch_is_seen_before_the_wheels_reach_it() -> None:
    ahead = bekker.Ahead(np.linspace(0.0, 3.0, 31))
    env = single(terrain=DITCH, observe=["height_ahead"], ahead=ahead, raw=True)
    heights = env.reset(seed=1)[0]
    deepest = ahead.distances[int(heights.argmin())]
    x = env.mechanics.info(0)["x"]
    # Cells are 0.1 m apart.
    assert heights.min() == pytest.approx(-0.2, abs=0.02) and x + deepest == pytest.approx(1.5, abs=0.051)


def test_property_the_loose_sand_of_a_ditch_is_seen() -> None:
    ahead = bekker.Ahead(np.linspace(0.0, 4.0, 81))
    env = single("bekker/DitchCrossing-v0", observe=["soil_ahead"], ahead=ahead)
    other = env.reset(seed=1)[0]
    # Another cohesion of the model's soil does not make the ground outside another one: the table of this ground has its own.
    firmer = single("bekker/DitchCrossing-v0", observe=["soil_ahead"], ahead=ahead, parameters={"soil.cohesion": 1100.0})
    for seen in (other, firmer.reset(seed=1)[0]):
        loose = seen < 0.7
        assert not loose[0] and 0 < loose.sum() < len(seen) and np.all(seen[~loose][[0, -1]] > 0.9)


def test_agreement_single_and_vector_environments_look_alike() -> None:
    arguments: dict[str, Any] = {
        "task": "bekker/SpeedHold-v0", "observe": OBSERVE, "ahead": bekker.Ahead([0.3, 0.6, 1.2], noise=0.01, dropout=0.3),
    }  # fmt: skip
    many = vector(num_envs=3, **arguments)
    seen = [many.reset(seed=[5, 6, 7])[0]]
    actions = actions_of(many, 20)
    for action in actions:
        seen.append(many.step(action)[0].copy())
    for index in range(3):
        env = single(**arguments)
        assert_same(env.reset(seed=5 + index)[0], seen[0][index])
        for step, action in enumerate(actions):
            assert_same(env.step(action[index])[0], seen[step + 1][index])
    values = np.array(seen)[:, :, 1:4]
    missing = np.array(seen)[:, :, 4:7] == 0.0
    assert missing.any() and not missing.all() and np.all(values[missing] == 0.0)


def test_property_the_last_look_of_an_episode_is_kept() -> None:
    arguments: dict[str, Any] = {"observe": OBSERVE, "ahead": bekker.Ahead([0.3, 0.6], noise=0.02, dropout=0.2), "measured": True}
    env, many = single(**arguments), vector(num_envs=2, autoreset_mode="SameStep", max_episode_steps=3, **arguments)
    first = env.reset(seed=4)[0]
    assert_same(many.reset(seed=[4, 9])[0][0], first)
    for _ in range(3):
        alone = env.step([0.5, 0.5])[0]
        seen, _, _, truncated, infos = many.step(np.full((2, 2), 0.5, np.float32))
    assert truncated.all()
    assert_same(infos["final_obs"][0], alone)
    # The next episode begins with noise of its own.
    assert not np.array_equal(seen[0], first)


def test_property_copies_look_alike() -> None:
    env = single(observe=OBSERVE, ahead=bekker.Ahead([0.3, 0.6], noise=0.02, dropout=0.2))
    env.reset(seed=3)
    moment = env.snapshot()
    twins = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    expected = env.step([0.5, 0.5])[0]
    for twin in twins:
        assert_same(twin.step([0.5, 0.5])[0], expected)
    env.restore(moment)
    assert_same(env.step([0.5, 0.5])[0], expected)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"observe": ["height_ahead"]}, r"observe `height_ahead`: expected the argument `ahead`, such as ahead=bekker.Ahead\("),
        ({"ahead": bekker.Ahead([0.1])}, r"nothing of it is observed; expected height_ahead, seen_ahead, soil_ahead in `observe`"),
        ({"ahead": [0.1], "observe": ["height_ahead"]}, r"ahead = \[0.1\]: expected a bekker.Ahead"),
        ({"observe": ["height_ahead"] * 2, "ahead": bekker.Ahead([0.1])}, "observe: `height_ahead` stands there twice"),
        ({"observe": ["heigt_ahead"]}, "unknown observable signal `heigt_ahead`; did you mean height_ahead"),
    ],
)
def test_property_bad_maps_are_named(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message) as refused:
        bekker.RoverEnv(**arguments)
    assert isinstance(refused.value, bekker.BekkerError)


def test_property_a_map_refuses_what_it_cannot_be() -> None:
    for arguments, message in [
        ({"distances": []}, "distances: expected at least one"),
        ({"distances": [0.1, float("inf")]}, r"distances\[1\] = inf: expected a finite distance"),
        ({"distances": [0.1], "noise": -0.1}, "noise = -0.1: expected a standard deviation from 0"),
        ({"distances": [0.1], "dropout": 2.0}, r"dropout = 2: expected a probability within 0 .. 1"),
    ]:
        with pytest.raises(bekker.InputError, match=message):
            bekker.Ahead(**arguments)  # type: ignore[arg-type]
