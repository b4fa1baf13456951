# mypy: disable-error-code="import-untyped,import-not-found,misc,unused-ignore"
"""Minari: episodes of a policy as a data set, for learning from controllers.

::

    from bekker.adapters.minari import collect
    env = gymnasium.make("bekker/SpeedHold-v0")
    dataset = collect(env, bekker.baselines.slip_control(env), seeds=range(100), dataset_id="bekker/speed-hold/slip-v0")
"""

from collections.abc import Iterable
from typing import Any

import gymnasium
import numpy as np

try:
    from minari import DataCollector, StepDataCallback
except ImportError as missing:
    raise ImportError("bekker.adapters.minari needs minari (pip install 'minari[hdf5,create]')") from missing

from ..baselines import Policy

__all__ = ["collect"]

# What of `info` is kept: the same keys at every step, as a data set needs them.
_KEPT = ("time", "distance", "electrical_energy", "slip", "sinkage", "success")


class _Numbers(StepDataCallback):
    """Keeps the numbers of ``info`` that every step has."""

    def __call__(self, env: Any, **kwargs: Any) -> Any:
        data = super().__call__(env, **kwargs)
        info = data.get("info") or {}
        data["info"] = {name: np.asarray(info[name]) for name in _KEPT if name in info}
        return data


def collect(
    env: gymnasium.Env[Any, Any], policy: Policy, seeds: Iterable[int], dataset_id: str, *, algorithm: str = "controller"
) -> Any:
    """Drives one episode a seed and writes them as a data set of Minari, which is returned.

    Raises:
        ValueError: there is a data set of this id already.
    """
    collector = DataCollector(env, step_data_callback=_Numbers, record_infos=True)
    for seed in seeds:
        observation, _ = collector.reset(seed=int(seed))
        over, state = False, None
        start: Any = np.ones(1, dtype=np.bool_)
        while not over:
            action, state = policy.predict(observation, state=state, episode_start=start, deterministic=True)
            start = np.zeros(1, dtype=np.bool_)
            observation, _, terminated, truncated, _ = collector.step(action)
            over = bool(terminated or truncated)
    return collector.create_dataset(dataset_id=dataset_id, algorithm_name=algorithm)

