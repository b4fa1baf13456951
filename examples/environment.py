"""Writes `environment.md`, the page of the environments: prose from here and from the tasks, tables from the vocabulary.

    python examples/environment.py            # writes the page
    python examples/environment.py --check    # says whether it is up to date
"""

import sys
from pathlib import Path

import bekker
from bekker.arguments import Arguments
from bekker.randomise import Choice, Distribution, LogUniform, Normal, Uniform
from bekker.scales import EXTRAS
from bekker.tasks import ANY_SEED, PERIOD

PAGE = Path(__file__).with_suffix(".md")

HEAD = """# Environments

A rover drives over deformable soil, whose stresses under each wheel give its sinkage, slip and pull: the physics of
`bekker.simulate`, of the FMU and of the core, to the same bits. Written by `python examples/environment.py`.

```python
import gymnasium, bekker                                     # registers the tasks; or gymnasium.make("bekker:bekker/...")
env = gymnasium.make("bekker/SlopeClimb-v0", level=0.5)
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())

many = gymnasium.make_vec("bekker/SlopeClimb-v0", num_envs=256, threads=2, autoreset_mode="SameStep")
observations, infos = many.reset(seed=0)                     # environment i has the seed 0 + i
```

Gymnasium 1 looks for no entry points of other packages; without an import, put the package before the id:
`gymnasium.make("bekker:bekker/SlopeClimb-v0")`.

## What all tasks share

**Action space.** `Box(-1, 1)`, an entry a wheel, rear to front; one entry where a controller inside drives
(`control="velocity"`, `"rtc"`, `"slip"` ...), its velocity command. `setup.action_scale` is what one commands.

**Observation space.** `Box(-1, 1)`, float32: signals over their scales, clipped. `raw=True`: SI units, within ten scales.
`measured=True`: what sensors say (`sensor.*`: noise, bias, resolution, period) in place of the true signals.
`observe` chooses others of all signals, and {extras}.

**Rewards.** A sum of terms, which `info` lists as `reward_<term>`, weights included. `rewards` chooses terms by name or
takes `bekker.rewards.Term` objects of your own, `reward_weights` changes weights.

{terms}

**Starting state.** At rest, settled on the soil. What a reset draws is in `info["drawn"]`. A draw that leaves no rest (a soil
that does not carry the rover) is drawn again, up to ten times.

**Episode end.** *Terminated* by an event, in `info["status"]`: `stuck`, `tipped_over`, `belly_contact`, `left_terrain`,
`sunk_to_axle`, `failed` (the equations have no finite solution), or by `goal`. *Truncated* by time only: gymnasium's
`max_episode_steps`, which `make` and `make_vec` set to the task's time.

**Info.** Always the same keys: `time` (s), `x` and `distance` since the start (m), `status`, `success`, `electrical_energy` (J),
`slip` and `sinkage` (m; an entry a wheel), `target_velocity` (m/s), `reward_<term>`, `drawn`.

**Randomisation.** `randomise={{"soil.k_phi": {{"log_uniform": [4e5, 2e6]}}, "rover.mass": (8, 12), "sensor.pitch_bias":
{{"normal": [0, 0.01, -0.03, 0.03]}}, "slip_sinkage.n1": {{"choice": [0, 0.4]}}}}` draws every parameter of the vocabulary by its
name, and `terrain.seed` of random ground; in the constructor in place of the task's draws, in `reset(options=...)` besides them.

**Curriculum.** `level` from 0 to 1, an argument, an attribute (`env.unwrapped.level = 0.3`, from the next reset on) and an option of
`reset`. It grades the ground as each task says and shrinks the draws to the parameter's own value at 0.

**Seeds.** `reset(seed=s)` decides all draws and the noise of the sensors. Environment i of a vector that is reset with s does, bit for bit, what a
single one does with s + i, whatever the number of environments and threads.

**Copies.** `snapshot()` and `restore()` go on to the same bits; so do `copy.deepcopy` and `pickle`, single and vector, in the middle of an
episode. (The plant of rigid bodies can be copied, not pickled.) A forked process can go on with a vector of many threads: the threads
belong to the vector, which starts new ones in the new process.

**Vector.** `make_vec` gives a `bekker.RoverVectorEnv`, stepped in the core: `autoreset_mode` (`NextStep`, `SameStep`, `Disabled`),
`threads`, `copy=False` (observations are overwritten), `reset(options={{"reset_mask": ...}})`.

**Arguments.**

{arguments}

**Free-threaded Python.** The wheel is abi3, one for CPython 3.10 and later, which builds without the global lock do not
load. For them build from source with that Python, 3.14 or later (PyO3 does not support 3.13): by its sources PyO3 then leaves abi3 by
itself and makes a wheel for that version alone. This is not tested. The classes hold their
state behind PyO3's borrow checks, so that two threads that step one environment at once get an error, not a race.

**Pictures.** `render_mode="rgb_array"` draws the rover, the ground, its ruts and the forces without a display, some 11 ms a frame of
960 x 540; `"human"` shows the same in a window at every step (pygame or matplotlib); `"ansi"` is a line of numbers and a profile.

## Speed

On one core of a two-core cloud machine whose own speed varies by a third from hour to hour; a step of `Rover-v0` is 20 ms, ten inner
steps of 2 ms with all their stages (`python env/benches/step_rate.py`, `python env/benches/peers.py`):

| `bekker/Rover-v0`, two wheels | Environment steps a second |
| --- | --- |
| `gymnasium.make` | 13,000 to 17,000 |
| `make_vec` of 16, one thread | 79,000 |
| `make_vec` of 256, one thread | 109,000 |
| `make_vec` of 256, two threads | 193,000 |
| `make_vec` of 1024, one thread | 102,000 to 135,000 |
| `make_vec` of 1024, two threads | 172,000 |

In one run beside others, a CPU second: 1,075,000 physics steps on soil in a vector of 1024 (278,000 alone), 199,000 of MuJoCo's planar
car on a rigid plane through `mujoco.rollout`; 49,000 environment steps with random actions and resets, 26,000 of EnvPool's HalfCheetah,
12.8 million of gymnasium's own vector of CartPoles, 45 of highway-fast.

**What bounds it.** A step of two wheels evaluates each of them twice, at 2 x 8 nodes. A node takes 111 sums and products, a wheel 1,955 of them
and 12 quotients and roots, the step 10,843 and 203 (three wheels of a rocker-bogie 19,426 and 326, on random ground 34,862 and 333;
counted by `cargo test --lib operations -- --nocapture`). A core of this machine makes 51 G sums and products in AVX-512 registers a
second, or 3.2 G quotients, not fused, as the same bits on every processor ask. So no more than 3.6 million steps are possible in
this way, of which 25 to 27 % are reached (rocker-bogie 30, random ground 35 to 38; `cargo bench --bench batch`). The counts are of
eight rovers in one regime, where no contact is evaluated twice. Of the rest one part is known: a sampling profile shows about an
eighth of the time in copies, most of them of matrices of 4 to 5 kB. Random actions, with their resets and rovers in different
regimes, halve the speed.
"""

