"""Writes `environment.md`, the page of the environments: prose from here and from the tasks, tables from the vocabulary.

    python examples/environment.py            # writes the page
    python examples/environment.py --check    # says whether it is up to date
"""

import sys
from pathlib import Path

import bekker
from bekker.arguments import Arguments
from bekker.randomise import Choice, Distribution, LogUniform, Normal, Uniform
from bekker.scales import AHEAD, EXTRAS
from bekker.tasks import ANY_SEED, PERIOD

PAGE = Path(__file__).with_suffix(".md")

HEAD = """# Environments

Environments in which a rover drives over deformable soil. The stresses under each wheel determine its sinkage, slip and
drawbar pull. `bekker.simulate`, the FMU and the Rust core compute the same physics to the same bits.
`python examples/environment.py` writes this page.

```python
import gymnasium, bekker                                     # registers the tasks; or gymnasium.make("bekker:bekker/...")
env = gymnasium.make("bekker/SlopeClimb-v0", level=0.5)
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())

many = gymnasium.make_vec("bekker/SlopeClimb-v0", num_envs=256, threads=2, autoreset_mode="SameStep")
observations, infos = many.reset(seed=0)                     # environment i has the seed 0 + i
```

Gymnasium 1 does not search other packages for environments. Without `import bekker`, put the name of the package before the id:
`gymnasium.make("bekker:bekker/SlopeClimb-v0")`.

## What all tasks share

**Action space.** `Box(-1, 1)`, one entry per wheel, from rear to front. Where the model contains a controller
(`control="velocity"`, `"rtc"`, `"slip"` ...), there is one entry, the velocity command of that controller. An action of 1
commands `setup.action_scale` (N m, rad/s or m/s).

**Observation space.** `Box(-1, 1)`, float32: each signal is divided by its scale and clipped. With `raw=True` the values are in
SI units and are clipped at ten scales. With `measured=True` they are sensor readings (`sensor.*`: noise, bias, resolution,
period) instead of true signals. `observe` selects other signals, also {extras}.

**The ground ahead.** By default an observation contains nothing of the ground ahead of the wheels. `ahead=bekker.Ahead(distances, noise, dropout)`
adds an elevation map with a cell at each distance (m) along x from the body's reference point. `observe` selects `height_ahead` (the ground, or an
obstacle on it, above the ground at the rover, with noise that is drawn in each step), `soil_ahead` (shear strength of the soil over that
of the model's soil, at the mean ground pressure of the wheels: the loose sand of a ditch has less) and `seen_ahead`. A cell is missing with the
probability `dropout`; height and strength then read 0, as level ground does, and `seen_ahead` is 0 instead of 1. A height of one is half of the
farthest distance (`observation_scales` changes it); higher obstacles are clipped. The map is looked up at the recorded `x`, and effects on the soil
are not on it. For a teacher that sees more than its student, observe all and give the student some of the columns.
`gymnasium.wrappers.FrameStackObservation` stacks the last observations of a single environment.

```python
ahead = bekker.Ahead([0.2, 0.4, 0.6, 0.8, 1.0], noise=0.01, dropout=0.05)
env = gymnasium.make("bekker/DitchCrossing-v0", observe=[*bekker.scales.OBSERVED, "height_ahead", "seen_ahead", "soil_ahead"], ahead=ahead)
```

**Drives.** A motor gives no more than its supply voltage and its current limit allow: the presets have 24 V, the tasks set the limit
of the current (`motor.inverse_voltage`, `motor.inverse_current_limit`). The no-load speed is 10.3 rad/s, which is within the scales of
wheel speed and velocity. Joints have stops (`link[k].stop`, 45 degrees in the presets).

**Rewards.** The reward is a weighted sum of terms. `info` lists each term, multiplied by its weight, as `reward_<term>`.
`rewards` selects terms by name or takes `bekker.rewards.Term` objects that you define. `reward_weights` changes weights.

{terms}

**Costs of safety.** `costs=True`, a list of names or `costs={{"slip": 0.4, "tilt": 0.2}}` with limits adds what a drive should avoid to `info`, apart from the
reward: `cost_<name>` is one for a step beyond the limit, else zero, as in Safety-Gymnasium, and `cost` is the sum of them.
`bekker.costs.CostInStep(env)` returns it from `step`, behind the reward. You can also define `bekker.costs.Cost` objects.

{costs}

**Starting state.** The rover is at rest, settled on the soil. `info["drawn"]` has the values that the reset has drawn. Where the
rover finds no rest with them (the soil does not carry it), the reset draws again, up to ten draws in all.

**Episode end.** An episode is *terminated* by an event, which `info["status"]` names (`stuck`, `tipped_over`, `belly_contact`,
`left_terrain`, `sunk_to_axle`, or `failed` where the equations have no finite solution), or by coming to the goal (`goal`),
whether or not this is a success. Only the time limit *truncates* it: gymnasium's `max_episode_steps`, which `make` and `make_vec`
set to the time limit of the task.

**Info.** The keys are always the same: `time` (s), `x` and `distance` since the start (m), `status`, `success`,
`electrical_energy` (J), `slip` and `sinkage` (m), each with one entry per wheel, `target_velocity` (m/s), `reward_<term>`, `drawn`, and the
costs that are asked for.

**Randomisation.** `randomise={{"soil.k_phi": {{"log_uniform": [4e5, 2e6]}}, "rover.mass": (8, 12), "sensor.pitch_bias":
{{"normal": [0, 0.01, -0.03, 0.03]}}, "slip_sinkage.n1": {{"choice": [0, 0.4]}}}}` draws new values at every reset. Any parameter of the
vocabulary can be drawn by its name, and so can `terrain.seed`, the seed of random ground. In the constructor, `randomise` replaces
the draws of the task; in `reset(options=...)` it adds to them.

**Worlds.** `worlds="train"` draws a soil and perhaps a hidden effect together, from one of the splits on which policies are trained, validated
and judged: [adaptation.md](adaptation.md).

**Curriculum.** `level`, from 0 to 1, is an argument of the constructor, an attribute (`env.unwrapped.level = 0.3`, which holds from the
next reset on) and an option of `reset`. It sets the ground as the chapter of each task states, and it narrows the random draws: at
level 0 each draw gives the parameter's own value.

**Seeds.** `reset(seed=s)` determines all draws and the noise of the sensors. Environment i of a vector environment that is reset
with seed s gives the same bits as a single environment that is reset with seed s + i, for any number of environments and threads.

**Copies.** After `snapshot()` and `restore()`, `copy.deepcopy` or `pickle`, also in the middle of an episode, a single or vector
environment continues to the same bits. (An environment with the plant of rigid bodies can be copied but not pickled.) A vector
environment with several threads also works in a forked process: threads do not exist in the child process, so it starts new ones.

**Vector.** `make_vec` returns a `bekker.RoverVectorEnv`, which steps all rovers in the Rust core. Its options are `autoreset_mode`
(`NextStep`, `SameStep`, `Disabled`), `threads`, `copy=False` (each step overwrites the observations of the previous one) and
`reset(options={{"reset_mask": ...}})`.

**Arguments.**

{arguments}

**Free-threaded Python.** The wheel uses the stable ABI (abi3): one file serves CPython 3.10 and later, but builds without the
global interpreter lock cannot load it. For these, build from source with that Python, version 3.14 or later (PyO3 does not support
3.13). According to PyO3's sources, the build then drops abi3 by itself and gives a wheel for that version alone; this is not tested.
PyO3's borrow checks protect the state of the classes: where two threads step one environment at once, one gets an error, and
there is no data race.

**Pictures.** `render_mode="rgb_array"` draws the rover, the ground, its ruts and the forces without a display, in about 11 ms per
frame of 960 x 540 pixels. `"human"` shows the same picture in a window at every step (pygame or matplotlib). `"ansi"` gives a line of
numbers and the profile of the ground as text.

## Speed

Measured on one core of a two-core cloud machine whose own speed varies by a third from hour to hour. A step of `Rover-v0` is 20 ms
long: ten inner steps of 2 ms, each with all stages of the integrator (`python env/benches/step_rate.py`,
`python env/benches/peers.py`).

| `bekker/Rover-v0`, two wheels | Environment steps a second |
| --- | --- |
| `gymnasium.make` | 13,000 to 17,000 |
| `make_vec` of 16, one thread | 79,000 |
| `make_vec` of 256, one thread | 109,000 |
| `make_vec` of 256, two threads | 193,000 |
| `make_vec` of 1024, one thread | 102,000 to 135,000 |
| `make_vec` of 1024, two threads | 172,000 |

Compared with other simulators in one run, per CPU second:

- physics steps: 1,075,000 of rovers on soil in a vector of 1024, 278,000 of a single rover, and 199,000 of MuJoCo's planar car on
  a rigid plane through `mujoco.rollout`;
- environment steps with random actions and resets: 49,000 of these environments, 26,000 of EnvPool's HalfCheetah, 12.8 million of
  gymnasium's own vector environment of CartPoles, and 45 of highway-fast.

**What limits the speed.** An inner step of the two-wheeled rover evaluates the contact of each wheel twice, each time with 2 x 8
quadrature nodes. A node takes 111 additions and multiplications. A wheel takes 1,955 of them and 12 divisions and square roots; the
inner step takes 10,887 and 219 (three wheels of a rocker-bogie: 19,529 and 350, on random ground 34,966 and 357; counted by
`cargo test --lib operations -- --nocapture`). A core of this machine makes 51 G additions and multiplications per second in AVX-512
registers, or 3.2 G divisions. They are not fused into multiply-adds, since results have the same bits on every processor. So
at most 3.6 million inner steps per second are possible in this way, of which 25 to 27 % are reached (rocker-bogie 30 %, random ground
35 to 38 %; `cargo bench --bench batch`). The counts are for eight rovers in the same contact regime, where no contact has to be
evaluated again for another regime. One part of the remaining time is known: in a sampling profile, copies take about an eighth of the
time, most of them of matrices of 4 to 5 kB. Random actions halve the speed, because they lead to resets and to rovers in different
regimes.
"""

