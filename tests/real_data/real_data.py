#!/usr/bin/env python3
"""Real measurements, what the tool says of them, and what a careful expert would let it say.

    python3 tests/real_data/real_data.py --bekker target/release/bekker [--data $BEKKER_DATA] [--markdown FILE]

The allowed answers stand in `answers.toml`, written down before any set was run. Each set becomes an experiment folder by mapping
the columns of the file as it is. Sets whose data are missing are skipped, counted and named at the end. Needs Python 3.11 only.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import field_logs  # noqa: E402

DATA = Path(os.environ.get("BEKKER_DATA", HERE.parents[2] / "shared" / "data"))
MOST_TIED = 3
CUT = 0.3  # share of the left-out error that a named effect has to take away

CMU = """name = "CMU smooth wheel"
kind = "single_wheel"
{top}
[parameters]
"wheel.radius" = {{ value = 58, unit = "mm" }}
"wheel.width" = {{ value = 50, unit = "mm" }}
{more}
[[run]]
file = "trials.csv"
"""

CMU_ALL = """name = "CMU smooth wheel, all slips"
kind = "single_wheel"
ignore = ["Vry", "trial", "Fs", "sDP", "sW", "sZ"]
[file]
where = { beta = 0 }
[columns]
"DP" = "drawbar_pull"
"W" = "load"
"z" = { signal = "sinkage", unit = "mm" }
"Vx" = { signal = "carriage_speed", unit = "mm/s" }
"Vr" = { signal = "rim_speed", unit = "mm/s" }
"slip" = "slip"
[parameters]
"wheel.radius" = { value = 58, unit = "mm" }
"wheel.width" = { value = 50, unit = "mm" }
[noise]
# Three repeats of a set-point scatter so; the file has no labels.
drawbar_pull = 0.3
sinkage = { value = 0.6, unit = "mm" }
[[run]]
file = "cmu_smooth_189trials.csv"
"""

DING = """name = "Ding et al. 2011, {what}"
kind = "single_wheel"
ignore = ["source", "soil_simulant", "soil_shear_modulus_k_m", "grouser_count", "status", "citation", "notes", "case_id", {ignored}]
[columns]
"meas_drawbar_pull_n" = "drawbar_pull"
"meas_sinkage_m" = "sinkage"
"meas_torque_nm" = "torque"
"vertical_load_n" = "load"
"wheel_radius_m" = {{ parameter = "wheel.radius" }}
"wheel_width_m" = {{ parameter = "wheel.width" }}
{columns}
[inputs]
wheel_speed = 0.1
{more}
[[run]]
file = "ding2011_single_wheel.csv"
{where}
"""

READING_ERROR = """[noise]
drawbar_pull = 0.7
torque = 0.15
sinkage = { value = 0.5, unit = "mm" }
"""

DING_SOIL = """[priors]
"soil.cohesion" = { mean = 250, sd = 100 }
"soil.friction_angle" = { mean = 31.9, sd = 2, unit = "deg" }
"soil.exponent" = { mean = 1.1, sd = 0.1 }
"soil.shear_modulus" = { mean = 11.4, sd = 2, unit = "mm" }
"""

SMOOTH, LUGS = 'where = { grouser_height_m = 0 }', 'where = { grouser_height_m = 0.01 }'
ONE_WHEEL = '"grouser_height_m"'

# Name of the set: file of shared/data, experiment.toml, further arguments.
SETS = {
    "cmu_smooth": ("cmu_smooth/trials.csv", CMU.format(top="", more=""), []),
    "cmu_smooth_dry_sand": ("cmu_smooth/trials.csv", CMU.format(top='soil.class = "dry sand"', more=""), []),
    "cmu_smooth_plates": (
        "cmu_smooth/trials.csv",
        CMU.format(top="", more='[priors]\n"soil.exponent" = { mean = 1.31, sd = 0.09 }\n"soil.k_phi" = { mean = 8e6, sd = 4e6 }'),
        [],
    ),
    "cmu_all_slips": ("cmu_smooth_189trials.csv", CMU_ALL, []),
    "ding_smooth": (
        "ding2011_single_wheel.csv",
        DING.format(what="smooth", ignored=ONE_WHEEL, columns="", more="", where=SMOOTH),
        [],
    ),
    "ding_smooth_noise": (
        "ding2011_single_wheel.csv",
        DING.format(what="smooth", ignored=ONE_WHEEL, columns="", more=READING_ERROR, where=SMOOTH),
        [],
    ),
    "ding_lugs": (
        "ding2011_single_wheel.csv",
        DING.format(what="lugs", ignored=ONE_WHEEL, columns="", more=DING_SOIL + READING_ERROR, where=LUGS),
        [],
    ),
    "ding_both": (
        "ding2011_single_wheel.csv",
        DING.format(
            what="both wheels",
            ignored="",
            columns='"grouser_height_m" = { parameter = "grousers.height" }',
            more=READING_ERROR,
            where="",
        ),
        [],
    ),
}


# Logs of rovers: one file of shared/data that has to be there, and what makes the folder.
FIELD_LOGS = {
    "cuadriga": ("cuadriga_2019/2019_01_29_10_53_36.csv", field_logs.cuadriga),
    "husky_loam": ("husky/borealtc_sandy_loam.csv", field_logs.husky),
    "husky_asphalt": ("husky/borealtc_asphalt.csv", field_logs.husky),
}


def copied(toml):
    def make(file, folder):
        shutil.copy(file, folder)
        (folder / "experiment.toml").write_text(toml, encoding="utf-8")

    return make


def diagnose(bekker, folder, extra):
    """The result as JSON and what was printed; {"error": ..} where there is none."""
    output = folder / "diagnosis.json"
    done = subprocess.run([bekker, "diagnose", str(folder), "--json", str(output), *extra], capture_output=True, text=True)
    if done.returncode != 0 or not output.exists():
        return {"error": (done.stderr or done.stdout).strip()}, done.stdout
    return json.loads(output.read_text(encoding="utf-8")), done.stdout


def said(result):
    """Effects that the tool names, and how."""
    if "error" in result:
        return [], "error"
    if result["verdict"] == "undetermined":
        return [c["effect"] for c in result["candidates"] if c["tied"]], "tied"
    return result["effects"], "named" if result["verdict"] == "effect_missing" else "partial"


def cut(result):
    """Share of the left-out error that the steps take away, the least over the signals."""
    first, last = result["steps"][0]["heldout_rmse"], result["steps"][-1]["heldout_rmse"]
    return min(1.0 - last[signal] / first[signal] for signal in first) if len(result["steps"]) > 1 else 0.0


def mistakes(answer, result, printed):
    """What the tool says that the expert would not let it say."""
    if "error" in result:
        return [f"no answer: {result['error'][:200]}"]
    found = []
    effects, how = said(result)
    if result["verdict"] not in answer["allowed"]:
        found.append(f"`{result['verdict']}` is not among {answer['allowed']}")
    strange = sorted(set(effects) - set(answer["names"]))
    if how == "named" and strange:
        found.append(f"confidently named: {', '.join(strange)}")
    if wanted := answer["must_name"]:
        few = len(effects) <= (MOST_TIED if how == "tied" else 1)
        if not (set(wanted) & set(effects) and few):
            found.append(f"{' or '.join(wanted)} is not named, tied among {MOST_TIED}, or the only part")
        elif cut(result) < CUT:
            found.append(f"the left-out error falls by {100 * cut(result):.0f} % only")
    found += [f"does not say `{word}`" for word in answer.get("says", []) if word not in printed]
    return found


def row(name, answer, result, wrong):
    if "error" in result:
        return f"| {name} | error | | | {'; '.join(wrong)} |"
    effects, how = said(result)
    fall = f"{100 * cut(result):.0f} %" if len(result["steps"]) > 1 else "-"
    what = f"{how}: {', '.join(effects)}" if effects else "-"
    return f"| {name} | {result['verdict']} | {what} | {fall} | {'; '.join(wrong) or 'allowed'} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bekker", default="bekker")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--only", help="names of sets, separated by commas")
    parser.add_argument("--keep", type=Path, help="keep the folders and results here")
    parser.add_argument("--markdown", type=Path, help="write the table here too")
    arguments = parser.parse_args()
    answers = tomllib.loads((HERE / "answers.toml").read_text(encoding="utf-8"))
    wanted = arguments.only.split(",") if arguments.only else list(answers)
    lines = ["| set | verdict | effects | left-out error falls by | judged |", "|---|---|---|---|---|"]
    failed, skipped = 0, []
    for name in wanted:
        if name not in SETS and name not in FIELD_LOGS:
            skipped.append(f"{name}: waits for: {answers[name].get('issue', 'a way to read it')}")
            continue
        if name in FIELD_LOGS:
            (file, make), extra = FIELD_LOGS[name], []
        else:
            file, toml, extra = SETS[name]
            make = copied(toml)
        if not (arguments.data / file).exists():
            skipped.append(f"{name}: needs the measurements {file}")
            continue
        with tempfile.TemporaryDirectory() as scratch:
            folder = (arguments.keep or Path(scratch)) / name
            folder.mkdir(parents=True, exist_ok=True)
            make(arguments.data / file, folder)
            result, printed = diagnose(arguments.bekker, folder, extra)
        wrong = mistakes(answers[name], result, printed)
        failed += bool(wrong)
        lines.append(row(name, answers[name], result, wrong))
        print(lines[-1], flush=True)
    if arguments.markdown:
        arguments.markdown.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{len(wanted) - failed - len(skipped)} passed, {failed} failed, {len(skipped)} skipped")
    for why in skipped:
        print(f"skipped: {why}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
