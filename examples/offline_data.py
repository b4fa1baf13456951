"""Offline data sets of the tasks (Minari), made again to the last bit by one command.

    pip install "minari[hdf5,create]"
    python examples/offline_data.py              # makes all sets in Minari's folder (MINARI_DATASETS_PATH), 100 episodes each
    python examples/offline_data.py --check      # the same in a folder that is thrown away, and compares with training/offline.csv

A set is one policy on one task with the seeds 30,000, 30,001, ..; no page of this project evaluates anything on these. The file lists a
SHA-256 of all observations, actions, rewards and ends of each set, and of its first two episodes; made on x86-64 Linux.
"""

import argparse
import csv
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import bekker
from bekker import baselines, learners

FIRST_SEED, EPISODES = 30_000, 100
ROWS = Path(__file__).with_name("training") / "offline.csv"


class Scattered:
    """The data sheet's plan times a factor of 0.8 to 1.4, drawn for each episode, so that the data hold early, late and timely arrivals."""

    def __init__(self, env: gymnasium.Env) -> None:
        # A learner is made for a world; this one does not use it.
        self._plan = learners.Nominal(env, bekker.worlds.SPLITS["train"].world(0))
        self._random, self._factor = np.random.default_rng(FIRST_SEED), 1.0

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None, deterministic: bool = False) -> Any:
        if episode_start is not None and np.any(episode_start):
            self._factor = self._random.uniform(0.8, 1.4)
        action, state = self._plan.predict(observation, state, episode_start, deterministic)
        return np.clip(self._factor * action, -1.0, 1.0).astype(np.float32), state


@dataclass(frozen=True)
class OfflineSet:
    """A policy on a task."""

    task: str
    policy: Callable[[gymnasium.Env], baselines.Policy]
    arguments: dict[str, Any]


SETS = {
    "bekker/speed-hold/velocity-v0": OfflineSet("SpeedHold", baselines.velocity, {}),
    "bekker/speed-hold/rtc-speed-v0": OfflineSet("SpeedHold", baselines.rtc_speed, {}),
    "bekker/slip-limited/velocity-v0": OfflineSet("SlipLimited", lambda env: baselines.velocity(env, 0.2), {}),
    "bekker/blind-slope/scattered-v0": OfflineSet("BlindSlope", Scattered, {"worlds": "train"}),
}


def make(name: str, episodes: int = EPISODES) -> Any:
    """Drives the episodes of a set and writes it."""
    from bekker.adapters.minari import collect

    what = SETS[name]
    env = gymnasium.make(f"bekker/{what.task}-v0", disable_env_checker=True, **what.arguments)
    return collect(env, what.policy(env), range(FIRST_SEED, FIRST_SEED + episodes), name)


def digest(dataset: Any, episodes: int = EPISODES) -> str:
    """SHA-256 over types, shapes and values of the first episodes."""
    found = hashlib.sha256()
    for episode in dataset.iterate_episodes(range(episodes)):
        for values in (episode.observations, episode.actions, episode.rewards, episode.terminations, episode.truncations):
            array = np.ascontiguousarray(values)
            found.update(f"{array.dtype.str} {array.shape}".encode())
            found.update(array.tobytes())
    return found.hexdigest()


def read() -> dict[str, dict[str, str]]:
    """The rows of the file by the set's name."""
    with ROWS.open(newline="") as file:
        return {row["set"]: row for row in csv.DictReader(file)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare with the file in place of keeping the sets")
    parser.add_argument("--sets", nargs="+", default=list(SETS), choices=SETS)
    given = parser.parse_args()
    if not given.check:
        for name in given.sets:
            made = make(name)
            print(name, digest(made), digest(made, 2), sep=",", flush=True)
        return 0
    wrong, known = 0, read()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["MINARI_DATASETS_PATH"] = folder
        for name in given.sets:
            same = digest(make(name)) == known[name]["sha256"]
            wrong += not same
            print(name, "the same bits" if same else "differs", flush=True)
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