TASK = """
## {id}

### Description

{purpose}

{physics}

### Action Space

`Box(-1, 1, ({actions},), float32)`; an action of 1 commands {scale:.4g} {unit} at each wheel (`control="{control}"`), held for {period:g} s.

{inputs}

### Observation Space

`Box(-1, 1, ({observations},), float32)`.

{signals}

### Rewards

{rewards}

### Starting State

{start}

### Episode End

{end} Truncated after {steps} steps, {seconds:g} s.

Success (`info["success"]`): {success}

### Arguments

The arguments of all tasks. Defaults of this task: model `{model}`{terrain}.

{parameters}

### Version History

- v0: first version.
"""


def table(head: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(str(cell).replace("|", r"\|") for cell in line) + " |" for line in lines)


def number(value: float) -> str:
    return f"{value:.4g}"


def words(scatter: Distribution) -> str:
    if scatter == ANY_SEED:
        return "any"
    match scatter:
        case Uniform(low, high):
            return f"uniform {number(low)} to {number(high)}"
        case LogUniform(low, high):
            return f"log-uniform {number(low)} to {number(high)}"
        case Normal(mean, deviation, low, high):
            return f"normal {number(mean)}, deviation {number(deviation)}, within {number(low)} to {number(high)}"
        case Choice(values):
            return "one of " + ", ".join(map(number, values))
    raise TypeError(scatter)


