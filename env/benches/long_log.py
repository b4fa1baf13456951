"""How long the diagnosis of long drives takes, and how that grows with their length: four drives of 2.5, 5 and 10 minutes.

    python env/benches/long_log.py [--minutes 10] [--save FOLDER]

The drives are made by the model itself, with a drag of 3 N that the given model does not have: two wheels with speeds that change all the time,
over hills of 4 cm, 10 Hz, 2 % noise, which is stated. `bekker.diagnose` runs on all cores, with its defaults: 64 windows of six
seconds take part in the fits. Times are wall-clock. Needs numpy.
"""

import argparse
import time

import bekker
import numpy as np

RATE = 10.0  # rows a second
HIDDEN = {"drag.force": 3.0}
MEASURED = ("x", "pitch", "velocity", "wheel[1].torque", "wheel[2].torque", "wheel[1].sinkage", "wheel[2].sinkage")
NOISE = 0.02  # of the RMS of a signal
SPACING = 0.05  # m, between points of the ground


def ground(run, way):
    """Hills 4 cm high, longer and longer from run to run."""
    x = np.arange(-2.0, way, SPACING)
    return x, 0.02 * (1.0 - np.cos(2.0 * np.pi * np.maximum(x, 0.0) / (2.0 + 0.5 * run)))


def drive(run, minutes):
    """Columns of one drive without noise, and its ground."""
    rows = round(60.0 * minutes * RATE)
    at = np.arange(rows) / RATE
    speed = 2.2 + 0.6 * np.sin(0.21 * at + run) + 0.3 * np.sin(0.53 * at)
    commands = {"wheel[1].speed_command": 0.95 * speed, "wheel[2].speed_command": speed}
    model = bekker.Model.from_preset("two_wheeled_speed")
    points = ground(run, 0.5 * 60.0 * minutes + 5.0)
    model.set_terrain(_json(points))
    result = bekker.simulate(model, rows / RATE, commands, 1.0 / RATE, HIDDEN)
    if result.status != "running":
        raise SystemExit(f"drive {run} ended: {result.event}")
    signals = {name: result[name][:-1] for name in MEASURED}
    return {"time": at, **commands, **signals}, points


def _json(points):
    x, z = (", ".join(map(str, map(float, values))) for values in points)
    return f'{{"x": [{x}], "z": [{z}]}}'


def log(minutes):
    """The experiment: four drives with noise."""
    drives = [drive(run, minutes) for run in range(4)]
    noise = {name: NOISE * float(np.sqrt(np.mean([np.mean(d[name] ** 2) for d, _ in drives]))) for name in MEASURED}
    noise["x"] = 0.01
    random = np.random.default_rng(17)
    runs = [
        bekker.MeasuredRun(
            {name: values + noise.get(name, 0.0) * random.standard_normal(len(values)) for name, values in columns.items()},
            name=f"drive {k + 1}",
            terrain=points,
        )
        for k, (columns, points) in enumerate(drives)
    ]
    return bekker.Experiment("traverse", runs, name=f"four drives of {minutes:g} min", noise=noise, model="two_wheeled_speed")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, nargs="+", default=[2.5, 5.0, 10.0])
    parser.add_argument("--save", help="write the experiments here in place of diagnosing them")
    asked = parser.parse_args()
    if not asked.save:
        print(f"{'four drives of':<16}{'s':>8}  verdict")
    for minutes in asked.minutes:
        experiment = log(minutes)
        if asked.save:
            experiment.save(f"{asked.save}/minutes_{minutes:g}")
            continue
        clock = time.perf_counter()
        found = bekker.diagnose(experiment)
        print(f"{minutes:>8g} min    {time.perf_counter() - clock:>8.1f}  {found.verdict}: {', '.join(found.effects)}", flush=True)


if __name__ == "__main__":
    main()
