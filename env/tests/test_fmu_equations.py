"""FMUs as differential equations: directional derivatives and model exchange.

See `fmus.py` for BEKKER_CLI.
"""

import ctypes
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmus import DRIVING, VERSIONS, Make, make  # noqa: F401


def torques(level: float, stop: float) -> np.ndarray:
    names = ["time", "wheel[1].torque_command", "wheel[2].torque_command"]
    rows = [(0.0, level, level), (stop, level, level)]
    return np.array(rows, dtype=[(name, float) for name in names])


def test_agreement_of_directional_derivatives_with_differences(make: Make, tmp_path: Path) -> None:
    """The derivatives of the states by the states: the model's against central differences through the border."""
    fmu = make("two_wheeled", 2, "rover")
    description = fmpy.read_model_description(fmu)
    if description.modelExchange is None or not description.modelExchange.providesDirectionalDerivative:
        pytest.skip("this model has no directional derivatives in model exchange")
    folder = fmpy.extract(fmu, unzipdir=str(tmp_path))
    identifier = description.modelExchange.modelIdentifier
    model = FMU2Model(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="rover")
    model.instantiate()
    model.setupExperiment()
    references = {v.name: v.valueReference for v in description.modelVariables}
    torque = [references[f"wheel[{k}].torque_command"] for k in (1, 2)]
    model.setReal(torque, [DRIVING, DRIVING])
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    states = [d.variable.derivative.valueReference for d in description.derivatives]
    rates = [d.variable.valueReference for d in description.derivatives]
    x = np.array(model.getReal(states))

    def slopes(at: np.ndarray) -> np.ndarray:
        values = np.ascontiguousarray(at)
        pointer = values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        model.setContinuousStates(pointer, len(values))
        return np.array(model.getReal(rates))

    # Away from rest, where slip has no derivative: 0.3 s by Euler's method.
    for _ in range(3000):
        x = x + 1e-4 * slopes(x)
    worst = 0.0
    for k, state in enumerate(states):
        # Steps in proportion to the state, for truncation and rounding of the same size in double precision.
        h = 1e-6 * max(abs(x[k]), 1e-2)
        step = np.zeros(len(x))
        step[k] = h
        differences = (slopes(x + step) - slopes(x - step)) / (2.0 * h)
        slopes(x)
        exact = np.array(model.getDirectionalDerivative(rates, [state], [1.0]))
        scale = np.abs(exact).max()
        assert np.isfinite(exact).all()
        if scale > 0.0:
            worst = max(worst, float(np.abs(exact - differences).max() / scale))
    model.freeInstance()
    # Central differences with these steps have seven digits at best, in stiff directions fewer.
    assert worst < 1e-4, worst


@pytest.mark.parametrize("fmi", VERSIONS)
def test_agreement_of_model_exchange_with_cosimulation(make: Make, fmi: int) -> None:
    fmu = make("two_wheeled", fmi, "rover")
    if fmpy.read_model_description(fmu).modelExchange is None:
        pytest.skip("this model is no system of differential equations")

    def simulate(kind: str, **options: Any) -> np.ndarray:
        return fmpy.simulate_fmu(
            fmu,
            stop_time=1.0,
            output_interval=0.02,
            input=torques(DRIVING, 1.0),
            output=["x", "velocity", "pitch", "wheel[1].slip"],
            fmi_type=kind,
            **options,
        )

    steps = simulate("CoSimulation")
    solver = simulate("ModelExchange", solver="CVode", relative_tolerance=1e-7)
    at = np.interp(steps["time"], solver["time"], solver["x"])
    # The integrator inside has a fixed step of 2 ms and is of first order in the stiff parts.
    assert np.abs(at - steps["x"]).max() < 0.01 * steps["x"][-1]