TASK = """
## {id}

### Description

{purpose}

{physics}

### Action Space

`Box(-1, 1, ({actions},), float32)`; an action of one commands {scale:.4g} {unit} of each wheel (`control="{control}"`), held for {period:g} s.

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

Those of all tasks. Defaults: model `{model}`{terrain}.

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
    extra = {"target_velocity": ("m/s", "Speed that the task asks for."), "goal_distance": ("1", "Way left to the goal.")}
    entries = []
    for k, (name, scale) in enumerate(zip(observer.names, observer.scales, strict=True)):
        unit, doc = extra[name] if name in extra else (about[name]["unit"], about[name]["doc"])
        entries.append((k, f"`{name}`", doc, -1, 1, number(scale), unit))
    draws = [(f"`{name}`", words(d), unit_of(name, about)) for name, d in setup.randomise.items()]
    grades = [(f"`{name}`", *map(number, ends), unit_of(name, about)) for name, ends in setup.grades.items()]
    start = "At rest, settled on the soil" + (", after drawing at level 1:\n\n" if draws else ". Nothing is drawn.")
    start += table(("Parameter", "Drawn", "Unit"), draws) if draws else ""
    if grades:
        start += "\n\nGraded by the level before that:\n\n" + table(("Parameter", "Level 0", "Level 1", "Unit"), grades)
    changed = [(f"`{n}`", number(v), unit_of(n, about), about[n]["doc"]) for n, v in task.parameters.items()]
    reached = " or by reaching the goal" if setup.goal.way() > 0.0 else ""
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
    """The arguments with the words that stand below them in the source."""
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
    head = HEAD.format(
        extras=" and ".join(f"`{name}`" for name in EXTRAS),
        terms=table(("Term", "Weight in `Rover-v0`", "What it is"), catalogue),
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
