"""FMUs and systems in other co-simulation masters, each in a process of its own.

``python masters.py MASTER PATH`` with a JSON object on its input: ``step`` (s), ``count`` (steps), ``set`` (values by name,
in a system ``component.name``), ``get`` (names). It prints the values at the end, as hexadecimal floats, on its last line.
"""

import ctypes
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

MASTERS = {"ecos": "ecospy", "libcosim": "libcosimpy"}
# The name of an FMU that is alone in its simulation.
ALONE = "alone"


def run(master: str, path: str, step: float, count: int, values: dict[str, float], names: list[str]) -> list[float]:
    """The values of ``names`` after ``count`` steps of an FMU or a system in a master."""
    order = json.dumps({"step": step, "count": count, "set": values, "get": names})
    command = [sys.executable, __file__, master, path]
    done = subprocess.run(command, input=order, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return [float.fromhex(value) for value in json.loads(done.stdout.splitlines()[-1])]


def installed(master: str) -> bool:
    return importlib.util.find_spec(MASTERS[master]) is not None


def split(name: str, system: bool) -> tuple[str, str]:
    if not system:
        return ALONE, name
    component, _, variable = name.partition(".")
    return component, variable


def ecos(path: str, order: dict[str, Any]) -> list[float]:
    # The library of the wheel needs oneTBB, which the wheel `tbb` has where no loader looks.
    tbb = Path(sys.prefix) / "lib" / "libtbb.so.12"
    if tbb.exists():
        ctypes.CDLL(str(tbb), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    system = path.endswith(".ssp")
    if system:
        simulation = EcosSimulation(ssp_path=path, step_size=order["step"])
    else:
        structure = EcosSimulationStructure()
        structure.add_model(ALONE, path)
        start = {f"{ALONE}::{name}": float(value) for name, value in order["set"].items()}
        structure.add_parameter_set("start", start)
        simulation = EcosSimulation(structure=structure, step_size=order["step"])
    assert simulation.init(parameter_set="soil" if system else "start")
    if system:
        for name, value in order["set"].items():
            simulation.set_real("::".join(split(name, system)), value)
    simulation.step(order["count"])
    values = [simulation.get_real("::".join(split(name, system))) for name in order["get"]]
    simulation.terminate()
    simulation.free()
    return values


def libcosim(path: str, order: dict[str, Any]) -> list[float]:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    system = path.endswith(".ssp")
    with tempfile.TemporaryDirectory() as folder:
        if system:
            zipfile.ZipFile(path).extractall(folder)
            # Without a step: the package says which.
            execution = CosimExecution.from_ssp_file(folder)
        else:
            execution = CosimExecution.from_step_size(round(order["step"] * 1e9))
            execution.add_local_slave(CosimLocalSlave(fmu_path=path, instance_name=ALONE))
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer)

        def place(name: str) -> tuple[int, int]:
            slave, variable = split(name, system)
            index = execution.slave_index_from_instance_name(slave)
            known = {text(each.name): each.reference for each in execution.slave_variables(index)}
            return index, known[variable]

        for name, value in order["set"].items():
            execution.real_initial_value(*place(name), value)
        assert execution.step(order["count"])
        places = [place(name) for name in order["get"]]
        return [observer.last_real_values(index, [reference])[0] for index, reference in places]


def text(name: str | bytes) -> str:
    return name.decode() if isinstance(name, bytes) else name


if __name__ == "__main__":
    found = {"ecos": ecos, "libcosim": libcosim}[sys.argv[1]](sys.argv[2], json.load(sys.stdin))
    sys.stdout.flush()
    os.write(1, (json.dumps([value.hex() for value in found]) + "\n").encode())
