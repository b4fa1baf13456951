#!/usr/bin/env python3
"""The study of several experiments on one soil: the right effect, in the right place, and how much smaller it may be than alone.

    python3 tests/study/together.py --bekker target/release/bekker --set development --seeds 5 --out FOLDER
    python3 tests/study/together.py --table FOLDER/rows.csv

Makes sets with tests/generators/joint.py, has each diagnosed by one `bekker diagnose A B ..`, and adds a row to FOLDER/rows.csv as
soon as it is; what has a row there is not made again. What is hidden: each effect that a wheel on a carriage shows, in one of two
wheels, in both, and in a wheel beside plates or beside plates and shear tests; effects of the tests beside a wheel; nothing; and two
wheels on two soils (`other_soil`), where no name is right. `--drives` makes other sets: a wheel, or plates and a wheel, beside four runs of a
rover, with each effect that both show in the wheel, in the drive and in both, and each that the drive alone shows. The soil of the parts differs a little, by seed. `--multiples` hides slip-sinkage at shares of what the part can see alone, and
has the part diagnosed by itself, too.

Scored: `right` (the effect alone, in the places where it acts), `wrong_place` (the effect, elsewhere), `right_tie` (tied with effects of like
signature in the same part, or with the same effect elsewhere, at most three), `wrong` (another named), `false_alarm`, `cautious`
(nothing named where no name is right); the rest says too little. Needs numpy only.
"""

import argparse
import csv
import json
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import plan  # noqa: E402
import score  # noqa: E402
import table  # noqa: E402

import alike  # noqa: E402  (plan puts the generators on the path)
import cases  # noqa: E402
import joint  # noqa: E402
import soil_tests  # noqa: E402

FIRST_SEED = {"development": 3000, "report": 101000}
LONGEST = 1800.0  # s, of one diagnosis
COLUMNS = ("name", "parts", "case", "place", "multiple", "form", "seed", "outcome", "verdict", "said", "where", "tied", "deviations", "alone", "seconds", "error")
TWO, PLATES, THREE = ("wheel", "other_wheel"), ("plates", "wheel"), ("plates", "shear", "wheel")
DRIVE, PLATES_DRIVE = ("wheel", "drive"), ("plates", "wheel", "drive")
OTHER_SOIL = "other_soil"
# How much the soil differs from part to part, by seed; the diagnosis takes 0.05.
SCATTER = (0.0, 0.03, 0.06)
MULTIPLES = (0.25, 0.5, 0.75, 1.0, 1.5)


def effects_of(kind):
    """Effects of the library that such an experiment shows."""
    return [case for case in cases.cases_of(kind, False) if any(f.case == case and not f.outside for f in cases.FORMS)]


def drive_jobs(seed):
    yield from ((parts, "clean", "all", None, seed) for parts in (DRIVE, PLATES_DRIVE))
    of_wheel = effects_of(cases.WHEEL)
    for effect in effects_of(cases.ROVER):
        places = ("wheel", "drive", "all") if effect in of_wheel else ("drive",)
        yield from ((DRIVE, effect, place, None, seed) for place in places)
        yield (PLATES_DRIVE, effect, "drive", None, seed)


def jobs(set_name, seeds, first_seed, multiples, drives=False):
    first = FIRST_SEED[set_name] if first_seed is None else first_seed
    for seed in range(first, first + seeds):
        if drives:
            yield from drive_jobs(seed)
            continue
        if multiples:
            yield from ((TWO, "slip_sinkage", place, multiple, seed) for place in TWO for multiple in MULTIPLES)
            continue
        for parts in (TWO, PLATES, THREE):
            yield (parts, "clean", "all", None, seed)
        for effect in effects_of(cases.WHEEL):
            yield from ((TWO, effect, place, None, seed) for place in (*TWO, "all"))
            yield from ((parts, effect, "wheel", None, seed) for parts in (PLATES, THREE))
        for case in ("plate_size", "box_bottom", "rate", "seating"):
            yield from ((parts, case, "plates", None, seed) for parts in (PLATES, THREE))
        for case in ("shear_rate", "box_friction", "shear_play", "softening"):
            yield (THREE, case, "shear", None, seed)
        yield (TWO, OTHER_SOIL, "all", None, seed)


def name_of(set_name, job):
    parts, case, place, multiple, seed = job
    return f"{set_name}_{'+'.join(parts)}_{case}_{place}_{multiple or 'drawn'}_{seed}"


