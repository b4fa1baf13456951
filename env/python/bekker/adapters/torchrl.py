# mypy: disable-error-code="import-untyped,import-not-found,misc,unused-ignore"
"""TorchRL: the native vector environment as a batch-locked ``EnvBase``.

::

    from bekker.adapters.torchrl import RoverTorchEnv
    env = RoverTorchEnv("bekker/SpeedHold-v0", 16)
    rollout = env.rollout(100, policy, break_when_any_done=False)
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

try:
    import torch
    from tensordict import TensorDict, TensorDictBase
    from torchrl.data import Bounded, Categorical, Composite, Unbounded
    from torchrl.envs import EnvBase
except ImportError as missing:
    raise ImportError("bekker.adapters.torchrl needs torchrl (pip install torchrl)") from missing

__all__ = ["RoverTorchEnv"]


class RoverTorchEnv(EnvBase):
    """Many rovers of one task as one environment of TorchRL; an entry of the batch that is done is reset by the
    collector, by ``_reset``, as TorchRL does it.

    Args:
        id: a registered id, as for ``gymnasium.make_vec``.
        num_envs: number of rovers, the batch size.
        arguments: as for ``gymnasium.make_vec``.
    """

    def __init__(self, id: str, num_envs: int, **arguments: Any) -> None:
        super().__init__(device=torch.device("cpu"), batch_size=torch.Size([num_envs]))
        self._env = gymnasium.make_vec(
            id, num_envs, vectorization_mode="vector_entry_point", autoreset_mode=AutoresetMode.DISABLED, **arguments
        )
        self._seed: int | None = None
        wide = torch.Size([num_envs])
        observed, acted = self._env.observation_space, self._env.action_space
        assert isinstance(observed, gymnasium.spaces.Box) and isinstance(acted, gymnasium.spaces.Box)
        low, high = torch.as_tensor(observed.low), torch.as_tensor(observed.high)
        self.observation_spec = Composite(observation=Bounded(low, high, dtype=torch.float32), shape=wide)
        low, high = torch.as_tensor(acted.low), torch.as_tensor(acted.high)
        self.action_spec = Bounded(low, high, dtype=torch.float32)
        self.reward_spec = Unbounded(shape=(num_envs, 1), dtype=torch.float32)
        flag = Categorical(2, shape=torch.Size([num_envs, 1]), dtype=torch.bool)
        self.done_spec = Composite(done=flag.clone(), terminated=flag.clone(), truncated=flag.clone(), shape=wide)

    def _reset(self, tensordict: TensorDictBase | None = None, **_: Any) -> TensorDictBase:
        mask = None if tensordict is None else tensordict.get("_reset", None)
        options: dict[str, Any] = {}
        if mask is not None:
            options["reset_mask"] = mask.reshape(self.batch_size).numpy().astype(np.bool_)
        observations, _ = self._env.reset(seed=self._seed, options=options)
        self._seed = None
        none = np.zeros(self.batch_size, np.bool_)
        return self._told(observations, none, none)

    def _step(self, tensordict: TensorDictBase) -> TensorDictBase:
        actions = tensordict["action"].detach().numpy()
        observations, rewards, terminated, truncated, _ = self._env.step(actions)
        told = self._told(observations, terminated, truncated)
        told["reward"] = torch.as_tensor(rewards, dtype=torch.float32).unsqueeze(-1)
        return told

    def _told(self, observations: Any, terminated: Any, truncated: Any) -> TensorDictBase:
        def flag(values: Any) -> torch.Tensor:
            return torch.as_tensor(np.asarray(values, dtype=np.bool_)).unsqueeze(-1)

        entries = {
            "observation": torch.as_tensor(np.asarray(observations, dtype=np.float32)),
            "terminated": flag(terminated),
            "truncated": flag(truncated),
            "done": flag(terminated | truncated),
        }
        return TensorDict(entries, batch_size=self.batch_size)

    def _set_seed(self, seed: int | None) -> None:
        self._seed = seed

    def close(self, *, raise_if_closed: bool = True) -> None:
        """Ends the environments."""
        super().close(raise_if_closed=raise_if_closed)
        self._env.close()
