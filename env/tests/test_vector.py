"""The vector environment: what gymnasium's own does, whatever the batch and the threads."""

import copy
import pickle
import threading
from typing import Any

import gymnasium
import numpy as np
import pytest
from environments import TASKS, actions_of, assert_same, vector
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import bekker

MODES = list(AutoresetMode)
# Torques that dig in: episodes end by events, others by time.
LIMIT = 45
DIGGING: dict[str, Any] = {
    "action_scale": 12.0,
    "randomise": {"soil.cohesion": (300.0, 2000.0), "x0": (-1.0, 1.0)},
    "max_episode_steps": LIMIT,
    "measured": True,
    "parameters": {
        "sensor.pitch_noise": 0.01,
        "sensor.torque_noise": 0.05,
        "sensor.wheel_speed_resolution": 0.05,
        "motor.inverse_voltage": 0.0,
        "motor.inverse_current_limit": 0.0,
    },
}


def in_python(num_envs: int, mode: AutoresetMode, task: str = "bekker/Rover-v0", **arguments: Any) -> SyncVectorEnv:
    """Gymnasium's vector of single environments."""
    return SyncVectorEnv([lambda: gymnasium.make(task, **arguments) for _ in range(num_envs)], autoreset_mode=mode)


@pytest.mark.parametrize("mode", MODES)
def test_agreement_gymnasium_vectorises_single_environments_to_the_same(mode: AutoresetMode) -> None:
    count = 5
    ours = vector(num_envs=count, autoreset_mode=mode, threads=2, **DIGGING)
    theirs = in_python(count, mode, **DIGGING)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    assert ours.single_action_space == theirs.single_action_space
    assert_same(ours.reset(seed=7), theirs.reset(seed=7))
    ended = np.zeros(count, np.bool_)
    seen = [0, 0]
    for k, action in enumerate(actions_of(ours, 3 * LIMIT)):
        if mode == AutoresetMode.DISABLED and ended.any():
            options = {"reset_mask": ended.copy()}
            assert_same(ours.reset(options=dict(options)), theirs.reset(options=dict(options)), f"reset {k}")
        mine, other = ours.step(action), theirs.step(action)
        assert_same(mine, other, f"step {k}")
        ended = mine[2] | mine[3]
        seen[0] += int(mine[2].sum())
        seen[1] += int(mine[3].sum())
    assert min(seen) > 0, "no episode ended by an event, or none by time"


@pytest.mark.parametrize("mode", MODES)
def test_agreement_episodes_start_anew_when_those_of_cart_pole_do(mode: AutoresetMode) -> None:
    """Ends at the same steps in both: which steps reset, whose reward is 0, and where the flags stand."""
    count, limit, turns = 2, 7, 30
    carts = gymnasium.make_vec(
        "CartPole-v1", num_envs=count, vectorization_mode="sync", vector_kwargs={"autoreset_mode": mode},
        max_episode_steps=limit,
    )
    rovers = vector(num_envs=count, autoreset_mode=mode, max_episode_steps=limit)
    carts.reset(seed=0)
    rovers.reset(seed=0)
    ended = np.zeros(count, np.bool_)
    for turn in range(turns):
        if mode == AutoresetMode.DISABLED and ended.any():
            carts.reset(options={"reset_mask": ended.copy()})
            rovers.reset(options={"reset_mask": ended.copy()})
        # Poles that are pushed to and fro stand for longer than the limit.
        _, cart_rewards, *cart_flags, cart_info = carts.step(np.full(count, turn % 2))
        _, rewards, *flags, info = rovers.step(np.zeros(rovers.action_space.shape, np.float32))
        assert_same(flags, cart_flags, f"step {turn}")
        # A step that resets is worth nothing, and starts the clock anew.
        reset = cart_rewards == 0.0
        assert np.all(rewards[reset] == 0.0) and np.array_equal(info["time"] == 0.0, reset | _started_again(mode, flags))
        assert ("final_obs" in info) == ("final_obs" in cart_info)
        ended = flags[0] | flags[1]
    assert rovers.metadata["autoreset_mode"] is mode and rovers.autoreset_mode is mode


def _started_again(mode: AutoresetMode, flags: list[Any]) -> Any:
    return (flags[0] | flags[1]) if mode == AutoresetMode.SAME_STEP else np.zeros(len(flags[0]), np.bool_)


