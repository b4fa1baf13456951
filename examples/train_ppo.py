"""PPO in one file, after the style of CleanRL: everything that the algorithm does stands here (Schulman et al. 2017).

    pip install torch && python examples/train_ppo.py --task SlopeClimb --steps 100000
    python examples/train_ppo.py --task SlipLimited --cost slip --budget 5

With `--cost` an episode may have `--budget` steps beyond a limit of safety (`bekker.costs`) on average: a price of the cost is taken from the
reward and moves with what the last episodes exceed (reward-constrained policy optimisation, Tessler et al. 2018).
"""

import argparse
import time

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from torch import nn
from torch.distributions import Normal

import bekker

PERIOD = 0.1  # s, see train_sb3.py


def network(inputs: int, outputs: int, last: float) -> nn.Sequential:
    """Two hidden layers, orthogonal weights; `last` scales those of the last layer."""
    layers: list[nn.Module] = []
    for a, b, gain in ((inputs, 64, 2**0.5), (64, 64, 2**0.5), (64, outputs, last)):
        layer = nn.Linear(a, b)
        nn.init.orthogonal_(layer.weight, gain)
        nn.init.zeros_(layer.bias)
        layers += [layer, nn.Tanh()]
    return nn.Sequential(*layers[:-1])


def costs_of(infos: dict, over: np.ndarray) -> np.ndarray:
    """Costs of the last step; of an episode that has ended they stand with its end, since the next one has begun."""
    cost = infos["cost"].copy()
    if over.any():
        cost[over] = infos["final_info"]["cost"][over]
    return cost


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="SlopeClimb", choices=sorted(bekker.TASKS))
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--envs", type=int, default=32)
    parser.add_argument("--length", type=int, default=64, help="steps of each environment between two updates")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cost", choices=sorted(bekker.costs.COSTS), help="a cost of safety that is kept within --budget")
    parser.add_argument("--budget", type=float, default=5.0, help="steps of an episode that may be beyond the limit, on average")
    given = parser.parse_args()
    gamma, trace, clip, epochs, parts, rate = 0.98, 0.95, 0.2, 10, 4, 1e-3
    # Reward for a step beyond the limit, its change for an episode that is twice the budget, and the most: a limit that a policy of
    # much noise cannot keep would else outgrow all rewards before that noise is less.
    price, price_rate, most = 0.0, 0.01, 0.5
    torch.manual_seed(given.seed)
    torch.set_num_threads(1)
    limit = round(bekker.TASKS[given.task].seconds / PERIOD)
    envs = gymnasium.make_vec(f"bekker/{given.task}-v0", given.envs, vectorization_mode="vector_entry_point",
                              autoreset_mode=AutoresetMode.SAME_STEP, period=PERIOD, max_episode_steps=limit,
                              costs=[given.cost] if given.cost else [])
    width, height = envs.single_observation_space.shape[0], envs.single_action_space.shape[0]
    actor, critic = network(width, height, 0.01), network(width, 1, 1.0)
    spread = nn.Parameter(torch.full((height,), -0.8))
    weights = [*actor.parameters(), *critic.parameters(), spread]
    optimiser = torch.optim.Adam(weights, lr=rate, eps=1e-5)

    def policy(observations: torch.Tensor) -> Normal:
        return Normal(actor(observations), spread.exp())

    shape = (given.length, given.envs)
    seen, done_actions = torch.zeros(*shape, width), torch.zeros(*shape, height)
    logs, rewards, values, ended = (torch.zeros(shape) for _ in range(4))
    now = torch.as_tensor(envs.reset(seed=given.seed)[0])
    totals, finished, began = np.zeros(given.envs), [], time.perf_counter()
    beyond, spent = np.zeros(given.envs), []
    for update in range(max(given.steps // (given.length * given.envs), 1)):
        for k in range(given.length):
            with torch.no_grad():
                chosen = policy(now)
                action = chosen.sample()
                seen[k], done_actions[k], values[k] = now, action, critic(now).squeeze(-1)
                logs[k] = chosen.log_prob(action).sum(-1)
            after, reward, terminated, truncated, infos = envs.step(action.clamp(-1.0, 1.0).numpy())
            over = terminated | truncated
            cost = costs_of(infos, over) if given.cost else np.zeros(given.envs)
            totals += reward
            beyond += cost
            finished += totals[over].tolist()
            spent += beyond[over].tolist()
            totals[over] = beyond[over] = 0.0
            rewards[k] = torch.as_tensor(reward - price * cost, dtype=torch.float32)
            # Time that is over is no end: what would have come is worth what the critic says of the last state.
            for index in np.flatnonzero(truncated & ~terminated):
                with torch.no_grad():
                    rewards[k, index] += gamma * critic(torch.as_tensor(infos["final_obs"][index])).item()
            ended[k] = torch.as_tensor(over, dtype=torch.float32)
            now = torch.as_tensor(after)
        with torch.no_grad():
            following, advantage, advantages = critic(now).squeeze(-1), torch.zeros(given.envs), torch.zeros(shape)
            for k in reversed(range(given.length)):
                goes_on = 1.0 - ended[k]
                surprise = rewards[k] + gamma * following * goes_on - values[k]
                advantage = surprise + gamma * trace * goes_on * advantage
                advantages[k], following = advantage, values[k]
            targets = advantages + values
        flat = [tensor.flatten(0, 1) for tensor in (seen, done_actions, logs, advantages, targets)]
        for _ in range(epochs):
            for part in torch.randperm(given.length * given.envs).chunk(parts):
                o, a, old, gain, target = (tensor[part] for tensor in flat)
                gain = (gain - gain.mean()) / (gain.std() + 1e-8)
                ratio = (policy(o).log_prob(a).sum(-1) - old).exp()
                surrogate = torch.minimum(ratio * gain, ratio.clamp(1.0 - clip, 1.0 + clip) * gain).mean()
                loss = 0.5 * (critic(o).squeeze(-1) - target).square().mean() - surrogate
                optimiser.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(weights, 0.5)
                optimiser.step()
        steps = (update + 1) * given.length * given.envs
        if finished:
            rate_now = steps / (time.perf_counter() - began)
            limits = ""
            if given.cost:
                now_spent = float(np.mean(spent[-50:]))
                price = min(max(price + price_rate * (now_spent - given.budget) / max(given.budget, 1.0), 0.0), most)
                limits = f", {now_spent:.1f} steps beyond the limit, at {price:.3f} each"
            print(f"{steps} steps, mean return of the last episodes {np.mean(finished[-50:]):.2f}{limits}, {rate_now:.0f} steps/s", flush=True)


if __name__ == "__main__":
    main()
