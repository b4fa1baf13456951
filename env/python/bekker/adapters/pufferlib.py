# mypy: disable-error-code="import-untyped,import-not-found,misc,unused-ignore"
"""PufferLib: the native vector environment as a ``PufferEnv``, which writes into PufferLib's own buffers.

::

    from bekker.adapters.pufferlib import RoverPufferEnv
    env = RoverPufferEnv("bekker/SpeedHold-v0", 16)
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

try:
    from pufferlib.environment import PufferEnv
except ImportError as missing:
    raise ImportError("bekker.adapters.pufferlib needs pufferlib (pip install pufferlib)") from missing

from ..errors import InputError
from ..vector_env import RoverVectorEnv

__all__ = ["RoverPufferEnv"]


class RoverPufferEnv(PufferEnv):
    """Many rovers of one task, each an agent. Episodes that end start anew in the same step; the return and length of each
    come in the list of infos.

    Args:
        id: a registered id, as for ``gymnasium.make_vec``.
        num_envs: number of rovers.
        buf: the buffers that PufferLib gives.
        arguments: as for ``gymnasium.make_vec``.
    """

    def __init__(self, id: str, num_envs: int = 1, buf: Any = None, **arguments: Any) -> None:
        made = gymnasium.make_vec(
            id, num_envs, vectorization_mode="vector_entry_point", autoreset_mode=AutoresetMode.SAME_STEP, **arguments
        )
        inner = made.unwrapped
        if not isinstance(inner, RoverVectorEnv):
            raise InputError(f"`{id}`: expected an environment of bekker")
        self.env = inner
        self.single_observation_space = inner.single_observation_space
        self.single_action_space = inner.single_action_space
        self.num_agents = num_envs
        self._returns, self._lengths = np.zeros(num_envs), np.zeros(num_envs, np.int64)
        super().__init__(buf)

    def reset(self, seed: int | None = None) -> tuple[Any, list[dict[str, Any]]]:
        """Starts all episodes."""
        self.observations[:], _ = self.env.reset(seed=seed)
        self._returns[:], self._lengths[:] = 0.0, 0
        return self.observations, []

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, list[dict[str, Any]]]:
        """Steps all rovers; actions beyond -1 to 1, which a Gaussian policy gives, are cut."""
        cut = np.clip(actions, -1.0, 1.0)
        self.observations[:], rewards, self.terminals[:], self.truncations[:], _ = self.env.step(cut)
        self.rewards[:] = rewards
        self._returns += rewards
        self._lengths += 1
        infos = []
        for k in np.flatnonzero(self.terminals | self.truncations):
            infos.append({"episode_return": float(self._returns[k]), "episode_length": int(self._lengths[k])})
            self._returns[k], self._lengths[k] = 0.0, 0
        return self.observations, self.rewards, self.terminals, self.truncations, infos

    def close(self) -> None:
        """Ends the environments."""
        self.env.close()