def chapter(task: bekker.Task) -> str:
    env = bekker.RoverEnv(task=task.name)
    model, setup, observer = env.setup.model, env.setup, env.setup.observer
    about = {v["name"]: v for v in [*model.parameters(), *model.inputs(), *model.signals(), *model.sensors()]}
    inputs = [v["name"] for v in model.inputs()]
    extra = {
        "target_velocity": ("m/s", "Speed that the task asks for."),
        "goal_distance": ("1", "Way left to the goal, as a share."),
        "time_left": ("1", "Time left of that which the way takes at the speed asked for, as a share."),
    }
    ahead = {
        "height_ahead": ("m", "Height of the ground at {distance} along x from the body's reference point, above the ground at that point."),
        "seen_ahead": ("1", "1 where the cell at {distance} is there, 0 where it is missing."),
    }
    entries = []
    for k, (name, scale) in enumerate(zip(observer.names, observer.scales, strict=True)):
        kind = name.partition("[")[0]
        if kind in AHEAD:
            distance = setup.ahead.distances[int(name[len(kind) + 1 : -1]) - 1]
            unit, doc = ahead[kind][0], ahead[kind][1].format(distance=f"{distance:g} m")
        else:
            unit, doc = extra[name] if name in extra else (about[name]["unit"], about[name]["doc"])
        entries.append((k, f"`{name}`", doc, -1, 1, number(scale), unit))
    draws = [(f"`{name}`", words(d), unit_of(name, about)) for name, d in setup.randomise.items()]
    grades = [(f"`{name}`", *map(number, ends), unit_of(name, about)) for name, ends in setup.grades.items()]
    start = "At rest, settled on the soil" + (". Drawn at level 1:\n\n" if draws else ". Nothing is drawn.")
    start += table(("Parameter", "Drawn", "Unit"), draws) if draws else ""
    if grades:
        start += "\n\nSet by the level (linear between 0 and 1) before the draws:\n\n" + table(("Parameter", "Level 0", "Level 1", "Unit"), grades)
    changed = [(f"`{n}`", number(v), unit_of(n, about), about[n]["doc"]) for n, v in {**task.parameters, **task.drive}.items()]
    reached = " or by coming to the goal" if setup.goal.way() > 0.0 else ""
    return TASK.format(
        id=task.id,
        purpose=task.purpose,
        physics=task.physics,
        actions=len(inputs),
        scale=setup.action_scale,
        unit=about[inputs[0]]["unit"],
        control=model.control,
        period=PERIOD,
        inputs=table(("Num", "Action", "Meaning"), [(k, f"`{n}`", about[n]["doc"]) for k, n in enumerate(inputs)]),
        observations=len(entries),
        signals=table(("Num", "Observation", "Meaning", "Min", "Max", "One means", "Unit"), entries),
        rewards=table(("Term", "Weight", "What it is"), [(f"`{t.name}`", number(t.weight), t.doc) for t in setup.terms]),
        start=start,
        end=f"Terminated by an event{reached}.",
        steps=task.max_episode_steps,
        seconds=task.seconds,
        success=task.success,
        model=task.model,
        terrain="" if task.terrain is None else f", terrain `{task.terrain['preset']}`",
        parameters="" if not changed else table(("Parameter", "Value", "Unit", "Meaning"), changed),
    )


