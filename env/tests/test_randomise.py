"""Randomisation by name, and the curriculum that scales it."""

import json
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from environments import TASKS, assert_same, single, vector

import bekker
from bekker.randomise import Choice, Distribution, LogUniform, Normal, Uniform, distribution

DRAWS = 4000
# Five standard errors of a mean.
SIGMAS = 5.0


def draws(scatter: Distribution) -> Any:
    random = np.random.default_rng(0)
    return np.array([scatter.draw(random) for _ in range(DRAWS)])


def within(values: Any, mean: float, deviation: float) -> None:
    assert abs(np.mean(values) - mean) < SIGMAS * deviation / np.sqrt(DRAWS)


def test_analytic_draws_have_the_moments_of_their_distributions() -> None:
    within(draws(Uniform(2.0, 5.0)), 3.5, 3.0 / np.sqrt(12.0))
    logs = np.log(draws(LogUniform(0.1, 10.0)))
    within(logs, 0.0, np.log(100.0) / np.sqrt(12.0))
    within(logs**2, np.log(100.0) ** 2 / 12.0, np.log(10.0) ** 2)
    # Cut off at one deviation on both sides, a normal distribution keeps the variance 1 - 2 phi(1)/(2 Phi(1) - 1).
    cut = draws(Normal(1.0, 0.5, 0.5, 1.5))
    assert cut.min() >= 0.5 and cut.max() <= 1.5
    variance = 0.25 * (1.0 - 2.0 * 0.24197072451914337 / 0.6826894921370859)
    within(cut, 1.0, np.sqrt(variance))
    within((cut - 1.0) ** 2, variance, 0.25)
    chosen = draws(Choice((1.0, 2.0, 4.0)))
    for value in (1.0, 2.0, 4.0):
        within(chosen == value, 1.0 / 3.0, np.sqrt(2.0) / 3.0)


def test_property_normal_draws_far_out_stay_within_their_ends() -> None:
    assert set(draws(Normal(0.0, 1e-3, 5.0, 5.0))) == {5.0}
    tail = draws(Normal(0.0, 1.0, 9.0, 10.0))
    assert tail.min() >= 9.0 and tail.max() <= 10.0


@pytest.mark.parametrize(
    "scatter", [Uniform(1.0, 3.0), LogUniform(1.0, 100.0), Normal(2.0, 1.0, 0.0, 4.0), Choice((2.0, 3.0, 5.0))]
)
def test_property_a_level_shrinks_towards_the_own_value(scatter: Distribution) -> None:
    nominal = 2.0
    assert scatter.at(1.0, nominal).ends() == scatter.ends()
    assert set(np.round(draws(scatter.at(0.0, nominal)), 12)) == {nominal}
    half = scatter.at(0.5, nominal).ends()
    assert min(scatter.ends()) <= min(half) <= nominal <= max(half) <= max(scatter.ends())


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ((1, 2), Uniform(1.0, 2.0)),
        ({"uniform": [1, 2]}, Uniform(1.0, 2.0)),
        ({"log_uniform": [1, 2]}, LogUniform(1.0, 2.0)),
        ({"normal": [0, 1, -1, 2]}, Normal(0.0, 1.0, -1.0, 2.0)),
        ({"choice": [1, 2, 3]}, Choice((1.0, 2.0, 3.0))),
    ],
)
def test_property_plain_data_means_a_distribution(data: Any, expected: Distribution) -> None:
    assert distribution("soil.k_phi", data) == expected


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ((1.0,), "expected a pair"),
        (3.0, "expected a pair"),
        ((2.0, 1.0), "low <= high"),
        ({"uniform": [1.0, float("nan")]}, "finite numbers"),
        ({"log_uniform": [0.0, 1.0]}, "0 < low"),
        ({"normal": [0.0, 0.0, -1.0, 1.0]}, "a deviation above 0"),
        ({"choice": []}, "one finite number"),
        ({"unifrom": [1.0, 2.0]}, "unknown distribution `unifrom`"),
        ({"uniform": [1.0, 2.0, 3.0]}, "expected a pair"),
        ({"uniform": [1.0, 1e9]}, "`soil.cohesion` = 1000000000 is outside"),
    ],
)
def test_property_nonsense_is_named(data: Any, message: str) -> None:
    with pytest.raises(bekker.BekkerError, match=message) as refused:
        bekker.RoverEnv(randomise={"soil.cohesion": data})
    assert "soil.cohesion" in str(refused.value) or "distribution" in str(refused.value)


def test_property_every_parameter_of_the_vocabulary_can_be_drawn() -> None:
    env = single("bekker/EnergyTraverse-v0", measured=True)
    model = env.setup.model
    every = [*model.parameters(), *model.sensors()]
    names = {variable["name"] for variable in every}
    assert {"soil.k_phi", "rover.mass", "terrain.roughness", "sensor.torque_noise", "multi_pass.growth", "x0"} <= names
    at_its_value = {variable["name"]: (variable["value"], variable["value"]) for variable in every}
    env = single("bekker/EnergyTraverse-v0", measured=True, randomise={**at_its_value, "terrain.seed": (3, 3)})
    observation, info = env.reset(seed=0)
    assert info["drawn"].keys() == at_its_value.keys() | {"terrain.seed"}
    plain = single("bekker/EnergyTraverse-v0", measured=True, randomise={"terrain.seed": (3, 3)})
    assert np.isfinite(observation).all() and observation.shape == plain.reset(seed=0)[0].shape


