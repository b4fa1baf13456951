"""How hard the tasks are: constant actions, controllers and an oracle over the same episodes, as rows and as a page.

    python examples/task_sweep.py            # drives all rows again, writes examples/training/sweep.csv and the page's tables
    python examples/task_sweep.py --check 3  # drives a sample again, three rows of each task, and compares with the file

The constant actions of the sweep were fixed before any result was seen; of the 100 episodes planned 50 were driven, which was decided when
a few rows of SpeedHold had been seen. Constants are eleven equal values for all
wheels, 0 to 1, and a grid of five by five values for the first wheel and for the others. `env/tests/test_tasks.py` holds what
the rows say of the tasks: no constant action succeeds in more than 60 % of the episodes, the oracle in at least 90 %.
"""

import argparse
import csv
import sys
from pathlib import Path

import gymnasium
import numpy as np

import bekker
from bekker import baselines, oracles

TASKS = ("SpeedHold", "SlopeClimb", "BlindSlope", "DitchCrossing", "EnergyTraverse", "RockTraverse", "SlipLimited")
SEEDS = range(20_000, 20_050)
ROWS = Path(__file__).with_name("training") / "sweep.csv"
PAGE = Path(__file__).with_name("training.md")
COLUMNS = ("task", "policy", "action", "success", "return", "distance", "energy", "seconds", "ordered")
DIGITS = 6

SPEED = 0.2
"""Speed of the controllers where a task asks for none, m/s."""

CONTROLLERS = {
    "velocity control": baselines.velocity,
    "RTC": baselines.rtc,
    "RTC with wheel-speed loops": baselines.rtc_speed,
    "slip control": baselines.slip_control,
    # Its speed is that of the schedule.
    "slow near steep ground": lambda env, _: baselines.CarefulSpeeds(env),
}


def constants(wheels: int) -> list[tuple[float, ...]]:
    """The constant actions of the sweep."""
    equal = [(k / 10,) * wheels for k in range(11)]
    grid = [(first / 5, *(others / 5,) * (wheels - 1)) for first in range(1, 6) for others in range(1, 6)]
    return equal + [action for action in grid if action not in equal]


def drive_constant(task: str, action: tuple[float, ...], seeds: range = SEEDS) -> baselines.Evaluation:
    """One episode a seed, all of them side by side."""
    env = bekker.RoverVectorEnv(len(seeds), task=task, autoreset_mode="Disabled")
    env.reset(seed=seeds[0])
    mechanics = env.mechanics
    actions = np.tile(np.array(action, np.float32), (len(seeds), 1))
    returns = np.zeros(len(seeds))
    for _ in range(bekker.TASKS[task].max_episode_steps):
        running = ~mechanics.terminated
        if not running.any():
            break
        mechanics.step(actions, running)
        returns += mechanics.rewards()
    ends = mechanics.columns()
    return baselines.Evaluation(
        returns, ends["success"], ends["electrical_energy"], ends["distance"], mechanics.elapsed.copy(), list(ends["status"])
    )


def drive(task: str, policy: str, action: str) -> baselines.Evaluation:
    """The episodes of one row."""
    if policy == "constant":
        return drive_constant(task, tuple(float(part) for part in action.split()))
    env = gymnasium.make(f"bekker/{task}-v0", disable_env_checker=True)
    if policy == "oracle":
        return oracles.evaluate(env, SEEDS)
    return baselines.evaluate(env, CONTROLLERS[policy](env, SPEED), SEEDS)


def row(task: str, policy: str, action: str, result: baselines.Evaluation) -> dict[str, str]:
    numbers = {
        "success": result.success.mean(),
        "return": result.returns.mean(),
        "distance": result.distance.mean(),
        "energy": result.energy.mean(),
        "seconds": result.steps.mean() * bekker.tasks.PERIOD,
    }
    return {"task": task, "policy": policy, "action": action, **{k: f"{v:.{DIGITS}g}" for k, v in numbers.items()}}


def ordered(results: list[baselines.Evaluation]) -> float:
    """Share of the pairs of one successful and one failed episode in which the successful one has the higher return."""
    good = np.concatenate([r.returns[r.success] for r in results])
    bad = np.sort(np.concatenate([r.returns[~r.success] for r in results]))
    return float((np.searchsorted(bad, good, "left") + np.searchsorted(bad, good, "right")).mean() / (2 * len(bad)))