def diagnosed(bekker, folders, threads, output):
    command = [bekker, "diagnose", *map(str, folders), "--json", str(output), "--threads", str(threads)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return {"error": f"no diagnosis within {LONGEST:.0f} s"}
    return json.loads(output.read_text()) if done.returncode == 0 else {"error": done.stderr.strip()[-300:]}


def plain(effect):
    """An effect without where it acts."""
    return effect.split(" not in ")[0].split(" in ")[0]


def outcome(truth, result):
    """One word, see above."""
    if "error" in result:
        return "error"
    verdict, said, case = result["verdict"], result["effects"], truth["case"]
    named = set(said) if verdict == "effect_missing" else set()
    if case == "clean":
        return "right" if verdict == "explained" else "false_alarm"
    if case == OTHER_SOIL:
        return "wrong" if named else "cautious"
    true, places = {"softening": "shear_softening"}.get(case, case), set(truth["where"])
    visible = all(effect["visible"] for effect in truth["effects"])
    allowed = {true} | {name for effect in truth["effects"] for name in effect["allowed_ties"]}
    if not visible:
        return "wrong" if named - allowed else "cautious"
    if named:
        if named != {true}:
            return "extra" if true in named else "wrong"
        return "right" if set(result.get("where", {}).get(true, [])) == places else "wrong_place"
    if verdict == "undetermined":
        possible = score.tied(result)
        if true in {plain(name) for name in possible}:
            alike = {plain(name) for name in possible} <= allowed
            return "right_tie" if alike and len(possible) <= score.MOST_TIED else "broad_tie"
    if verdict == "unexplained":
        return "partial" if true in said else "unexplained"
    return "missed" if verdict == "explained" else "undecided"


def look_alikes(truth, result):
    """Decides which of what was said is like the hidden effect, in each part that has it by itself (of tests of a soil that is known)."""
    said = sorted({plain(name) for name in alike.beside([], result)} - {truth["case"]})
    benches = None
    for effect in truth["effects"]:
        if effect["part"] in joint.TESTS:
            continue
        if said and benches is None:
            *_, benches = joint.shared_soil(truth["seed"], truth["scatter"], joint.DRIVE in truth["parts"])
        detector = joint.detector_of(effect["part"], benches[effect["part"]], truth["noise"]) if said else None
        alike.judge(detector, joint.kind_of(effect["part"]), [effect], said)


def run(bekker, set_name, job, folder, threads):
    parts, case, place, multiple, seed = job
    # The report hides other forms of the literature.
    kind = cases.ROVER if place == "drive" else cases.WHEEL
    form = plan.form_for(set_name, kind, case) or None
    inside = "clean" if case == OTHER_SOIL else case
    truth = joint.make(folder, parts, inside, place, seed, multiple=multiple, form=form, scatter=SCATTER[seed % len(SCATTER)]) | {"case": case}
    folders = [folder / part for part in parts]
    if case == OTHER_SOIL:
        joint.make(folder / "beside", parts[1:], "clean", "all", seed + 500)
        folders[1] = folder / "beside" / parts[1]
    start = time.monotonic()
    result = diagnosed(bekker, folders, threads, folder / "diagnosis.json")
    seconds = time.monotonic() - start
    look_alikes(truth, result)
    alone = ""
    if multiple:
        by_itself = diagnosed(bekker, [folder / place], threads, folder / "alone.json")
        alone = by_itself.get("verdict", "error") + ":" + "+".join(by_itself.get("effects", []))
    deviations = [f"{effect['deviations']:.1f}" for effect in truth["effects"]]
    where = [f"{effect}@{'&'.join(places)}" for effect, places in result.get("where", {}).items()]
    return {
        "name": name_of(set_name, job), "parts": "+".join(parts), "case": case, "place": place, "multiple": multiple or "", "form": form or "",
        "seed": seed, "outcome": outcome(truth, result), "verdict": result.get("verdict", ""), "said": "+".join(result.get("effects", [])),
        "where": ";".join(where), "tied": ";".join(sorted(score.tied(result))), "deviations": ";".join(deviations), "alone": alone,
        "seconds": f"{seconds:.1f}", "error": result.get("error", ""),
    }  # fmt: skip


def rows_of(*job):
    """The row of one set, as `collect` takes it."""
    return [run(*job)]


def report(rows):
    """Counts by what was hidden, with 95 % intervals of the rate of good outcomes."""
    good = {"right", "right_tie", "cautious"}
    bad = {"wrong", "wrong_place", "extra", "false_alarm"}
    shown = [row for row in rows if not row["multiple"]]
    groups = {"all": lambda row: row["case"] != OTHER_SOIL, "nothing hidden": lambda row: row["case"] == "clean"}
    groups |= {f"{'+'.join(parts)}, one effect": lambda row, p="+".join(parts): row["parts"] == p and row["case"] not in ("clean", OTHER_SOIL) for parts in (TWO, PLATES, THREE, DRIVE, PLATES_DRIVE)}
    groups["two soils"] = lambda row: row["case"] == OTHER_SOIL
    lines = ["| | sets | right or honestly tied | 95 % | wrong name, place or alarm | seconds, median | longest |", "|---|---|---|---|---|---|---|"]
    for title, belongs in groups.items():
        own = [row for row in shown if belongs(row)]
        if own:
            count = sum(row["outcome"] in good for row in own)
            low, high = table.wilson(count, len(own))
            seconds = sorted(float(row["seconds"]) for row in own)
            wrong = sum(row["outcome"] in bad for row in own)
            lines.append(f"| {title} | {len(own)} | {100 * count / len(own):.1f} % | {100 * low:.1f} to {100 * high:.1f} | {100 * wrong / len(own):.1f} % | {seconds[len(own) // 2]:.1f} | {seconds[-1]:.1f} |")
    swept = [row for row in rows if row["multiple"]]
    if swept:
        lines += ["", "| strength, of what is seen alone | sets | named alone | named together | in the right place |", "|---|---|---|---|---|"]
        for multiple in sorted({row["multiple"] for row in swept}, key=float):
            own = [row for row in swept if row["multiple"] == multiple]
            alone = sum(row["alone"] == f"effect_missing:{row['case']}" for row in own)
            together = sum(row["said"] == row["case"] and row["verdict"] == "effect_missing" for row in own)
            right = sum(row["where"] == f"{row['case']}@{row['place']}" and row["verdict"] == "effect_missing" for row in own)
            lines.append(f"| {multiple} | {len(own)} | {alone} | {together} | {right} |")
    others = [f"- {row['name']}: {row['outcome']}, {row['verdict']} {row['where'] or row['tied'] or row['error']}" for row in shown if row["outcome"] not in good]
    return "\n".join(lines + ["", *others]) + "\n"


def collect(path, columns, rows, running):
    """Adds the rows of diagnoses under way to the file, after those that it has, as soon as they are there."""
    with open(path, "a", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        if not rows:
            writer.writeheader()
        for future in as_completed(running):
            made = future.result()
            rows += made
            writer.writerows(made)
            file.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bekker", default="target/release/bekker")
    parser.add_argument("--set", choices=FIRST_SEED, default="development", dest="set_name")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int)
    parser.add_argument("--multiples", action="store_true")
    parser.add_argument("--drives", action="store_true", help="sets with drives in place of those without")
    parser.add_argument("--only", help="sets of these parts only, as in plates+wheel,plates+shear+wheel")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("study-of-sets"))
    parser.add_argument("--table", type=Path, help="print the tables of these rows and do nothing else")
    a = parser.parse_args()
    if a.table:
        with open(a.table, newline="") as file:
            print(report(list(csv.DictReader(file))))
        return
    a.out.mkdir(parents=True, exist_ok=True)
    path = a.out / "rows.csv"
    rows = list(csv.DictReader(open(path, newline=""))) if path.exists() else []
    done = {row["name"] for row in rows}
    wanted = [job for job in jobs(a.set_name, a.seeds, a.first_seed, a.multiples, a.drives) if name_of(a.set_name, job) not in done]
    if a.only:
        wanted = [job for job in wanted if "+".join(job[0]) in a.only.split(",")]
    print(f"{len(wanted)} sets, {len(rows)} done before", flush=True)
    with ProcessPoolExecutor(a.jobs) as pool:
        running = [pool.submit(rows_of, a.bekker, a.set_name, job, a.out / "sets" / name_of(a.set_name, job), a.threads) for job in wanted]
        collect(path, COLUMNS, rows, running)
    (a.out / "together.md").write_text(report(rows))
    print(report(rows))


if __name__ == "__main__":
    main()