def test_property_what_is_drawn_is_what_is_driven() -> None:
    scatter = {"soil.k_phi": {"log_uniform": [4e5, 2e6]}, "sensor.pitch_bias": (-0.1, 0.1), "rover.mass": {"choice": [8.0, 12.0]}}
    env = single(randomise=scatter, measured=True, observe=["pitch"], observation_scales={"pitch": 1.0})
    true = single(observe=["pitch"], observation_scales={"pitch": 1.0})
    for seed in range(5):
        observation, info = env.reset(seed=seed)
        model = env.mechanics.models[0]
        drawn = info["drawn"]
        assert model.get("soil.k_phi") == drawn["soil.k_phi"] and drawn["rover.mass"] in (8.0, 12.0)
        parameters = {name: drawn[name] for name in ("soil.k_phi", "rover.mass")}
        level = true.reset(options={"parameters": parameters})[0][0]
        assert observation[0] == pytest.approx(level + drawn["sensor.pitch_bias"], abs=1e-6)  # 32-bit floats
        assert info["sinkage"][0] > 0.0


def test_property_another_distribution_leaves_the_other_draws() -> None:
    def drawn(first: Any) -> dict[str, float]:
        env = single(randomise={"soil.cohesion": first, "soil.k_phi": (5e5, 1e6)})
        found: dict[str, float] = env.reset(seed=4)[1]["drawn"]
        return found

    assert drawn((500, 1500))["soil.k_phi"] == drawn({"normal": [900, 100, 500, 1500]})["soil.k_phi"]


def test_property_options_draw_for_one_episode() -> None:
    env = single(randomise={"soil.cohesion": (500, 1500)})
    one = env.reset(seed=0, options={"randomise": {"soil.k_phi": (5e5, 6e5)}})[1]["drawn"]
    assert set(one) == {"soil.cohesion", "soil.k_phi"} and 5e5 <= one["soil.k_phi"] <= 6e5
    assert set(env.reset()[1]["drawn"]) == {"soil.cohesion"}
    many = vector(num_envs=2, randomise={"soil.cohesion": (500, 1500)})
    infos = many.reset(seed=0, options={"randomise": {"soil.k_phi": (5e5, 6e5)}})[1]["drawn"]
    assert infos["soil.k_phi"][0] == one["soil.k_phi"] and infos["_soil.k_phi"].all()
    infos = many.reset(options={"reset_mask": np.array([True, False])})[1]["drawn"]
    assert infos["_soil.cohesion"].tolist() == [True, False] and "soil.k_phi" not in infos


def test_property_a_level_grades_ground_and_ranges_on_a_living_environment() -> None:
    env = single("bekker/SlopeClimb-v0")
    slopes = {}
    for level in (0.0, 0.5, 1.0):
        env.level = level
        slopes[level] = [env.reset(seed=seed)[1]["drawn"]["terrain.slope"] for seed in range(20)]
    assert set(slopes[0.0]) == {0.0}
    assert 0.0 < max(slopes[0.5]) < max(slopes[1.0]) <= np.radians(10.0)
    # For one episode, and in a vector.
    assert env.reset(seed=0, options={"level": 0.0})[1]["drawn"]["terrain.slope"] == 0.0
    many = vector("bekker/SlopeClimb-v0", num_envs=2, level=0.0)
    assert np.all(many.reset(seed=0)[1]["drawn"]["terrain.slope"] == 0.0)
    many.level = 1.0
    assert np.all(many.reset(seed=0)[1]["drawn"]["terrain.slope"] > 0.0)
    with pytest.raises(bekker.InputError, match="level = 1.5"):
        env.level = 1.5


def test_property_what_the_user_sets_the_task_does_not_change() -> None:
    env = single("bekker/SlopeClimb-v0", parameters={"terrain.slope": 0.05, "soil.cohesion": 900.0})
    drawn = env.reset(seed=0)[1]["drawn"]
    assert set(drawn) == {"soil.friction_angle", "target_velocity"}
    assert env.mechanics.models[0].get("terrain.slope") == 0.05
    flat = single("bekker/EnergyTraverse-v0", terrain={"preset": "flat"})
    assert set(flat.reset(seed=0)[1]["drawn"]) == {"target_velocity"}


def test_property_random_ground_is_another_in_every_episode() -> None:
    env = single("bekker/EnergyTraverse-v0")
    heights = []
    for seed in (0, 1):
        env.reset(seed=seed)
        for _ in range(30):
            env.step(np.full(3, 0.5, np.float32))
        heights.append(env.mechanics.signals[0, env.mechanics.places["z"]])
    assert heights[0] != heights[1]


@pytest.mark.parametrize("task", TASKS)
def test_property_a_spec_travels_as_json_and_as_pickle(task: str) -> None:
    arguments = {"randomise": {"soil.k_phi": {"log_uniform": [8e5, 9e5]}}, "level": 0.5, "reward_weights": {"end": 2.0}}
    env = gymnasium.make(task, **arguments)
    assert env.spec is not None
    text = env.spec.to_json()
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(json.loads(json.dumps(text))))
    assert_same(env.reset(seed=0), again.reset(seed=0))
    assert_same(env.reset(seed=1), pickle.loads(pickle.dumps(again)).reset(seed=1))
