"""PPO by Ray RLlib, for those who outgrow one machine: here with two workers on this one; on a cluster, more.

    pip install "ray[rllib]" torch && python examples/train_rllib.py --task SlopeClimb --iterations 20
"""

import argparse

import ray
from ray.rllib.algorithms.ppo import PPOConfig

import bekker

PERIOD = 0.1  # s, see train_sb3.py


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="SlopeClimb", choices=sorted(bekker.TASKS))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--iterations", type=int, default=20)
    given = parser.parse_args()
    ray.init(num_cpus=given.workers + 1, include_dashboard=False)
    arguments = {"period": PERIOD, "max_episode_steps": round(bekker.TASKS[given.task].seconds / PERIOD)}
    config = (
        PPOConfig()
        # The package before the id has every worker import it, which registers the tasks there.
        .environment(f"bekker:bekker/{given.task}-v0", env_config=arguments)
        # Rovers of one worker are stepped together in the core.
        .env_runners(num_env_runners=given.workers, num_envs_per_env_runner=16, gym_env_vectorize_mode="vector_entry_point")
        .training(train_batch_size=4096, minibatch_size=512, num_epochs=10, lr=1e-3, gamma=0.98)
    )
    algorithm = config.build_algo()
    for _ in range(given.iterations):
        result = algorithm.train()
        runners = result["env_runners"]
        print(result["num_env_steps_sampled_lifetime"], runners.get("episode_return_mean"), flush=True)
    algorithm.stop()
    ray.shutdown()


if __name__ == "__main__":
    main()