def sweep(task: str) -> list[dict[str, str]]:
    """All rows of one task."""
    env = bekker.RoverEnv(task=task)
    torques, sees = env.setup.model.control == "torque", env.setup.ahead is not None
    wanted = {"velocity control": True, "slow near steep ground": sees}
    plan = [("constant", " ".join(f"{part:g}" for part in action)) for action in constants(env.setup.model.wheels)]
    plan += [(name, "") for name in CONTROLLERS if wanted.get(name, torques)]
    plan.append(("oracle", ""))
    rows, results = [], []
    for policy, action in plan:
        results.append(drive(task, policy, action))
        rows.append(row(task, policy, action, results[-1]))
        print(*rows[-1].values(), flush=True)
    for entry in rows:
        entry["ordered"] = f"{ordered(results):.4f}"
    return rows


def read() -> list[dict[str, str]]:
    with ROWS.open(newline="") as file:
        return list(csv.DictReader(file))


def write(rows: list[dict[str, str]]) -> None:
    with ROWS.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def best_constant(rows: list[dict[str, str]]) -> dict[str, str]:
    """The constant action with the most successes, of equals the one with the higher return."""
    return max((r for r in rows if r["policy"] == "constant"), key=lambda r: (float(r["success"]), float(r["return"])))


def table(rows: list[dict[str, str]]) -> str:
    """The table of the page."""
    lines = ["| task | policy | mean return | success | distance, m | energy, J | time, s |", "|---|---|---|---|---|---|---|"]
    for task in dict.fromkeys(r["task"] for r in rows):
        own = [r for r in rows if r["task"] == task]
        best = best_constant(own)
        named = [(f"best constant action: {best['action']}", best)]
        named += [(r["policy"], r) for r in own if r["policy"] != "constant"]
        for name, r in named:
            numbers = [float(r[k]) for k in ("return", "success", "distance", "energy", "seconds")]
            lines.append("| {} | {} | {:.2f} | {:.0%} | {:.2f} | {:.0f} | {:.1f} |".format(task, name, *numbers).replace("%", " %"))
    return "\n".join(lines)


def put(text: str, part: str, name: str = "sweep") -> str:
    """The page with the table of this name replaced."""
    before, rest = text.split(f"<!-- {name} -->\n")
    _, after = rest.split(f"<!-- end of {name} -->")
    return f"{before}<!-- {name} -->\n{part}\n<!-- end of {name} -->{after}"


def sample(rows: list[dict[str, str]], count: int) -> list[dict[str, str]]:
    """Some rows of each task, the same ones always: the best constant action and others spread over the sweep."""
    chosen = []
    for task in dict.fromkeys(r["task"] for r in rows):
        own = [r for r in rows if r["task"] == task and r["policy"] == "constant"]
        others = [own[k * len(own) // max(count - 1, 1)] for k in range(count - 1)]
        chosen += [best_constant(own), *(r for r in others if r is not best_constant(own))]
    return chosen


def check(count: int) -> int:
    """Whether a sample of the rows and the table of the page are what this version gives."""
    rows, wrong = read(), 0
    for old in sample(rows, count):
        new = row(old["task"], old["policy"], old["action"], drive(old["task"], old["policy"], old["action"]))
        if any(new[k] != old[k] for k in new):
            print("differs:", old, new)
            wrong += 1
    if put(PAGE.read_text(encoding="utf-8"), table(rows)) != PAGE.read_text(encoding="utf-8"):
        print(f"{PAGE.name} does not show {ROWS.name}")
        wrong += 1
    print("up to date" if wrong == 0 else "out of date: python examples/task_sweep.py")
    return min(wrong, 1)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", nargs="+", default=TASKS, choices=TASKS)
    parser.add_argument("--check", type=int, metavar="ROWS", help="drive so many rows of each task again and compare")
    given = parser.parse_args()
    if given.check:
        return check(given.check)
    kept = [r for r in read() if r["task"] not in given.tasks] if ROWS.exists() else []
    rows = kept + [r for task in given.tasks for r in sweep(task)]
    rows.sort(key=lambda r: TASKS.index(r["task"]))
    write(rows)
    PAGE.write_text(put(PAGE.read_text(encoding="utf-8"), table(rows)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
