#!/usr/bin/env python3
"""The study of a soil that is known from tests: what it helps where it is the wheel's own, and what it does where it is another one.

    python3 tests/study/known_soil.py --bekker target/release/bekker --seeds 2 --out FOLDER

Presses plates and shears rings on a soil, keeps what `bekker calibrate` finds of it (`--save-soil`), and has a wheel diagnosed three times:
without it, with it (`own`), and with the one of another kind of soil (`other`), which `--soil-from` states although it is wrong. In the
wheel one effect is hidden, each that a wheel on a carriage shows, or nothing: in the library's form (`--set development`), or in another one of the
literature where there is one (`--set report`). Wheels of one seed stand on one soil; each has tests of its own. What has rows in FOLDER/rows.csv is
not made again.

Scored: `right` (the effect alone; nothing where nothing is hidden), `right_tie` (a tie of at most three with effects of like signature), `wrong` (another
name, one too many, a false alarm), `missed` (the model is called enough, and the effect is visible), `cautious` (all else: nothing is named).
`told` says whether a caution names a parameter that moved or the soil as a whole. Needs numpy only.
"""

import argparse
import csv
import functools
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import plan  # noqa: E402
import score  # noqa: E402
import together  # noqa: E402

import cases  # noqa: E402  (plan puts the generators on the path)
import joint  # noqa: E402

FIRST_SEED = {"development": 4000, "report": 111000}
SOURCES = ("none", "own", "other")
TESTS = ("plates", "shear")
COLUMNS = ("name", "source", "soil", "case", "form", "seed", "outcome", "verdict", "said", "tied", "deviations", "told", "error")
# Outcomes of a set that name no effect, nor that the model is enough.
NOTHING_NAMED = ("false_alarm", "broad_tie", "undecided", "unexplained", "partial")
# Words of the cautions about a known soil.
MOVED = ("standard deviations of its prior", "together the soil moved")


def jobs(first, seeds):
    for seed in range(first, first + seeds):
        yield from ((case, seed) for case in ("clean", *together.effects_of(cases.WHEEL)))


@functools.cache
def another_soil(seed, scatter):
    """A seed whose soil has another name."""
    own = joint.shared_soil(seed, scatter)[0]
    return next(other for other in range(seed + 500, seed + 600) if joint.shared_soil(other, scatter)[0] != own)


def tested(bekker, folder, case, seed, scatter):
    """What plates and shear tests tell of the soil of a seed, as a file, and its name."""
    # No part has the name of the case: nothing is hidden, and the noise is that of this case.
    truth = joint.make(folder, TESTS, "clean", f"for {case}", seed, scatter=scatter)
    file = folder / "soil.toml"
    subprocess.run([bekker, "calibrate", *(folder / part for part in TESTS), "--save-soil", file], capture_output=True)
    return file, truth["soil_name"]


def outcome(truth, result):
    """One word, see above."""
    whole = {**result, "where": {name: ["wheel"] for name in result.get("effects", [])}}
    word = together.outcome(truth, whole)
    if word in ("extra", "false_alarm") and result.get("verdict") == "effect_missing":
        return "wrong"
    return "cautious" if word in NOTHING_NAMED else word


def run(bekker, set_name, job, folder):
    """The rows of one wheel."""
    case, seed = job
    form = plan.form_for(set_name, cases.WHEEL, case) or None
    scatter = together.SCATTER[seed % len(together.SCATTER)]
    truth = joint.make(folder, ("wheel",), case, "wheel", seed, form=form, scatter=scatter)
    files = {"none": (None, ""), "own": tested(bekker, folder / "own", case, seed, scatter)}
    files["other"] = tested(bekker, folder / "other", case, another_soil(seed, scatter), scatter)
    rows = []
    for source in SOURCES:
        file, soil = files[source]
        known = [] if file is None else ["--soil-from", str(file)]
        result = together.diagnosed(bekker, [folder / "wheel", *known], 1, folder / f"{source}.json")
        together.look_alikes(truth, result)
        told = any(words in caution for caution in result.get("cautions", []) for words in MOVED)
        rows.append({
            "name": f"{set_name}_{case}_{seed}_{source}", "source": source, "soil": soil, "case": case, "form": form or "", "seed": seed,
            "outcome": outcome(truth, result), "verdict": result.get("verdict", ""), "said": "+".join(result.get("effects", [])),
            "tied": ";".join(sorted(score.tied(result))), "deviations": ";".join(f"{effect['deviations']:.1f}" for effect in truth["effects"]),
            "told": "yes" if told else "", "error": result.get("error", ""),
        })  # fmt: skip
    return rows


def report(rows):
    """Counts by what was known of the soil."""
    words = ("right", "right_tie", "cautious", "missed", "wrong", "error")
    lines = ["| hidden | known soil | wheels | " + " | ".join(word.replace("_", " ") for word in words) + " | told that it moved |", "|---" * (len(words) + 4) + "|"]
    for title, belongs in (("one effect", lambda row: row["case"] != "clean"), ("nothing", lambda row: row["case"] == "clean")):
        for source in SOURCES:
            own = [row for row in rows if row["source"] == source and belongs(row)]
            counts = " | ".join(str(sum(row["outcome"] == word for row in own)) for word in words)
            lines.append(f"| {title} | {source} | {len(own)} | {counts} | {sum(row['told'] == 'yes' for row in own)} |")
    wrong = [f"- {row['name']}: {row['verdict']} {row['said'] or row['error']}" for row in rows if row["outcome"] in ("wrong", "error")]
    return "\n".join([*lines, "", *wrong]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bekker", default="target/release/bekker")
    parser.add_argument("--set", choices=FIRST_SEED, default="development", dest="set_name")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--first-seed", type=int)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("study-of-known-soils"))
    parser.add_argument("--table", type=Path, help="print the table of these rows and do nothing else")
    a = parser.parse_args()
    if a.table:
        with open(a.table, newline="") as file:
            print(report(list(csv.DictReader(file))))
        return
    a.out.mkdir(parents=True, exist_ok=True)
    path = a.out / "rows.csv"
    rows = list(csv.DictReader(open(path, newline=""))) if path.exists() else []
    done = {(row["case"], int(row["seed"])) for row in rows}
    first = FIRST_SEED[a.set_name] if a.first_seed is None else a.first_seed
    with ProcessPoolExecutor(a.jobs) as pool:
        wanted = [job for job in jobs(first, a.seeds) if job not in done]
        running = [pool.submit(run, a.bekker, a.set_name, job, a.out / "wheels" / f"{job[0]}_{job[1]}") for job in wanted]
        together.collect(path, COLUMNS, rows, running)
    print(report(rows))


if __name__ == "__main__":
    main()
