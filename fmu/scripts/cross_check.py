"""Files by which tools compare their results with ours, in the style of the FMI cross-check.

``python cross_check.py ROVER.fmu FOLDER`` writes ``NAME.fmu``, ``NAME_in.csv`` (inputs over time), ``NAME_ref.csv``
(what FMPy computes with them) and ``NAME_ref.opt`` (start, stop, step and relative tolerance); :func:`rerun` reads them
back and drives any FMU with them.
"""

import shutil
import sys
from pathlib import Path

import fmpy
import numpy as np
from fmpy.util import read_csv, write_csv
from numpy.typing import NDArray

# Communication step and length, s; rows of a result stay under the megabyte that the cross-check allows.
STEP = 0.01
STOP = 5.0
# Outputs that every rover has.
OUTPUTS = ["x", "z", "pitch", "velocity", "wheel[1].slip", "wheel[1].sinkage", "wheel[2].slip"]
# Share of its upper bound, where it is small, at which an input is held; commands of other sizes are given by unit.
LEVELS = {"N.m": 2.0, "rad/s": 1.5, "m/s": 0.2, "rad": 0.0, "1": 0.0}


def inputs(fmu: str) -> NDArray[np.void]:
    """A command that rises for a second, is held, and changes once."""
    description = fmpy.read_model_description(fmu)
    columns = [v for v in description.modelVariables if v.causality == "input"]
    times = [0.0, 1.0, 3.0, 3.0, STOP]
    shares = [0.0, 1.0, 1.0, 0.7, 0.7]
    rows = [(t, *(s * LEVELS[v.unit or "1"] for v in columns)) for t, s in zip(times, shares)]
    return np.array(rows, dtype=[(name, float) for name in ["time", *(v.name for v in columns)]])


def outputs(fmu: str) -> list[str]:
    """Those of the usual outputs that the FMU has."""
    names = {v.name for v in fmpy.read_model_description(fmu).modelVariables}
    return [name for name in OUTPUTS if name in names]


def write(fmu: str, folder: Path) -> Path:
    """Writes the four files; the result is their path without the endings."""
    folder.mkdir(parents=True, exist_ok=True)
    base = folder / Path(fmu).stem
    if Path(fmu).resolve() != base.with_suffix(".fmu").resolve():
        shutil.copy(fmu, base.with_suffix(".fmu"))
    signals = inputs(fmu)
    write_csv(f"{base}_in.csv", signals)
    options = {"StartTime": 0.0, "StopTime": STOP, "StepSize": STEP, "RelTol": 0.0}
    Path(f"{base}_ref.opt").write_text("".join(f"{key},{value}\n" for key, value in options.items()))
    write_csv(f"{base}_ref.csv", rerun(base, fmu))
    return base


def rerun(base: Path, fmu: str) -> NDArray[np.void]:
    """What ``fmu`` computes with the inputs and options of ``base``."""
    lines = Path(f"{base}_ref.opt").read_text().splitlines()
    options = {key: float(value) for key, value in (line.split(",") for line in lines)}
    return fmpy.simulate_fmu(
        fmu,
        start_time=options["StartTime"],
        stop_time=options["StopTime"],
        output_interval=options["StepSize"],
        step_size=options["StepSize"],
        input=read_csv(f"{base}_in.csv"),
        output=outputs(fmu),
        fmi_type="CoSimulation",
    )


if __name__ == "__main__":
    print(write(sys.argv[1], Path(sys.argv[2])))