def test_agreement_native_cart_pole_has_the_same_next_step_mode() -> None:
    """Gymnasium's own native vector environment, which resets in the next step only."""
    carts = gymnasium.make_vec("CartPole-v1", num_envs=2, vectorization_mode="vector_entry_point", max_episode_steps=5)
    rovers = vector(num_envs=2, max_episode_steps=5)
    carts.reset(seed=0)
    rovers.reset(seed=0)
    for turn in range(20):
        _, cart_rewards, *cart_flags, _ = carts.step(np.full(2, turn % 2))
        _, rewards, *flags, info = rovers.step(np.zeros((2, 2), np.float32))
        assert_same(flags, cart_flags, f"step {turn}")
        assert np.array_equal(info["time"] == 0.0, cart_rewards == 0.0) and np.all(rewards[cart_rewards == 0.0] == 0.0)


@pytest.mark.parametrize("task", TASKS)
def test_property_environment_i_does_what_a_single_one_with_the_seed_plus_i_does(task: str) -> None:
    steps, limit, seed = 60, 25, 11
    runs = {}
    for count, threads in ((1, 1), (4, 1), (4, 3), (7, 2)):
        env = vector(task, num_envs=count, threads=threads, max_episode_steps=limit, autoreset_mode="SameStep")
        actions = actions_of(vector(task, num_envs=7), steps)[:, :count]
        said = [env.reset(seed=seed)[0]] + [env.step(action)[:4] for action in actions]
        runs[count, threads] = said
        for index in range(min(count, 2)):
            alone = gymnasium.make(task, max_episode_steps=limit)
            observation, _ = alone.reset(seed=seed + index)
            assert np.array_equal(observation, said[0][index])
            for action, row in zip(actions, said[1:], strict=True):
                observation, reward, terminated, truncated, _ = alone.step(action[index])
                if terminated or truncated:
                    observation, _ = alone.reset()
                assert_same([observation, reward, terminated, truncated], [row[0][index], *(float(row[1][index]), *(bool(flag[index]) for flag in row[2:]))])
    assert_same(runs[4, 1], runs[4, 3])


def test_property_a_batch_of_any_size_gives_each_rover_the_same_bits() -> None:
    sizes = (1, 2, 3, 8, 33)
    actions = np.random.default_rng(0).uniform(-0.4, 1.0, (20, max(sizes), 2)).astype(np.float32)
    first = []
    for size in sizes:
        env = vector("bekker/SpeedHold-v0", num_envs=size)
        said = [env.reset(seed=3)[0][0]] + [env.step(action[:size])[0][0] for action in actions]
        first.append(np.array(said))
    assert all(np.array_equal(said, first[0]) for said in first)


def test_property_a_mask_resets_some_and_leaves_the_others() -> None:
    env = vector(num_envs=3)
    env.reset(seed=0)
    actions = actions_of(env, 20)
    for action in actions[:10]:
        before = env.step(action)[0]
    observations, infos = env.reset(seed=[5, None, None], options={"reset_mask": np.array([True, False, False])})
    assert np.array_equal(observations[1:], before[1:]) and infos["_time"].tolist() == [True, False, False]
    assert np.array_equal(observations[0], vector(num_envs=1).reset(seed=5)[0][0])
    assert env.step(actions[10])[4]["time"].tolist() == [0.02, 0.22, 0.22]


@pytest.mark.parametrize("mask", [[True, False], np.array([1, 0]), np.array([True]), np.array([False, False])])
def test_property_bad_masks_are_named(mask: Any) -> None:
    with pytest.raises(bekker.InputError, match="reset_mask"):
        vector(num_envs=2).reset(options={"reset_mask": mask})


def test_property_snapshots_go_on_to_the_same_bits() -> None:
    env = vector(num_envs=4, **DIGGING)
    env.reset(seed=0)
    actions = actions_of(env, 90)
    for action in actions[:30]:
        env.step(action)
    snapshot = env.snapshot()
    first = [env.step(action) for action in actions[30:]]
    env.restore(snapshot)
    assert_same(first, [env.step(action) for action in actions[30:]])
    # A snapshot can be used more than once, and in another environment.
    other = vector(num_envs=4, threads=2, **DIGGING)
    other.restore(snapshot)
    assert_same(first, [other.step(action) for action in actions[30:]])


