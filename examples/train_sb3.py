"""Trains PPO and SAC on every task over some seeds and writes the learning curves and the policies.

    pip install stable-baselines3 matplotlib && python examples/train_sb3.py --out runs --minutes 2

Each training has a budget of processor time on one thread; the curves are over environment steps. Progress is
appended to ``curves.csv``: task, algorithm, seed, steps, seconds of training, mean return, standard deviation and success over 20 episodes
whose seeds no training has seen. ``train_figure.py`` draws it.
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.utils import ConstantSchedule

import bekker
from bekker.adapters.sb3 import RoverVecEnv

TASKS = ("SpeedHold", "SlopeClimb", "DitchCrossing", "EnergyTraverse", "SlipLimited")
EVALUATION_SEEDS = range(10_000, 10_020)
GAMMA = 0.98
RATE = 1e-3
"""Learning rate at the start, chosen as the rest of the settings here on former versions of the tasks; it falls to nothing, linearly with the training time spent: with one that stays, policies that
have come to hold a speed well get worse again. So the same seed gives another policy on a faster or slower machine."""
ENTROPY = {"EnergyTraverse": "auto_0.01"}
"""First weight of SAC's entropy, which it then learns; "auto", the library's 1, elsewhere. On the former version of that task, where a step
is worth some hundredths, with 1 nothing but noise was learned in the time given; with 0.01 the former SlipLimited, where the way out of
creeping has to be found, was not learned, and two other tasks less well."""
PERIOD = 0.1
"""Control period, s, five times the task's own: noise at 50 Hz moves a wheel in sand hardly at all, so that nothing is found
out by it; at 10 Hz an episode is also five times shorter. Rewards are counted by time and distance, so returns compare."""


def rovers(task: str, count: int) -> RoverVecEnv:
    """Environments of a task at the period of the training."""
    steps = round(bekker.TASKS[task].seconds / PERIOD)
    return RoverVecEnv(f"bekker/{task}-v0", count, period=PERIOD, max_episode_steps=steps)


def made(algorithm: str, task: str, seed: int) -> BaseAlgorithm:
    """An untrained agent."""
    small = {"net_arch": [64, 64]}
    if algorithm == "PPO":
        env = rovers(task, 32)
        return PPO("MlpPolicy", env, n_steps=64, batch_size=512, n_epochs=10, learning_rate=RATE, gamma=GAMMA,
                   gae_lambda=0.95, ent_coef=0.0, policy_kwargs=small | {"log_std_init": -0.8}, seed=seed, device="cpu")
    env = rovers(task, 8)
    return SAC("MlpPolicy", env, train_freq=8, gradient_steps=8, learning_starts=2000, batch_size=256, gamma=GAMMA,
               learning_rate=RATE, ent_coef=ENTROPY.get(task, "auto"), policy_kwargs=small, seed=seed, device="cpu")


class Curve(BaseCallback):
    """Evaluates some times on the way, lets the learning rate fall, and ends when the time is over."""

    def __init__(self, task: str, algorithm: str, seed: int, seconds: float, points: int, table: Path) -> None:
        super().__init__()
        self.env = rovers(task, len(EVALUATION_SEEDS))
        self.row = [task, algorithm, seed]
        self.seconds, self.points, self.table = seconds, points, table
        # Only training counts, not evaluation.
        self.spent, self.last, self.done = 0.0, time.process_time(), 0

    def _on_step(self) -> bool:
        now = time.process_time()
        self.spent += now - self.last
        self.last = now
        if self.spent >= self.done * self.seconds / self.points:
            self.evaluate()
            self.done += 1
            self.last = time.process_time()
        return self.spent < self.seconds

    def _on_rollout_end(self) -> None:
        # The length of a training is known in seconds, not in steps, by which the library's own schedules go.
        self.model.lr_schedule = ConstantSchedule(RATE * max(1.0 - self.spent / self.seconds, 0.0))

    def evaluate(self) -> None:
        """One episode a seed, all of them side by side: environment k has the seed of the first plus k."""
        self.env.seed(EVALUATION_SEEDS[0])
        observations = self.env.reset()
        returns, success = np.full(self.env.num_envs, np.nan), np.zeros(self.env.num_envs)
        while np.isnan(returns).any():
            actions, _ = self.model.predict(observations, deterministic=True)
            observations, _, done, infos = self.env.step(actions)
            for k in np.flatnonzero(done & np.isnan(returns)):
                returns[k], success[k] = infos[k]["episode"]["r"], infos[k]["success"]
        numbers = [self.num_timesteps, self.spent, returns.mean(), returns.std(), success.mean()]
        with self.table.open("a", newline="") as file:
            csv.writer(file).writerow([*self.row, *(f"{number:.6g}" for number in numbers)])
        print(*self.row, *(f"{number:.4g}" for number in numbers), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("runs"))
    parser.add_argument("--minutes", type=float, default=2.0, help="training time of each agent")
    parser.add_argument("--points", type=int, default=8, help="evaluations on the way")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--tasks", nargs="+", default=TASKS, choices=TASKS)
    parser.add_argument("--algorithms", nargs="+", default=["PPO", "SAC"], choices=["PPO", "SAC"])
    given = parser.parse_args()
    torch.set_num_threads(1)
    given.out.mkdir(parents=True, exist_ok=True)
    table = given.out / "curves.csv"
    if not table.exists():
        table.write_text("task,algorithm,seed,steps,seconds,return,deviation,success\n")
    for algorithm in given.algorithms:
        for seed in given.seeds:
            for task in given.tasks:
                agent = made(algorithm, task, seed)
                curve = Curve(task, algorithm, seed, 60.0 * given.minutes, given.points, table)
                agent.learn(total_timesteps=10**9, callback=curve)
                curve.evaluate()
                agent.save(given.out / f"{task}_{algorithm}_{seed}")


if __name__ == "__main__":
    main()
