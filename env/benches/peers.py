"""Physics and environment steps a CPU second beside those of other simulators, in the same run.

    pip install mujoco highway-env            # what is not there is left out, and named
    python env/benches/peers.py

Physics: one step is 2 ms of a planar vehicle with two driven wheels. Bekker's rolls on soil, every contact the integral of
stresses over the rim, in a batch and alone; MuJoCo's planar car rolls on a rigid plane, through `mujoco.rollout`.
Environments: many together, as each package steps them. All on one thread, CPU time, the best of several rounds.
"""

import time
from collections.abc import Callable

import gymnasium
import numpy as np

import bekker

ROUNDS = 5
COUNT = 1024
INNER = 0.002
WARM = 100

CAR = f"""
<mujoco>
  <option timestep="{INNER}" gravity="0 0 -9.81"/>
  <worldbody>
    <geom type="plane" size="0 0 1" friction="0.8"/>
    <body pos="0 0 0.1">
      <joint type="slide" axis="1 0 0"/> <joint type="slide" axis="0 0 1"/> <joint type="hinge" axis="0 1 0"/>
      <geom type="box" size="0.15 0.1 0.03" pos="0 0 0.08" mass="8" contype="0" conaffinity="0"/>
      <body pos="-0.15 0 0"> <joint name="rear" type="hinge" axis="0 1 0"/>
        <geom type="cylinder" size="0.1 0.05" zaxis="0 1 0" mass="1" friction="0.8"/> </body>
      <body pos="0.15 0 0"> <joint name="front" type="hinge" axis="0 1 0"/>
        <geom type="cylinder" size="0.1 0.05" zaxis="0 1 0" mass="1" friction="0.8"/> </body>
    </body>
  </worldbody>
  <actuator> <motor joint="rear"/> <motor joint="front"/> </actuator>
</mujoco>
"""


def best(act: Callable[[], object]) -> float:
    """CPU seconds of a call."""

    def once() -> float:
        start = time.process_time()
        act()
        return time.process_time() - start

    return min(once() for _ in range(ROUNDS))


def tell(name: str, steps: float, seconds: float, unit: str) -> None:
    print(f"{name:64} {steps / seconds:>12,.0f} {unit} a CPU second")


def batch() -> tuple[float, float]:
    """Inner steps and CPU seconds of many rovers at torques that hold them going."""
    env = gymnasium.make_vec("bekker/Rover-v0", num_envs=COUNT, max_episode_steps=None)
    env.reset(seed=0)
    actions = np.full((COUNT, *env.single_action_space.shape), 0.2, np.float32)
    inner = round(env.unwrapped.setup.period / INNER)
    for _ in range(10):
        env.step(actions)
    seconds = best(lambda: [env.step(actions) for _ in range(10)])
    return 10.0 * inner * COUNT, seconds


def alone() -> tuple[float, float]:
    run = bekker.Model.from_preset("two_wheeled").start()
    inputs, out = np.full(2, 0.5), run.signals()
    run.step(inputs, WARM, out)
    return 2000.0, best(lambda: run.step(inputs, 2000, out))


def mujoco_car() -> tuple[float, float]:
    import mujoco
    from mujoco import rollout

    model = mujoco.MjModel.from_xml_string(CAR)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, WARM)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.empty(mujoco.mj_stateSize(model, full))
    mujoco.mj_getState(model, data, state, full)
    states, steps = np.tile(state, (COUNT, 1)), 100
    torques = np.full((COUNT, steps, model.nu), 0.2)
    seconds = best(lambda: rollout.rollout(model, data, initial_state=states, control=torques))
    return float(COUNT * steps), seconds


def vector(name: str, count: int, steps: int) -> tuple[float, float]:
    env = gymnasium.make_vec(name, num_envs=count, vectorization_mode="vector_entry_point")
    env.reset(seed=0)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(steps)]
    return float(count * steps), best(lambda: [env.step(action) for action in actions])


def highway() -> tuple[float, float]:
    import highway_env  # noqa: F401  registers its environments

    env = gymnasium.make("highway-fast-v0")

    def drive() -> None:
        env.reset(seed=0)
        for _ in range(20):
            _, _, terminated, truncated, _ = env.step(env.unwrapped.action_type.actions_indexes["IDLE"])
            if terminated or truncated:
                env.reset()

    return 20.0, best(drive)


def envpool() -> tuple[float, float]:
    import envpool

    env = envpool.make("HalfCheetah-v4", env_type="gymnasium", num_envs=64, num_threads=1)
    env.reset()
    actions = np.zeros((64, *env.action_space.shape))
    return 64.0 * 100, best(lambda: [env.step(actions) for _ in range(100)])


def main() -> None:
    rows: list[tuple[str, str, Callable[[], tuple[float, float]]]] = [
        (f"Bekker, two wheels on soil, vector environment of {COUNT}", "physics steps", batch),
        ("Bekker, two wheels on soil, one run", "physics steps", alone),
        (f"MuJoCo, planar car on a rigid plane, rollout of {COUNT}", "physics steps", mujoco_car),
        (f"bekker/Rover-v0, vector of {COUNT}", "environment steps", lambda: vector("bekker/Rover-v0", COUNT, 10)),
        (f"gymnasium's CartPole-v1, native vector of {COUNT}", "environment steps", lambda: vector("CartPole-v1", COUNT, 50)),
        ("highway-env's highway-fast-v0", "environment steps", highway),
        ("EnvPool's HalfCheetah-v4, 64 together", "environment steps", envpool),
    ]
    for name, unit, measure in rows:
        try:
            steps, seconds = measure()
        except ImportError as missing:
            print(f"{name:64} left out: {missing}")
            continue
        tell(name, steps, seconds, unit)


if __name__ == "__main__":
    main()
