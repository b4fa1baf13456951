"""FMUs and systems in other co-simulation masters, each in a process of its own.

``python masters.py MASTER PATH`` with a JSON object on its input: ``step`` (s), ``count`` (steps), ``set`` (values by name,
in a system ``component.name``), ``get`` (names). It prints the values at the end, as hexadecimal floats, on its last line.
"""

import ctypes
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
    assert simulation.init(parameter_set=order.get("set_name") if system else "start")
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
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    system, nanoseconds = path.endswith(".ssp"), round(order["step"] * 1e9)
    with tempfile.TemporaryDirectory() as folder:
        if system:
            zipfile.ZipFile(path).extractall(folder)
            # Without a step: the package says which.
            execution = CosimExecution.from_ssp_file(folder)
        else:
            execution = CosimExecution.from_step_size(nanoseconds)
            execution.add_local_slave(CosimLocalSlave(fmu_path=path, instance_name=ALONE))
        observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
        execution.add_observer(observer)
        execution.add_manipulator(manipulator)
        text = lambda name: name.decode() if isinstance(name, bytes) else name  # noqa: E731
        slaves = {name: execution.slave_index_from_instance_name(name) for name in {split(n, system)[0] for n in order["get"]}}
        slaves |= {split(n, system)[0]: execution.slave_index_from_instance_name(split(n, system)[0]) for n in order["set"]}
        references = {
            name: {text(v.name): v.reference for v in execution.slave_variables(index)} for name, index in slaves.items()
        }
        for name, value in order["set"].items():
            slave, variable = split(name, system)
            execution.real_initial_value(slaves[slave], references[slave][variable], value)
            if variable in ("velocity_command",) or variable.endswith("_command"):
                manipulator.slave_real_values(slaves[slave], [references[slave][variable]], [value])
        assert execution.step(order["count"])
        values = []
        for name in order["get"]:
            slave, variable = split(name, system)
            values += observer.last_real_values(slaves[slave], [references[slave][variable]])
        return values


if __name__ == "__main__":
    found = {"ecos": ecos, "libcosim": libcosim}[sys.argv[1]](sys.argv[2], json.load(sys.stdin))
    sys.stdout.flush()
    os.write(1, (json.dumps([value.hex() for value in found]) + "\n").encode())
