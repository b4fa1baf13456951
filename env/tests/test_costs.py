"""Costs of safety, apart from the reward."""

from typing import Any

import bekker
import numpy as np
import pytest
from bekker.costs import COSTS, Cost, CostInStep
from environments import TASKS, actions_of, single, vector

STEPS = 150


def driven(env: Any, seed: int = 1) -> list[dict[str, Any]]:
    env.reset(seed=seed)
    infos = []
    for action in actions_of(env, STEPS):
        *_, terminated, truncated, info = env.step(action)
        infos.append(info)
        if terminated or truncated:
            break
    return infos


@pytest.mark.parametrize("task", TASKS)
def test_property_costs_count_the_steps_beyond_their_limits(task: str) -> None:
    env = single(task, costs=True)
    radius = env.mechanics.models[0].get("wheel.radius")
    speeds = [env.mechanics.places[f"wheel[{k}].speed"] for k in range(1, env.setup.model.wheels + 1)]
    env.reset(seed=1)
    for action in actions_of(env, STEPS):
        *_, over, _, info = env.step(action)
        moving = np.abs(env.mechanics.signals[0, speeds]) * radius > 0.02
        assert info["cost_slip"] == float(np.any(moving & (np.abs(info["slip"]) > env.setup.slip_limit)))
        assert info["cost_sinkage"] == float(np.any(info["sinkage"] > 0.5 * radius))
        assert info["cost_belly"] == float(info["status"] == "belly_contact")
        assert info["cost"] == sum(info[f"cost_{name}"] for name in COSTS)
        if over:
            break


def test_property_limits_are_those_that_are_given() -> None:
    strict, loose = single(costs={"slip": 0.01, "tilt": 1e-4}), single(costs={"slip": 2.0, "tilt": 1.0})
    few, many = driven(loose), driven(strict)
    assert sum(info["cost"] for info in few) == 0.0
    assert {info["cost_slip"] for info in many} >= {1.0}
    assert {info["cost_tilt"] for info in many} >= {1.0}
    assert set(few[0]) & {"cost_sinkage", "cost_belly"} == set()


def test_property_without_costs_nothing_changes() -> None:
    plain, priced = single("bekker/SlopeClimb-v0"), single("bekker/SlopeClimb-v0", costs=True)
    for without, priced_info in zip(driven(plain), driven(priced), strict=True):
        assert not any(key.startswith("cost") for key in without)
        assert {key: without[key] for key in ("x", "time", "reward_progress")} == {key: priced_info[key] for key in ("x", "time", "reward_progress")}


def test_property_costs_of_many_are_those_of_each() -> None:
    arguments: dict[str, Any] = {"costs": {"slip": 0.1, "sinkage": 0.2, "tilt": 0.02, "belly": 0.0}}
    many = vector("bekker/SpeedHold-v0", 3, **arguments)
    many.reset(seed=5)
    singles = [single("bekker/SpeedHold-v0", **arguments) for _ in range(3)]
    for k, env in enumerate(singles):
        env.reset(seed=5 + k)
    total = np.zeros(3)
    for action in actions_of(singles[0], 60):
        *_, infos = many.step(np.tile(action, (3, 1)))
        alone = [env.step(action)[-1] for env in singles]
        for key in ("cost", "cost_slip", "cost_sinkage", "cost_tilt", "cost_belly"):
            np.testing.assert_array_equal(infos[key], [info[key] for info in alone])
        total += infos["cost"]
    assert total.min() > 0.0


def test_property_a_cost_of_the_users_own_and_the_interface_of_safety_gymnasium() -> None:
    fast = Cost("fast", 0.005, "m/s", "the rover is fast", lambda step, limit: np.abs(step.signal("velocity")) > limit)
    env = CostInStep(single(costs=["slip", fast]))
    env.reset(seed=0)
    seen = set()
    for action in actions_of(env, 150):
        _, _, cost, _, _, info = env.step(action)
        assert cost == info["cost_slip"] + info["cost_fast"]
        seen.add(info["cost_fast"])
    assert seen == {0.0, 1.0}


@pytest.mark.parametrize(
    ("costs", "message"),
    [
        (["slide"], "slide"),
        ("slip", "expected a list of costs"),
        ({"slip": float("nan")}, "limit of the cost `slip`"),
        ({"tilt": "steep"}, "limit of the cost `tilt`"),
    ],
)
def test_property_bad_costs_are_named(costs: Any, message: str) -> None:
    with pytest.raises((bekker.InputError, bekker.UnknownNameError), match=message):
        single(costs=costs)


def test_property_the_interface_asks_for_costs() -> None:
    with pytest.raises(bekker.InputError, match="costs=True"):
        CostInStep(single())
