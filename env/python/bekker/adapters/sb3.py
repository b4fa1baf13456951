# mypy: disable-error-code="import-untyped,import-not-found,misc,unused-ignore"
"""stable-baselines3: the native vector environment as its ``VecEnv``.

::

    from bekker.adapters.sb3 import RoverVecEnv
    model = PPO("MlpPolicy", RoverVecEnv("bekker/SpeedHold-v0", 16, threads=2))
"""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as missing:
    raise ImportError("bekker.adapters.sb3 needs stable-baselines3 (pip install stable-baselines3)") from missing

from ..errors import InputError
from ..vector_env import RoverVectorEnv

__all__ = ["RoverVecEnv"]


class RoverVecEnv(VecEnv):
    """Many rovers of one task, stepped together in the core.

    An environment that ends starts anew in the same step: the observation is that of the new episode, and ``info`` has
    the last one as ``terminal_observation``, ``TimeLimit.truncated``, and under ``episode`` its return ``r``, length ``l``
    and duration ``t`` (simulated seconds), as `Monitor` would write.

    Args:
        id: a registered id, as for ``gymnasium.make_vec``.
        num_envs: number of rovers.
        arguments: as for ``gymnasium.make_vec``: ``threads``, ``parameters``, ``randomise`` ...
    """

    def __init__(self, id: str, num_envs: int, **arguments: Any) -> None:
        made = gymnasium.make_vec(id, num_envs, vectorization_mode="vector_entry_point",
                                  autoreset_mode=AutoresetMode.SAME_STEP, **arguments)
        inner = made.unwrapped
        if not isinstance(inner, RoverVectorEnv):
            raise InputError(f"`{id}`: expected an environment of bekker")
        self.env = inner
        self._actions: NDArray[np.float32] | None = None
        self._returns = np.zeros(num_envs)
        self._lengths = np.zeros(num_envs, np.int64)
        self.render_mode = inner.render_mode
        super().__init__(num_envs, inner.single_observation_space, inner.single_action_space)

    def reset(self) -> NDArray[np.float32]:
        """Starts all episodes, with the seeds and options set before."""
        seeds = self._seeds if any(seed is not None for seed in self._seeds) else None
        options = next((options for options in self._options if options), None)
        observations, infos = self.env.reset(seed=seeds, options=options)
        self.reset_infos = [_entry(infos, k) for k in range(self.num_envs)]
        self._returns[:], self._lengths[:] = 0.0, 0
        self._reset_seeds()
        self._reset_options()
        return np.asarray(observations, dtype=np.float32)

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Keeps the actions for :meth:`step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Steps all rovers."""
        if self._actions is None:
            raise InputError("step_wait(): expected step_async(actions) before it")
        observations, rewards, terminated, truncated, infos = self.env.step(self._actions)
        self._actions = None
        self._returns += rewards
        self._lengths += 1
        done = terminated | truncated
        listed: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for k in np.flatnonzero(done):
            info = _entry(infos["final_info"], int(k))
            info["terminal_observation"] = infos["final_obs"][k]
            info["TimeLimit.truncated"] = bool(truncated[k] and not terminated[k])
            info["episode"] = {"r": float(self._returns[k]), "l": int(self._lengths[k]), "t": info["time"]}
            listed[k] = info
        self._returns[done], self._lengths[done] = 0.0, 0
        return np.asarray(observations, dtype=np.float32), rewards.astype(np.float32), done, listed

    def close(self) -> None:
        """Ends the environments."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """An attribute of the vector environment, once for each index."""
        return [getattr(self.env, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Sets an attribute of the vector environment, such as ``level``: of all rovers at once."""
        if len(list(self._get_indices(indices))) != self.num_envs:
            raise InputError(f"set_attr({attr_name!r}): the rovers share it, expected all indices")
        setattr(self.env, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Calls a method of the vector environment, once."""
        result = getattr(self.env, method_name)(*method_args, **method_kwargs)
        return [result] * len(list(self._get_indices(indices)))

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Never: rovers have no wrappers of their own."""
        return [False] * len(list(self._get_indices(indices)))

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A frame of every rover."""
        frames = self.env.render()
        return [None] * self.num_envs if frames is None else list(frames)


def _entry(infos: dict[str, Any], k: int) -> dict[str, Any]:
    """What a vector environment's ``info`` says of one environment."""
    entry: dict[str, Any] = {}
    for name, values in infos.items():
        if name.startswith("_") or name in ("final_info", "final_obs"):
            continue
        entry[name] = {key: float(column[k]) for key, column in values.items() if not key.startswith("_")} \
            if isinstance(values, dict) else values[k]
    return entry
