"""Controllers behind ``predict``: the core's own, seen through the observation."""

import gymnasium
import numpy as np
import pytest

import bekker
from bekker import baselines


def made(task: str = "SpeedHold", **arguments: object) -> gymnasium.Env:
    return gymnasium.make(f"bekker/{task}-v0", **arguments)


def test_agreement_velocity_control_through_the_observation_is_that_of_the_core() -> None:
    """The same loop, closed outside: what is between is the rounding of observations and actions to single precision."""
    period, speed = 0.02, 0.2
    model = bekker.Model.from_preset("gentle_velocity")
    model.set("velocity_control.period", period)
    inside = bekker.simulate(model, 4.0, {"velocity_command": speed}, period=period)
    torques = model.copy()
    torques.set_control("torque")
    env = gymnasium.make("bekker/Rover-v0", model=torques, period=period, action_scale=10.0)
    policy = baselines.velocity(env, speed)
    observation, _ = env.reset(seed=0)
    x = [0.0]
    for k in range(200):
        action, _ = policy.predict(observation, episode_start=k == 0)
        observation, _, _, _, info = env.step(action)
        x.append(info["distance"])
    # A tenth of a millimetre in 60 cm.
    assert np.abs(np.array(x) - (inside["x"] - inside["x"][0])).max() < 1e-4
    assert x[-1] > 0.2


@pytest.mark.parametrize("policy", [baselines.velocity, baselines.rtc, baselines.rtc_speed, baselines.slip_control])
def test_property_controllers_hold_a_speed_better_than_doing_nothing(policy: object) -> None:
    env = made()
    still = baselines.evaluate(env, baselines.constant(env, 0.0), range(2)).returns
    driven = baselines.evaluate(env, policy(env), range(2))
    assert (driven.returns > still + 10.0).all() and (driven.distance > 1.0).all()


def test_property_an_episode_starts_a_controller_anew() -> None:
    env = made()
    policy = baselines.velocity(env)
    first = baselines.evaluate(env, policy, [4])
    assert np.array_equal(baselines.evaluate(env, policy, [4]).returns, first.returns)


def test_property_wheel_speeds_where_these_are_the_actions() -> None:
    env = made("SlopeClimb")
    result = baselines.evaluate(env, baselines.velocity(env, 0.2), [0])
    assert result.distance[0] > 0.5
    with pytest.raises(bekker.InputError, match="commands torques"):
        baselines.rtc(env)


def test_property_what_a_controller_needs_is_named() -> None:
    env = gymnasium.make("bekker/Rover-v0", observe=["pitch", "velocity"])
    with pytest.raises(bekker.InputError, match=r"needs pitch_rate, wheel\[1\].speed"):
        baselines.velocity(env)
    with pytest.raises(bekker.InputError, match="expected an environment of bekker"):
        baselines.constant(gymnasium.make("CartPole-v1"))


def test_analytic_interval_of_equal_returns_is_a_point() -> None:
    returns = np.full(5, 2.5)
    zeros = np.zeros(5)
    result = baselines.Evaluation(returns, zeros > 1, zeros, zeros, zeros.astype(np.int64), ["running"] * 5)
    assert result.interval == (2.5, 2.5)
    result.returns = np.random.default_rng(1).normal(0.0, 1.0, 400)
    low, high = result.interval
    # 1.96 / sqrt(400) either way; a tenth for the bootstrap and the sample's own spread.
    assert high - low == pytest.approx(2 * 1.96 / 20, rel=0.15)
