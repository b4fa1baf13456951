"""How fast policies adapt to soils and hidden effects that they have not met, as rows and as a page.

    python examples/leaderboard.py                      # drives what is missing of the rows, writes the page
    python examples/leaderboard.py --check 2            # drives some episodes again and compares with the file
    python examples/leaderboard.py --split validation --out my.csv   # rows of another split, no page
    python examples/leaderboard.py --policy mine:Policy --only mine:Policy --out my.csv   # a policy of one's own, mine.py being here

Each policy drives some episodes of `bekker/BlindSlope-v0` in each world of the split, with the same soils, effects, slopes, speeds and noise
as the others (`bekker.adaptation`). Rows are written as they come; what is there is not driven again, so that a run that was cut off goes
on.
"""

import argparse
import csv
import importlib
import sys
from pathlib import Path

import gymnasium
import numpy as np
from task_sweep import put

import bekker
from bekker import adaptation, learners
from bekker.worlds import NO_EFFECT, SPLITS, World

TASK = "BlindSlope"
EPISODES = 4
WORLDS = {"train": 24, "validation": 24, "test": 42}
ROWS = Path(__file__).with_name("training") / "adaptation.csv"
PAGE = Path(__file__).with_name("adaptation.md")
COLUMNS = ("policy", "split", "world", "soil", "effect", "episode", "success", "return", "seconds", "note")
DIGITS = 6

DIAGNOSED = "diagnosed between episodes"

POLICIES = {
    "data sheet": learners.Nominal,
    "robust over the training worlds": learners.Robust,
    "rescaled by former arrivals": learners.Rescaling,
    "rescaled by a line over the slope": learners.SlipCurve,
    "calibrated between episodes": learners.Calibrating,
    DIAGNOSED: learners.Diagnosing,
    "oracle, told the world": learners.Informed,
}

# Quick enough to be driven again in a test.
CHECKED = ("data sheet", "rescaled by former arrivals", "oracle, told the world")


def drive(policy: str, world: World) -> list[dict[str, str]]:
    """The rows of one policy in one world."""
    env = gymnasium.make(f"bekker/{TASK}-v0", disable_env_checker=True)
    found = adaptation.evaluate(env, POLICIES[policy], [world], EPISODES)
    return [
        {
            "policy": policy,
            "split": world.split,
            "world": str(world.number),
            "soil": world.soil,
            "effect": world.effect,
            "episode": str(k + 1),
            "success": str(int(found.success[0, k])),
            "return": f"{found.returns[0, k]:.{DIGITS}g}",
            "seconds": f"{found.seconds[0, k]:.{DIGITS}g}",
            "note": found.notes[0][k],
        }
        for k in range(EPISODES)
    ]


