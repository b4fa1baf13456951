"""Random steps over random configurations: no NaN, no panic, no leak.

    python env/benches/endurance.py [STEPS] [SEED]

Each configuration draws a preset or a task, its drive, its ground, soils and effects well beyond the believable, sensors, number of rovers and threads,
and is driven with random actions, episodes starting anew as they end. Ten million environment steps by default; one line a million tells
the memory of the process, which has to stay where it is.
"""

import resource
import sys
import time
from typing import Any

import numpy as np
from numpy.random import Generator

import bekker

TERRAINS: tuple[dict[str, Any], ...] = (
    {"preset": "flat"},
    {"preset": "slope"},
    {"preset": "waves"},
    {"preset": "ditch"},
    {"preset": "step"},
    {"preset": "random"},
)
KINDS = ("torque", "speed", "speed_loop")
# Of the distance between a parameter and its bounds.
SHARE = 0.05
# Environment steps of a configuration.
EACH = 10_000


def configuration(random: Generator) -> dict[str, Any]:
    """Arguments of a vector environment."""
    arguments: dict[str, Any] = {"measured": bool(random.random() < 0.3), "raw": bool(random.random() < 0.3)}
    if random.random() < 0.4:
        arguments["task"] = str(random.choice(list(bekker.TASKS)))
    else:
        arguments["model"] = str(random.choice([name for name in bekker.presets() if "challenging" not in name]))
        arguments["terrain"] = TERRAINS[random.integers(len(TERRAINS))]
    if random.random() < 0.5:
        arguments["control"] = str(random.choice(KINDS))
    trial = bekker.RoverEnv(**arguments)
    listed = [*trial.setup.model.parameters(), *(trial.setup.model.sensors() if arguments["measured"] else [])]
    free = [v for v in listed if not v["name"].endswith("period") and "wheel[" not in v["name"] and v["name"] != "gravity"]
    chosen = random.choice(len(free), size=8, replace=False)
    arguments["randomise"] = {
        v["name"]: tuple(v["value"] + SHARE * (end - v["value"]) * float(random.random()) for end in (v["min"], v["max"]))
        for v in (free[k] for k in chosen)
    }
    arguments["action_scale"] = trial.setup.action_scale * float(random.uniform(0.5, 3.0))
    return arguments


def endure(steps: int, seed: int) -> int:
    """Makes at least so many environment steps in one configuration; how many it made, fewer where no start could be found."""
    random = np.random.default_rng(seed)
    arguments = configuration(random)
    count = int(2.0 ** random.uniform(0.0, 7.0))
    env = bekker.RoverVectorEnv(
        count,
        max_episode_steps=200,
        autoreset_mode=str(random.choice(["NextStep", "SameStep"])),
        threads=int(random.integers(1, 3)),
        **arguments,
    )
    env.action_space.seed(seed)
    made = 0
    try:
        observations, _ = env.reset(seed=seed)
        while made < steps:
            observations, rewards, *_, infos = env.step(env.action_space.sample())
            made += count
            assert env.observation_space.contains(observations), (arguments, observations)
            assert np.isfinite(rewards).all(), (arguments, rewards)
            assert np.isfinite(env.mechanics.signals).all(), arguments
    except bekker.SimulationError as refused:
        # Some draws leave no rest to start from: soils that carry nothing.
        if "internal error" in str(refused):
            raise
    except bekker.ModelError as refused:
        # Two numbers that are good alone and not together.
        print(f"seed {seed}: {refused}", file=sys.stderr)
    return made


def main() -> None:
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    made, short, told, start = 0, 0, 0, time.monotonic()
    while made < steps:
        now = endure(EACH, seed)
        made, short, seed = made + now, short + (now < EACH), seed + 1
        if made // 1_000_000 > told:
            told = made // 1_000_000
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            seconds = time.monotonic() - start
            print(f"{made:>9} steps, seed {seed}, {short} without a start, {seconds:.0f} s, at most {memory:.0f} MB", flush=True)


if __name__ == "__main__":
    main()
