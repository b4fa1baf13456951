#!/usr/bin/env python3
"""The study of diagnoses on hidden effects: makes experiments, has them diagnosed, scores what was said.

    python3 tests/study/study.py --bekker target/release/bekker --set development --seeds 50 --out FOLDER

Thresholds are chosen on `--set development` (the library's forms, seeds from 1000), frozen, and reported once on
`--set report` (other forms of the literature, seeds from 50000). Every experiment adds one row to FOLDER/rows.csv as soon as it
is diagnosed; what has a row there is not made again, so that the study goes on where it stopped, also on another machine with
the rows that are committed. `--quick` is the small fixed part for CI; it fails where a case is wrong. Needs numpy only.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import plan  # noqa: E402
import score  # noqa: E402
import table  # noqa: E402

import cases  # noqa: E402  (plan puts the generators on the path)
import alike  # noqa: E402
import attainable  # noqa: E402
import hidden  # noqa: E402
from detect import Detector  # noqa: E402

LONGEST = 3600.0  # s, of one diagnosis


def searched(bench_jobs):
    """{noise: detector} of a bench, and {name of a job: its hidden effects}: their strengths are searched for side by side, which takes a
    fraction of the time. ValueError or RuntimeError where the bench does not run."""
    hiding = [job for job in bench_jobs if job.case != "clean" and job.case not in cases.CAUTION]
    detectors, known = {}, {}
    for level in dict.fromkeys(job.noise for job in hiding):
        jobs = [job for job in hiding if job.noise == level]
        if not detectors:
            one = jobs[0]
            bench = hidden.make_bench(one.kind, one.seed, one.size, False, one.conditions)
            replicates = hidden.REPLICATES if one.kind == cases.WHEEL else bench.replicates
            first = Detector(bench, level, replicates, cases.library(one.kind, bench.jointed))
        detectors[level] = first.with_noise(level)
        found = hidden.chosen_side_by_side(detectors[level], [(job.kind, job.case, job.form or None, job.seed) for job in jobs])
        known |= {job.name: one for job, one in zip(jobs, found)}
    return detectors, known


def make(job, folder, detectors, known):
    """Writes the experiment of a job; the detector of a bench serves all its cases."""
    detector = detectors.get(job.noise) if job.name in known else None
    form, under = job.form or None, job.conditions
    return hidden.make(
        folder, job.kind, job.case, form, job.noise, job.seed, size=job.size, detector=detector, under=under, known=known.get(job.name)
    )


def diagnose(bekker, extra, folder, threads):
    """The diagnosis as a dict; {"error": ..} where there is none."""
    output = folder / "diagnosis.json"
    environment = os.environ | {"RAYON_NUM_THREADS": str(threads)}
    command = [bekker, "diagnose", str(folder), "--json", str(output), *extra]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST, env=environment)
    except subprocess.TimeoutExpired:
        return {"error": f"longer than {LONGEST:.0f} s"}
    if done.returncode != 0 or not output.exists():
        return {"error": (done.stderr or done.stdout).strip()[-500:] or f"exit code {done.returncode}"}
    return json.loads(output.read_text(encoding="utf-8"))


def attained(job, folder, truth, result):
    """Share of the removable left-out error that the true effect in its true form removes; None where that is not asked."""
    effects = truth["effects"]
    if job.case in cases.CAUTION or job.kind != cases.WHEEL or len(effects) != 1 or effects[0]["outside"] or not effects[0]["visible"] or "error" in result:
        return None
    form = cases.find(job.kind, effects[0]["case"], effects[0]["form"])
    bench = hidden.make_bench(job.kind, job.seed, job.size, False)
    deviation = [truth["deviation"][name] for name in bench.signals]
    left = attainable.heldout_rmse(folder, bench, [form], {form.key: effects[0]["strength"]}, deviation, hidden.REPLICATES)
    return None if left is None else score.removed_share(truth, result, left)


def run_bench(bench_jobs, arguments):
    """All jobs of one bench, one after the other; writes one row a job."""
    began = time.perf_counter()
    try:
        detectors, known = searched(bench_jobs)
    except (ValueError, RuntimeError) as error:
        print(f"seed {bench_jobs[0].seed}: not made: {error}", flush=True)
        return len(bench_jobs)
    searching = (time.perf_counter() - began) / len(bench_jobs)
    for job in bench_jobs:
        folder = arguments.scratch / job.name
        started = time.perf_counter()
        try:
            truth = make(job, folder, detectors, known)
        except (ValueError, RuntimeError) as error:
            print(f"{job.name}: not made: {error}", flush=True)
            continue
        made = time.perf_counter()
        result = diagnose(arguments.bekker, arguments.extra, folder, arguments.threads)
        spent = round(time.perf_counter() - made, 3)
        said = [] if job.case in cases.CAUTION else alike.beside(truth["effects"], result)
        alike.judge(detectors.get(job.noise), job.kind, truth["effects"], said)
        record = {"name": job.name, "job": asdict(job), "truth": truth, "result": result}
        record |= {"seconds": spent, "seconds_made": round(made - started + searching, 3)}
        record["attainable"] = attained(job, folder, truth, result)
        table.append_row(arguments.out / "rows.csv", table.row_of(record))
        if arguments.keep:
            (folder / "record.json").write_text(json.dumps(record, indent=1), encoding="utf-8")
        else:
            shutil.rmtree(folder)
    return len(bench_jobs)


def run(jobs, arguments):
    arguments.out.mkdir(parents=True, exist_ok=True)
    done = {row["name"] for row in table.read_rows(arguments.out / "rows.csv")}
    left = [job for job in jobs if job.name not in done]
    benches = {}
    for job in left:
        benches.setdefault((job.kind, job.size, job.seed), []).append(job)
    print(f"{len(jobs)} experiments, {len(jobs) - len(left)} of them done before", flush=True)
    started, finished = time.perf_counter(), 0
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for future in as_completed([pool.submit(run_bench, some, arguments) for some in benches.values()]):
            finished += future.result()
            spent = time.perf_counter() - started
            print(f"{finished}/{len(left)}, {spent / 60:.1f} min, about {spent / finished * (len(left) - finished) / 60:.0f} left", flush=True)


def report(jobs, arguments):
    wanted = {job.name for job in jobs}
    rows = [row for row in table.read_rows(arguments.out / "rows.csv") if row["name"] in wanted]
    title = "Quick study" if arguments.quick else f"Study of diagnoses, set `{arguments.set}`"
    (arguments.out / "study.md").write_text(table.markdown(rows, title), encoding="utf-8")
    print("\n".join(table.summary(rows)))
    print(f"wrote {arguments.out / 'study.md'}")
    return rows


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bekker", default="bekker", help="the program to test")
    parser.add_argument("--set", choices=tuple(plan.FIRST_SEED), default="development")
    parser.add_argument("--kind", choices=(cases.WHEEL, cases.ROVER, "both"), default=cases.WHEEL)
    parser.add_argument("--size", choices=("full", "reduced"), default="reduced", help="of a traverse experiment")
    parser.add_argument("--conditions", action="store_true", help="traverses under the conditions that each seed draws")
    parser.add_argument("--cases", help="only these, separated by commas")
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--noise", type=float, nargs="+", default=[0.02, 0.05])
    parser.add_argument("--jobs", type=int, default=2, help="experiments at a time")
    parser.add_argument("--threads", type=int, default=1, help="threads of one diagnosis")
    parser.add_argument("--out", type=Path, default=Path("study-results"))
    parser.add_argument("--scratch", type=Path, help="for the experiments; default: OUT/experiments")
    parser.add_argument("--first-seed", type=int, help="default: that of the set")
    parser.add_argument("--keep", action="store_true", help="keep the experiments and what was said of them")
    parser.add_argument("--report-only", action="store_true", help="score what is there")
    parser.add_argument("--quick", action="store_true", help="the fixed part for CI")
    parser.add_argument("extra", nargs="*", help="after --: further arguments of `bekker diagnose`")
    arguments = parser.parse_args()
    arguments.scratch = arguments.scratch or arguments.out / "experiments"
    return arguments


def main():
    arguments = parse()
    if arguments.quick:
        jobs = plan.quick()
        # Always made anew: it is a test.
        (arguments.out / "rows.csv").unlink(missing_ok=True)
    else:
        kinds = (cases.WHEEL, cases.ROVER) if arguments.kind == "both" else (arguments.kind,)
        wanted = arguments.cases.split(",") if arguments.cases else None
        first, drawn = arguments.first_seed, arguments.conditions
        jobs = plan.jobs(arguments.set, kinds, arguments.size, wanted, arguments.noise, arguments.seeds, first, drawn)
    if not arguments.report_only:
        run(jobs, arguments)
    rows = report(jobs, arguments)
    if arguments.quick:
        failed = [r for r in rows if r["outcome"] not in table.GOOD]
        for r in failed:
            print(f"{r['name']}: {r['outcome']}: {r['verdict']} {r['said']} {r['tied']} {r['error']}")
        sys.exit(1 if failed or len(rows) < len(jobs) else 0)


if __name__ == "__main__":
    main()
