"""Every task with every baseline and the trained policies, over the same seeds, in one table.

    python examples/train_table.py --runs runs --episodes 20 > table.md

Soils and grounds of the seeds have not been seen in training (`train_sb3.py`). The interval is a bootstrap over episodes of
one policy; a trained entry pools the policies of its seeds. Trained policies act at the period of the training, controllers
at the task's own, for which they are made; rewards are counted by time and distance, so returns compare. Controllers that
command torques do so in tasks whose actions are wheel speeds too: the task is made with `control="torque"` for them, with
actions up to a wheel's load times its radius, all else the same. (Tasks that have torques as actions allow half of that.)
"""

import argparse
from pathlib import Path

import gymnasium
import numpy as np
import task_sweep
from train_sb3 import EVALUATION_SEEDS, PERIOD, TASKS

import bekker
from bekker.baselines import Constant, Evaluation, Policy, constant, evaluate, rtc, rtc_speed, slip_control, trained, velocity

BASELINES = {
    "standing still": lambda env: constant(env, 0.0),
    "best constant action": lambda env: best_constant(env),
    "velocity control": velocity,
    "RTC": rtc,
    "RTC with wheel-speed loops": rtc_speed,
    "slip control": slip_control,
}
BY_TORQUES = ("RTC", "RTC with wheel-speed loops", "slip control")
"""Those that have no other way to drive."""


def best_constant(env: gymnasium.Env) -> Policy:
    """That of the sweep (`task_sweep.py`) with the most successes."""
    name = env.unwrapped.setup.task.name
    best = task_sweep.best_constant([row for row in task_sweep.read() if row["task"] == name])
    return Constant(np.array(best["action"].split(), np.float32))


def pooled(env: gymnasium.Env, policies: list[Policy], episodes: int) -> Evaluation:
    """All episodes of all policies."""
    results = [evaluate(env, policy, EVALUATION_SEEDS[:episodes]) for policy in policies]
    joined = {name: np.concatenate([getattr(r, name) for r in results]) for name in ("returns", "success", "energy", "distance", "steps")}
    return Evaluation(**joined, status=sum((r.status for r in results), []))


def torque_driven(task: str) -> gymnasium.Env:
    """The task with torques as actions, twice the usual ones, with which a wheel does not come over a bump."""
    usual = bekker.RoverEnv(task=task, control="torque").setup.action_scale
    return gymnasium.make(f"bekker/{task}-v0", control="torque", action_scale=2.0 * usual, disable_env_checker=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=Path, default=Path("runs"), help="folder of the trained policies")
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--tasks", nargs="+", default=TASKS, choices=TASKS)
    given = parser.parse_args()
    print("| task | policy | mean return | 95 % | success | distance, m | energy, J |\n|---|---|---|---|---|---|---|")
    for task in given.tasks:
        env = gymnasium.make(f"bekker/{task}-v0", disable_env_checker=True)
        for name, make in BASELINES.items():
            if name in BY_TORQUES and env.unwrapped.setup.model.control != "torque":
                other = torque_driven(task)
                row(task, f"{name}, by torques", pooled(other, [make(other)], given.episodes))
                other.close()
            else:
                row(task, name, pooled(env, [make(env)], given.episodes))
        steps = round(bekker.TASKS[task].seconds / PERIOD)
        env = gymnasium.make(f"bekker/{task}-v0", period=PERIOD, max_episode_steps=steps, disable_env_checker=True)
        for algorithm in ("PPO", "SAC"):
            files = sorted(given.runs.glob(f"{task}_{algorithm}_*.zip"))
            if files:
                found = pooled(env, [trained(file, algorithm) for file in files], given.episodes)
                row(task, f"{algorithm}, {len(files)} seeds", found)


def row(task: str, name: str, result: Evaluation) -> None:
    low, high = result.interval
    numbers = f"{result.returns.mean():.2f} | {low:.2f} .. {high:.2f} | {100 * result.success.mean():.0f} %"
    print(f"| {task} | {name} | {numbers} | {result.distance.mean():.2f} | {result.energy.mean():.1f} |", flush=True)


if __name__ == "__main__":
    main()
