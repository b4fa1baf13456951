"""Environment steps a second through `gymnasium.make`, beside gymnasium's CartPole in the same run.

    python env/benches/step_rate.py

A step of `bekker/Rover-v0` is 20 ms, ten inner steps of 2 ms. The rows below it take the layers off one by one: the
environment without gymnasium's wrappers, many environments in one vector (a row tells the time of one of them), the bare run, and the run asked for no inner step at all, which is what the
border between Python and Rust costs. All times are of one core, the best of several rounds.
"""

import time
from collections.abc import Callable

import gymnasium
import numpy as np

import bekker

ROUNDS = 5
SECONDS = 1.0  # all rounds, about
EPISODE = 500


def best(act: Callable[[], object]) -> float:
    """Seconds a call."""
    count, taken = 1, 0.0
    while taken < SECONDS / ROUNDS:
        count *= 2
        taken = timed(act, count)
    return min(timed(act, count) for _ in range(ROUNDS)) / count


def timed(act: Callable[[], object], count: int) -> float:
    start = time.perf_counter()
    for _ in range(count):
        act()
    return time.perf_counter() - start


def stepping(env: gymnasium.Env, actions: list[object]) -> Callable[[], None]:
    """Steps with the actions in turn; episodes of at most EPISODE steps, so that all drive over the same ground."""
    env.reset(seed=0)
    turn = 0

    def act() -> None:
        nonlocal turn
        turn += 1
        _, _, terminated, truncated, _ = env.step(actions[turn % len(actions)])
        if terminated or truncated or turn % EPISODE == 0:
            env.reset()

    return act


def vector_stepping(env: gymnasium.vector.VectorEnv) -> Callable[[], None]:
    """The same for a vector; its episodes start anew by themselves."""
    env.reset(seed=0)
    actions = np.random.default_rng(0).uniform(0.1, 0.3, (64, *env.action_space.shape)).astype(np.float32)
    turn = 0

    def act() -> None:
        nonlocal turn
        turn += 1
        env.step(actions[turn % len(actions)])

    return act


def gentle(env: gymnasium.Env) -> list[object]:
    """Actions that drive: about a fifth of what the soil carries, more or less."""
    random = np.random.default_rng(0)
    return [random.uniform(0.1, 0.3, env.action_space.shape).astype(np.float32) for _ in range(64)]


def show(name: str, seconds: float) -> None:
    print(f"{name:<58}{seconds * 1e6:>9.2f} us{1.0 / seconds:>12.0f} /s")


def main() -> None:
    print(f"{'':<58}{'a step':>12}{'steps':>15}")
    cart = gymnasium.make("CartPole-v1")
    show("CartPole-v1, gymnasium.make", best(stepping(cart, [0, 1])))
    show("CartPole-v1, without wrappers", best(stepping(cart.unwrapped, [0, 1])))
    for preset in ("two_wheeled", "gentle_velocity", "gentle_rtc", "rocker_bogie"):
        env = gymnasium.make("bekker/Rover-v0", model=preset)
        show(f"Rover-v0 {preset}, gymnasium.make", best(stepping(env, gentle(env))))
        show(f"Rover-v0 {preset}, without wrappers", best(stepping(env.unwrapped, gentle(env))))
    for count, threads in ((1, 1), (16, 1), (256, 1), (256, 2), (1024, 1), (1024, 2)):
        many = gymnasium.make_vec("bekker/Rover-v0", num_envs=count, threads=threads, copy=False)
        show(f"Rover-v0 two_wheeled, make_vec of {count}, {threads} threads", best(vector_stepping(many)) / count)
    run = bekker.Model.from_preset("two_wheeled").start()
    inputs, out = np.full(2, 0.5), run.signals()
    run.step(inputs, 500)
    show("Run.step of two_wheeled, 10 inner steps", best(lambda: run.step(inputs, 10, out)))
    show("Run.step of two_wheeled, no inner step (the border)", best(lambda: run.step(inputs, 0, out)))
    arrays = np.full((1, 2), 0.5), out[np.newaxis].copy(), np.zeros(1, np.uint8)
    batch = bekker.Batch([run], *arrays)
    show("Batch.step of one two_wheeled, no inner step (the border)", best(lambda: batch.step(0)))


if __name__ == "__main__":
    main()