def unit_of(name: str, about: dict[str, bekker.vocabulary.Variable]) -> str:
    return about[name]["unit"] if name in about else {"target_velocity": "m/s", "terrain.seed": "1"}[name]


def arguments() -> str:
    """The arguments, each with the text below it in the source."""
    source = Path(bekker.arguments.__file__).read_text(encoding="utf-8")
    rows: list[tuple[object, ...]] = [
        ("`model`", "A `bekker.Model`, the name of a preset, TOML text, or the path of a TOML file."),
    ]
    for name in Arguments.__annotations__:
        _, after = source.split(f"\n    {name}: ", 1)
        rows.append((f"`{name}`", " ".join(after.split('"""')[1].replace("``", "`").split())))
    return table(("Argument", "Meaning"), rows)


def page() -> str:
    catalogue = [(f"`{t.name}`", number(t.weight), t.doc) for t in bekker.rewards.TERMS.values()]
    limits = [(f"`{c.name}`", number(c.limit), c.unit, c.doc) for c in bekker.costs.COSTS.values()]
    head = HEAD.format(
        extras=", ".join(f"`{name}`" for name in EXTRAS),
        terms=table(("Term", "Weight in `Rover-v0`", "What it is"), catalogue),
        costs=table(("Cost", "Usual limit", "Unit", "One for a step in which"), limits),
        arguments=arguments(),
    )
    text = head + "".join(chapter(task) for task in bekker.TASKS.values())
    while "\n\n\n" in text:
        text = text.replace("\n\n\n", "\n\n")
    return text


def main() -> int:
    text = page()
    if "--check" in sys.argv[1:]:
        current = PAGE.exists() and PAGE.read_text(encoding="utf-8") == text
        print("up to date" if current else f"{PAGE.name} is out of date: python examples/environment.py")
        return 0 if current else 1
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
