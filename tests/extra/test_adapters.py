"""The bridges with the real libraries, whichever are installed: ``bash tests/extra.sh`` installs them all."""

import importlib
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import bekker

ID = "bekker/SpeedHold-v0"


def test_agreement_sb3_gives_what_gymnasium_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("stable_baselines3")
    sb3 = importlib.import_module("bekker.adapters.sb3")
    many = sb3.RoverVecEnv(ID, 3, max_episode_steps=5)
    many.seed(7)
    observations = many.reset()
    single = gymnasium.make(ID, max_episode_steps=5)
    expected, _ = single.reset(seed=8)
    action = np.full((3, 2), 0.4, np.float32)
    for k in range(5):
        assert np.array_equal(observations[1], expected)
        observations, rewards, done, infos = many.step(action)
        expected, reward, terminated, truncated, _ = single.step(action[1])
        assert rewards[1] == np.float32(reward) and done[1] == (terminated or truncated)
        assert bool(infos[1]) == (k == 4)
    assert np.array_equal(infos[1]["terminal_observation"], expected) and infos[1]["TimeLimit.truncated"] is True
    assert infos[1]["episode"]["l"] == 5 and not np.array_equal(observations[1], expected)
    assert many.get_attr("level") == [1.0] * 3
    many.set_attr("level", 0.5)
    assert many.get_attr("level", 0) == [0.5]


def test_property_sb3_learns_and_a_saved_policy_drives(tmp_path: Path) -> None:
    sb3 = pytest.importorskip("stable_baselines3")
    adapter = importlib.import_module("bekker.adapters.sb3")
    agent = sb3.PPO("MlpPolicy", adapter.RoverVecEnv(ID, 4), n_steps=16, batch_size=32, n_epochs=1, device="cpu")
    agent.learn(128)
    agent.save(tmp_path / "agent")
    policy = bekker.baselines.trained(tmp_path / "agent.zip")
    env = gymnasium.make(ID, max_episode_steps=20)
    assert bekker.baselines.evaluate(env, policy, [0]).steps[0] == 20


def test_property_torchrl_accepts_the_environment() -> None:
    pytest.importorskip("torchrl")
    adapter = importlib.import_module("bekker.adapters.torchrl")
    utils = importlib.import_module("torchrl.envs.utils")
    env = adapter.RoverTorchEnv(ID, 3, max_episode_steps=8)
    env.set_seed(5)
    utils.check_env_specs(env)
    rollout = env.rollout(20, break_when_any_done=False)
    assert rollout["next", "done"].sum() == 2 * 3


def test_property_pufferlib_writes_into_its_buffers() -> None:
    pytest.importorskip("pufferlib.environment")
    adapter = importlib.import_module("bekker.adapters.pufferlib")
    env = adapter.RoverPufferEnv(ID, 3, max_episode_steps=5)
    observations, _ = env.reset(seed=1)
    assert observations is env.observations
    for _ in range(5):
        _, _, terminals, truncations, infos = env.step(np.full((3, 2), 0.4, np.float32))
    assert truncations.all() and not terminals.any() and [info["episode_length"] for info in infos] == [5, 5, 5]


def test_property_minari_reads_back_what_was_driven(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    minari = pytest.importorskip("minari")
    adapter = importlib.import_module("bekker.adapters.minari")
    env = gymnasium.make(ID, max_episode_steps=30)
    policy = bekker.baselines.slip_control(env)
    adapter.collect(env, policy, range(2), "bekker/speed-hold/slip-v0")
    episodes = list(minari.load_dataset("bekker/speed-hold/slip-v0").iterate_episodes())
    result = bekker.baselines.evaluate(env, policy, range(2))
    assert [len(episode.rewards) for episode in episodes] == [30, 30]
    assert np.allclose([episode.rewards.sum() for episode in episodes], result.returns, rtol=1e-6)
    assert episodes[0].observations.shape == (31, 10) and "slip" in episodes[0].infos


def test_property_videos_are_recorded(tmp_path: Path) -> None:
    pytest.importorskip("moviepy")
    env = gymnasium.wrappers.RecordVideo(gymnasium.make(ID, render_mode="rgb_array"), str(tmp_path))
    env.reset(seed=0)
    for _ in range(10):
        env.step(env.action_space.sample())
    env.close()
    (video,) = tmp_path.glob("*.mp4")
    assert video.stat().st_size > 1000


def test_agreement_a_window_shows_the_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    shown, drawn = (gymnasium.make(ID, render_mode=mode) for mode in ("human", "rgb_array"))
    try:
        for env in (shown, drawn):
            env.reset(seed=0)
            env.render()  # the ruts begin with the first frame
            env.step(np.full(2, 0.5, np.float32))
        window = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
        assert np.array_equal(window, drawn.render())
    finally:
        shown.close()


def test_property_rllib_reads_the_environment() -> None:
    pytest.importorskip("ray.rllib")
    config = importlib.import_module("ray.rllib.algorithms.ppo").PPOConfig()
    config = config.environment(f"bekker:{ID}").training(train_batch_size=64, minibatch_size=32, num_epochs=1)
    config = config.env_runners(num_env_runners=0, num_envs_per_env_runner=4, gym_env_vectorize_mode="vector_entry_point")
    algorithm = config.build_algo()
    try:
        assert algorithm.train()["num_env_steps_sampled_lifetime"] >= 64
    finally:
        algorithm.stop()


def test_property_offline_sets_are_made_again_to_the_bit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("minari")
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "examples"))
    data = importlib.import_module("offline_data")
    assert set(data.read()) == set(data.SETS)
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    for name, row in data.read().items():
        assert data.digest(data.make(name, episodes=2), 2) == row["first_two"], name