def read(path: Path = ROWS) -> list[dict[str, str]]:
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def add(path: Path, rows: list[dict[str, str]]) -> None:
    new = not path.exists()
    with path.open("a", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        if new:
            table.writeheader()
        table.writerows(rows)


def results(rows: list[dict[str, str]], policy: str, split: str) -> adaptation.Adaptation:
    """The rows of a policy as what :func:`bekker.adaptation.evaluate` gives."""
    own = [row for row in rows if row["policy"] == policy and row["split"] == split]
    numbers = list(dict.fromkeys(int(row["world"]) for row in own))
    table = {name: np.array([float(row[name]) for row in own]).reshape(len(numbers), EPISODES) for name in ("return", "success", "seconds")}
    worlds = [SPLITS[split].world(number) for number in numbers]
    return adaptation.Adaptation(worlds, table["return"], table["success"].astype(bool), table["seconds"])


def table(rows: list[dict[str, str]], split: str) -> str:
    """One line a policy, the highest return of the first episodes first."""
    found = {name: results(rows, name, split) for name in dict.fromkeys(row["policy"] for row in rows)}
    heads = [f"success in episode {k + 1}" for k in range(EPISODES)]
    lines = [f"| policy | return of the first {EPISODES} episodes | 95 % | {' | '.join(heads)} |", "|---|---|---|" + "---|" * EPISODES]
    order = sorted(found, key=lambda name: -adaptation.interquartile_mean(found[name].first(EPISODES)))
    for name in order:
        result = found[name]
        mean = float(adaptation.interquartile_mean(result.first(EPISODES)))
        try:
            interval = "{:.2f} to {:.2f}".format(*result.interval(result.first(EPISODES)))
        except bekker.InputError:
            interval = "one world of an effect"
        shares = " | ".join(f"{share:.0%}".replace("%", " %") for share in result.success.mean(axis=0))
        lines.append(f"| {name} | {mean:.2f} | {interval} | {shares} |")
    return "\n".join(lines)


def worlds_of(rows: list[dict[str, str]]) -> dict[str, set[str]]:
    """Numbers of the worlds that each policy has driven."""
    return {name: {row["world"] for row in rows if row["policy"] == name} for name in dict.fromkeys(row["policy"] for row in rows)}


def leaderboard(rows: list[dict[str, str]], split: str) -> str:
    """All policies over the worlds that all of them have driven, and those that have driven more over theirs."""
    rows = [row for row in rows if row["split"] == split]
    driven = worlds_of(rows)
    common = set.intersection(*driven.values())
    parts = [f"Over the {len(common)} worlds that all policies have driven:\n", table([r for r in rows if r["world"] in common], split)]
    most = max(driven.values(), key=len)
    more = [row for row in rows if driven[row["policy"]] == most]
    if len(most) > len(common):
        parts += [f"\nOver {len(most)} worlds, for those that have driven all of these:\n", table(more, split)]
    return "\n".join(parts)


def by_effect(rows: list[dict[str, str]], split: str) -> str:
    """Successes after the first episode, one line an effect, one column a policy, over the worlds that all have driven."""
    rows = [row for row in rows if row["split"] == split]
    common = set.intersection(*worlds_of(rows).values())
    names = list(worlds_of(rows))
    lines = [f"| hidden effect | {' | '.join(names)} |", "|---|" + "---|" * len(names)]
    for effect in SPLITS[split].effects:
        cells = []
        for name in names:
            own = [r for r in rows if (r["policy"], r["effect"]) == (name, effect) and r["world"] in common and r["episode"] != "1"]
            cells.append(f"{sum(r['success'] == '1' for r in own)} of {len(own)}")
        lines.append(f"| {effect} | {' | '.join(cells)} |")
    return "\n".join(lines)


def verdict_of(row: dict[str, str]) -> str:
    """What a diagnosis says of a world, seen from what is hidden there."""
    if row["note"].startswith("no fit"):
        return "no fit"
    verdict, *names = row["note"].split()
    if verdict == "effect_missing":
        found = "names the hidden effect alone" if names == [row["effect"]] else "names the hidden effect and another"
        return found if row["effect"] in names else "names another effect"
    if verdict == "undetermined" and names:
        return "a tie that holds the hidden effect" if row["effect"] in names else "a tie without it"
    return {"undetermined": "undetermined", "explained": "explained by the soil alone"}.get(verdict, verdict)


VERDICTS = (
    "names the hidden effect alone",
    "names the hidden effect and another",
    "a tie that holds the hidden effect",
    "explained by the soil alone",
    "undetermined",
    "unexplained",
    "a tie without it",
    "names another effect",
)


def verdicts(rows: list[dict[str, str]], split: str) -> str:
    """How often each verdict is given, where an effect is hidden and where none is."""
    own = [row for row in rows if row["policy"] == DIAGNOSED and row["split"] == split and row["episode"] != str(EPISODES)]
    lines = ["| verdict | with a hidden effect | without |", "|---|---|---|"]
    # Those that are not listed, such as a failed fit, come last.
    for verdict in sorted({verdict_of(row) for row in own} | set(VERDICTS), key=lambda v: (*VERDICTS, v).index(v)):
        given = [row for row in own if verdict_of(row) == verdict]
        hidden = sum(row["effect"] != NO_EFFECT for row in given)
        lines.append(f"| {verdict} | {hidden} | {len(given) - hidden} |")
    return "\n".join(lines)


def page(rows: list[dict[str, str]]) -> str:
    """The page with the policies that have driven two worlds at least of every effect."""
    enough = {name for name, worlds in worlds_of(rows).items() if len(worlds) >= 2 * len(SPLITS["test"].effects)}
    rows = [row for row in rows if row["policy"] in enough]
    text = PAGE.read_text(encoding="utf-8")
    for name, made in {"leaderboard": leaderboard, "effects": by_effect, "verdicts": verdicts}.items():
        text = put(text, made(rows, "test"), name)
    return text


def checked_worlds(count: int) -> list[int]:
    """Some worlds of the test, with different effects."""
    step = len(SPLITS["test"].effects) + 1
    return [(1 + step * k) % WORLDS["test"] for k in range(count)]


def check(count: int) -> int:
    """Whether some rows, and the tables of the page, are what this version gives."""
    rows, wrong = read(), 0
    for number in checked_worlds(count):
        for policy in CHECKED:
            old = [row for row in rows if (row["policy"], row["split"], row["world"]) == (policy, "test", str(number))]
            new = drive(policy, SPLITS["test"].world(number))
            if new != old:
                print("differs:", old, new)
                wrong += 1
    if page(rows) != PAGE.read_text(encoding="utf-8"):
        print(f"{PAGE.name} does not show {ROWS.name}")
        wrong += 1
    print("up to date" if wrong == 0 else "out of date: remove the rows and run python examples/leaderboard.py")
    return min(wrong, 1)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--split", default="test", choices=SPLITS)
    parser.add_argument("--worlds", type=int, help="how many worlds of the split; as on the page where missing")
    parser.add_argument("--out", type=Path, default=ROWS)
    parser.add_argument("--only", nargs="+", help=f"some of the policies: {', '.join(map(repr, POLICIES))}, or one of --policy")
    parser.add_argument("--policy", action="append", default=[], metavar="MODULE:CLASS", help="a policy of one's own besides")
    parser.add_argument("--check", type=int, metavar="WORLDS", help="drive so many worlds again with the quick policies and compare")
    given = parser.parse_args()
    if given.check is not None:
        return check(given.check)
    if given.out == ROWS and (given.policy or given.split != "test"):
        parser.error("--policy and another --split need --out: the project's rows are of its own policies on the test")
    sys.path.insert(0, str(Path.cwd()))
    for name in given.policy:
        module, kind = name.split(":")
        POLICIES[name] = getattr(importlib.import_module(module), kind)
    if other := [name for name in given.only or () if name not in POLICIES]:
        parser.error(f"--only {other[0]!r}: expected one of {', '.join(map(repr, POLICIES))}")
    done = {(row["policy"], row["split"], int(row["world"])) for row in read(given.out)}
    for world in SPLITS[given.split].worlds(given.worlds or WORLDS[given.split]):
        for policy in given.only or POLICIES:
            if (policy, given.split, world.number) not in done:
                rows = drive(policy, world)
                add(given.out, rows)
                print(world.number, world.effect, policy, *(row["success"] for row in rows), rows[-1]["note"], flush=True)
    if given.out == ROWS:
        PAGE.write_text(page(read()), encoding="utf-8")
    else:
        print(table(read(given.out), given.split))
    return 0


if __name__ == "__main__":
    sys.exit(main())
