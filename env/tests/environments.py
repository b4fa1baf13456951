"""What the tests of the environments share."""

from typing import Any

import gymnasium
import numpy as np

import bekker

TASKS = tuple(task.id for task in bekker.TASKS.values())
SINGLE = gymnasium.Env[Any, Any]


def single(task: str = "bekker/Rover-v0", **arguments: Any) -> bekker.RoverEnv:
    """The environment without wrappers."""
    env = gymnasium.make(task, **arguments).unwrapped
    assert isinstance(env, bekker.RoverEnv)
    return env


def vector(task: str = "bekker/Rover-v0", num_envs: int = 3, **arguments: Any) -> bekker.RoverVectorEnv:
    env = gymnasium.make_vec(task, num_envs=num_envs, **arguments)
    assert isinstance(env, bekker.RoverVectorEnv)
    return env


def actions_of(env: Any, steps: int, seed: int = 0) -> np.ndarray[Any, Any]:
    """Actions that drive forward most of the time, with standstill and reverse."""
    return np.random.default_rng(seed).uniform(-0.4, 1.0, (steps, *env.action_space.shape)).astype(np.float32)


def assert_same(a: Any, b: Any, where: str = "") -> None:
    """The same to the last bit: dictionaries, sequences, arrays, objects."""
    if isinstance(a, dict):
        assert a.keys() == b.keys(), (where, a.keys() ^ b.keys())
        for key in a:
            assert_same(a[key], b[key], f"{where}.{key}")
    elif isinstance(a, list | tuple):
        assert len(a) == len(b), where
        for k, pair in enumerate(zip(a, b, strict=True)):
            assert_same(*pair, f"{where}[{k}]")
    elif isinstance(a, np.ndarray) and a.dtype == object:
        assert_same(a.tolist(), b.tolist(), where)
    else:
        assert np.array_equal(a, b), (where, a, b)
        assert getattr(a, "dtype", None) == getattr(b, "dtype", None), where
