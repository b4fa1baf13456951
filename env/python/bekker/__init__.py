"""Rough-terrain rovers on deformable soil, from physics to insight.

A *model* is a rover on its ground, its sensors and its control. Start from a built-in one (:func:`presets`) or a TOML
file; every number in it has a name, a unit, bounds and a source::

    >>> import bekker
    >>> model = bekker.Model.from_preset("gentle_velocity")
    >>> model.set("soil.cohesion", 800.0)                       # Pa
    >>> model.parameters()[0]["name"], model.parameters()[0]["unit"]
    ('gravity', 'm/s2')

*Drive it* and look at any signal as a numpy array, in SI units::

    >>> drive = bekker.simulate(model, duration=5.0, inputs={"velocity_command": 0.2}, period=0.02)
    >>> drive.status, drive.units["wheel[1].torque"], drive["velocity"].shape
    ('running', 'N.m', (251,))

*Add missing physics*: every model carries the library of :func:`effects`, each neutral until a parameter says
otherwise::

    >>> sinking = bekker.simulate(model, duration=5.0, parameters={"slip_sinkage.n1": 0.4})
    >>> bool(sinking["wheel[1].sinkage"].max() > drive["wheel[1].sinkage"].max())
    True

*Learn in it*: importing the package registers :data:`TASKS` with gymnasium, the same physics to the last bit, one by one or
many together (:class:`RoverEnv`, :class:`RoverVectorEnv`)::

    >>> import gymnasium
    >>> env = gymnasium.make("bekker/Rover-v0", model="two_wheeled")
    >>> observation, info = env.reset(seed=0)
    >>> observation, reward, terminated, truncated, info = env.step([0.4, 0.4])
    >>> env.close()

*Compare it* with measurements, an experiment folder with CSV files in the model's own names::

    comparison = bekker.compare("examples/sand_wheel", calibrate=True)
    print(comparison)                          # what is left of each signal, and where the model fails

*Find out what it lacks*: which physical effect is missing, the error with and without it, and the improved model::

    diagnosis = bekker.diagnose("examples/sand_wheel", progress=print)
    print(diagnosis)                           # verdict, the error falling step by step, probabilities, cautions
    diagnosis.plot_overlay()                   # and plot_residuals, plot_steps, plot_candidates ... (matplotlib)
    diagnosis.save_model("improved.toml")      # bekker.steady_points(diagnosis.improved, 20.0, 0.2, 0.5) takes it as it is

*Look at it all by hand*: ``bekker.studio("examples/sand_wheel")`` shows the workbench in a notebook's cell, and its ``open()``
in a browser.

Data that are not on disk come as :class:`Experiment`, from data frames or arrays; :func:`import_experiment` proposes a
folder for CSV files in columns and units of their own.

*Ask where it can go*: the pose on a map at a place, and a path on which it is safe at every point::

    >>> plan = bekker.plan("benign:3", start=(2.0, 2.0), goal=(3.0, 3.0), robot="fsrl")
    >>> plan.path.shape[1], bool(plan.stability.min() > 0.17)         # rad
    (2, True)

*Take it elsewhere*: ``bekker.export_fmu(model, "rover.fmu")`` writes it for any tool that knows FMI 3.0.

*Step it yourself*: ``model.start()`` gives a :class:`Run`, whose copies go on to the same bits. What is refused is a
:class:`~bekker.errors.BekkerError` that names the thing and what was expected.
"""

from . import adaptation, baselines, costs, goals, learners, oracles, randomise, rewards, worlds
from ._bekker import Ahead, Batch, CheckReport, Model, Run, Script, __version__
from .arguments import Arguments
from .checks import check
from .comparison import Comparison, calibrate, compare
from .diagnosis import Diagnosis, Progress, diagnose
from .env import RoverEnv
from .errors import (
    BekkerError,
    DiagnosisInterrupted,
    InputError,
    ModelError,
    PlanningError,
    SimulationError,
    UnknownNameError,
)
from .experiment import Experiment, MeasuredRun
from .importing import Imported, import_experiment
from .models import effects, export_fmu, presets
from .planning import Plan, Pose, plan, planning_settings, pose, robots
from .registration import register
from .simulation import Result, simulate, steady_points
from .soil import Soil
from .tasks import TASKS, Task
from .vector_env import RoverVectorEnv
from .workbench import Studio, studio

__all__ = [
    "Ahead",
    "Arguments",
    "Batch",
    "BekkerError",
    "CheckReport",
    "Comparison",
    "Diagnosis",
    "DiagnosisInterrupted",
    "Experiment",
    "Imported",
    "InputError",
    "MeasuredRun",
    "Model",
    "ModelError",
    "Plan",
    "PlanningError",
    "Pose",
    "Progress",
    "Result",
    "RoverEnv",
    "RoverVectorEnv",
    "Run",
    "Script",
    "Soil",
    "SimulationError",
    "Studio",
    "TASKS",
    "Task",
    "UnknownNameError",
    "__version__",
    "adaptation",
    "baselines",
    "calibrate",
    "check",
    "compare",
    "diagnose",
    "effects",
    "export_fmu",
    "costs",
    "goals",
    "import_experiment",
    "learners",
    "oracles",
    "plan",
    "planning_settings",
    "pose",
    "presets",
    "randomise",
    "rewards",
    "robots",
    "simulate",
    "steady_points",
    "studio",
    "worlds",
]

register()