@pytest.mark.parametrize("how", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_property_copies_and_pickles_go_on_to_the_same_bits(how: Any) -> None:
    arguments = DIGGING | {"parameters": DIGGING["parameters"] | {"multi_pass.growth": 0.2, "winding_heat.time_constant": 2.0}}
    alone = gymnasium.make("bekker/Rover-v0", **arguments)
    many = vector(num_envs=3, **arguments)
    for env in (alone, many):
        env.reset(seed=1)
        actions = actions_of(env, 90)
        for action in actions[:15]:
            env.step(action)
        twin = how(env)

        def goes_on(some: Any, actions: Any = actions) -> list[Any]:
            said = []
            for action in actions[15:]:
                said.append(some.step(action))
                if isinstance(said[-1][2], bool) and (said[-1][2] or said[-1][3]):
                    said.append(some.reset())
            return said

        assert_same(goes_on(env), goes_on(twin))


def test_property_without_copies_observations_are_overwritten() -> None:
    env = vector(num_envs=2, copy=False)
    first, _ = env.reset(seed=0)
    before = first.copy()
    second = env.step(np.full((2, 2), 0.8, np.float32))[0]
    assert second is first and not np.array_equal(before, second)
    kept, _ = vector(num_envs=2).reset(seed=0)
    assert np.array_equal(kept, before)


def test_property_a_second_thread_during_a_step_is_refused() -> None:
    env = vector(num_envs=64, period=0.2)
    env.reset(seed=0)
    still, told = np.zeros((64, 2)), []

    def drive() -> None:
        try:
            for _ in range(10):
                env.step(still)
        except bekker.SimulationError as refused:
            told.append(str(refused))

    threads = [threading.Thread(target=drive) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    # A step of 64 rovers over 0.2 s takes milliseconds, so that the steps of the two threads overlap.
    assert told and all("another thread steps these rovers" in message for message in told)


def test_property_a_bad_action_is_named_and_moves_nothing() -> None:
    env = vector(num_envs=2)
    with pytest.raises(gymnasium.error.ResetNeeded, match="environment 0"):
        env.step(np.zeros((2, 2)))
    env.reset(seed=0)
    with pytest.raises(bekker.InputError, match=r"action\[1, 0\] = nan"):
        env.step(np.array([[0.1, 0.1], [np.nan, 0.0]]))
    with pytest.raises(bekker.InputError, match=r"have shape \(2,\), expected \(2, 2\): a row for each rover"):
        env.step(np.zeros(2))
    with pytest.raises(bekker.InputError, match=r"have shape \(3,\), expected \(2, 2\)"):
        env.step(np.zeros(3))
    assert not env.unwrapped.mechanics.inputs.any()
    assert env.step(np.zeros((2, 2)))[4]["time"].tolist() == [0.02, 0.02]


def test_agreement_actions_of_any_type_are_computed_in_double_precision() -> None:
    single = np.random.default_rng(4).uniform(-1.0, 1.0, (20, 3, 2)).astype(np.float32)
    given: list[list[Any]] = [list(single), list(single.astype(np.float64)), single.astype(np.float64).tolist()]
    # As views with gaps too.
    given.append([np.repeat(action, 2, axis=0)[::2] for action in single])
    seen = []
    for actions in given:
        env = vector(num_envs=3)
        env.reset(seed=1)
        for action in actions:
            env.step(action)
        inputs = np.asarray(actions[-1], dtype=np.float64) * env.unwrapped.setup.action_scale
        assert np.array_equal(env.unwrapped.mechanics.inputs, inputs)
        seen.append(env.unwrapped.mechanics.signals.tobytes())
    assert len(set(seen)) == 1
    whole, exact = vector(num_envs=1), vector(num_envs=1)
    whole.reset(seed=1)
    exact.reset(seed=1)
    assert_same(whole.step([[1, 0]]), exact.step([[1.0, 0.0]]))


def test_property_without_autoreset_a_step_after_the_end_is_refused() -> None:
    env = vector(num_envs=2, autoreset_mode="Disabled", max_episode_steps=2)
    env.reset(seed=0)
    for _ in range(2):
        env.step(np.zeros((2, 2)))
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"\[0, 1\] have ended"):
        env.step(np.zeros((2, 2)))


def test_agreement_gymnasium_steps_single_environments_in_forked_processes_to_the_same() -> None:
    ours = vector(num_envs=2, **DIGGING)
    theirs = gymnasium.make_vec(
        "bekker/Rover-v0", num_envs=2, vectorization_mode="async", vector_kwargs={"context": "fork"}, **DIGGING
    )
    try:
        assert_same(ours.reset(seed=2), theirs.reset(seed=2))
        for action in actions_of(ours, 10):
            assert_same(ours.step(action), theirs.step(action))
    finally:
        theirs.close()


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_agreement_gymnasium_wrappers_count_our_episodes(mode: AutoresetMode) -> None:
    env = vector(num_envs=2, autoreset_mode=mode, max_episode_steps=10)
    counted = gymnasium.wrappers.vector.RecordEpisodeStatistics(env)
    counted.reset(seed=0)
    returns, lengths = np.zeros(2), []
    for action in actions_of(env, 10):
        _, rewards, _, _, infos = counted.step(action)
        returns += rewards
    final = infos["final_info"]["episode"] if mode == AutoresetMode.SAME_STEP and "episode" not in infos else infos["episode"]
    lengths = final["l"].tolist()
    assert lengths == [10, 10] and final["r"] == pytest.approx(returns, rel=1e-12)  # sums in another precision
