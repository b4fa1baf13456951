"""The tasks that are registered with gymnasium, as declarations; :class:`bekker.mechanics.Mechanics` plays them all."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi, radians, tan
from typing import Any

from ._bekker import Ahead
from .errors import InputError
from .goals import Goal, Hold, Open, ReachGently, ReachOnSchedule, ReachWithinSlip, ReachWithinSpeed
from .randomise import Distribution, LogUniform, Uniform
from .rewards import PITCH_RATE, TERMS, Term, terms
from .scales import OBSERVED
from .vocabulary import unknown

__all__ = ["TASKS", "Task", "task_of"]

PERIOD = 0.02
"""Control period, s."""

TARGET = "target_velocity"
"""Speed that a task asks for, drawn and set as if it were a parameter, m/s."""

TERRAIN_SEED = "terrain.seed"
"""Seed of random ground, drawn and set as if it were a parameter."""

ANY_SEED = Uniform(0, 2**32 - 1)


@dataclass(frozen=True)
class Task:
    """What a rover is asked to do, on what ground, and what counts."""

    name: str
    """The part of the id between ``bekker/`` and the version."""
    purpose: str
    """What is to be done and why, in sentences."""
    physics: str
    """Why this vehicle, ground and soil, sentences."""
    success: str
    """When ``info["success"]`` is true, a sentence."""
    goal: Goal
    seconds: float
    """Time limit, s."""
    rewards: tuple[Term, ...]
    model: str = "two_wheeled"
    """Name of a preset."""
    control: str | None = None
    """What the actions command; as the preset says where None."""
    terrain: Mapping[str, Any] | None = None
    """The ground, as in the section ``[terrain]`` of a model file; that of the preset where None."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """Values that replace the preset's."""
    drive: Mapping[str, float] = field(default_factory=dict)
    """Values of the drives besides, where they are not ideal ones, which follow a wheel speed exactly."""
    action_scale: float | None = None
    """What an action of one commands, N m or rad/s; half of the natural scale where None."""
    target_velocity: float = 0.0
    """Speed that the task asks for, m/s; 0 for none."""
    slip_limit: float = 0.3
    observe: tuple[str, ...] = OBSERVED
    ahead: Ahead | None = None
    """The map of the ground ahead that is observed."""
    observation_scales: Mapping[str, float] = field(default_factory=dict)
    """SI values that an observation of 1 stands for, where they differ from the natural scales."""
    randomise: Mapping[str, Distribution] = field(default_factory=dict)
    """What is drawn at every reset."""
    grades: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Values at the levels 0 and 1 of the curriculum, linear between them."""

    @property
    def id(self) -> str:
        """Its id in gymnasium's registry."""
        return f"bekker/{self.name}-v0"

    @property
    def max_episode_steps(self) -> int:
        """The time limit in control periods of the default length."""
        return round(self.seconds / PERIOD)


# Current limits of the amplifiers, beside the supply voltage of the presets. The motor of the vocabulary is of 20 W and 24 V, whose
# windings bear about 1.2 A all the time: 2 A, 4.7 N m at the wheel, for the 10 kg rover, of which a wheel carries 4.9 N m at its rim.
# The rovers of 3 kg a side have as much as the drives of the FSRL rover, 0.706 N m.
_HEAVY = {"motor.inverse_current_limit": 1 / 2.0}
_LIGHT = {"motor.inverse_current_limit": 1 / 0.3}

# The thesis's sand with a shear modulus of 1 cm, as Wong measured on dry sand, instead of 3 cm: with 3 cm this rover needs about 40 % slip on
# level ground, and on every climb it digs itself in.
SAND = {"soil.shear_modulus": 0.01}

# Variations of this sand: half to twice the cohesion, friction angles of loose to dense dry sand.
SANDS: dict[str, Distribution] = {
    "soil.cohesion": LogUniform(500.0, 2000.0),
    "soil.friction_angle": Uniform(radians(27.0), radians(33.0)),
}

_ROLLING = 2.5
_DITCH, _RIM = 1.0, 6 * 0.064 / 2


def _weighted(**weights: float) -> tuple[Term, ...]:
    return terms(weights, weights)


# What the tasks on a plane of sand share.
_ON_A_SLOPE: dict[str, Any] = {
    "seconds": 30.0,
    "control": "speed_loop",
    "rewards": _weighted(progress=1.0, energy=0.1, end=3.0, goal=3.0),
    "terrain": {"preset": "slope", "slope": 0.0},
    "parameters": SAND,
    "drive": _HEAVY,
    "target_velocity": 0.2,
}

TASKS: dict[str, Task] = {
    task.name: task
    for task in (
        Task(
            name="Rover",
            purpose="The general environment: any vehicle, soil, ground, effects, sensors, control and terms of the reward. "
            "By default the reward of the two-wheeled rover grows with distance along x and falls with the energy used.",
            physics="As the arguments say; by default the 10 kg rover of Iagnemma's thesis on its flat sand.",
            success="Never: this environment has no goal.",
            goal=Open(),
            seconds=20.0,
            rewards=tuple(TERMS[name] for name in ("progress", "energy", "end")),
            drive=_HEAVY,
        ),
        Task(
            name="SpeedHold",
            purpose="Hold a speed over rolling sand with the torques of two wheels. A good task to start with: its reward is "
            "dense, events are rare, and there is a velocity controller to compare with.",
            physics="The two-wheeled rover on waves of up to 5 degrees. Sinkage and slip resist the motion, so the torque that a "
            "speed needs changes along each wave and with the soil, which the policy does not observe.",
            success="The mean absolute difference between speed and target, from 3 s after the start on, is at most 10 % of "
            "the target.",
            goal=Hold(share=0.1, after=3.0),
            seconds=20.0,
            rewards=_weighted(relative_speed_error=1.0, energy=0.2, end=20.0),
            terrain={"preset": "waves", "amplitude": 0.0, "wavelength": _ROLLING, "start": -10.0},
            parameters=SAND,
            drive=_HEAVY,
            target_velocity=0.25,
            observe=(TARGET, *OBSERVED),
            randomise={TARGET: Uniform(0.1, 0.4), **SANDS, "terrain.start": Uniform(-10.0 - _ROLLING, -10.0)},
            grades={"terrain.amplitude": (0.0, tan(radians(5.0)) * _ROLLING / (2 * pi))},
        ),
        Task(
            name="SlopeClimb",
            purpose="Climb three metres of a sand slope on schedule: at the mean speed that the episode asks for. The steeper the slope "
            "and the weaker the sand, the more the wheels slip, and the more they have to turn for the same way.",
            physics="The two-wheeled rover on an inclined plane; its drives control the wheel speeds. Uphill the rear wheel "
            "carries more load, so that equal speeds leave traction of the front wheel unused. The policy observes neither the slip nor "
            "the sand; both follow from speeds, torques and the way gained.",
            success="The rover has moved three metres along x, which ends the episode, after 90 to 110 % of the time that the way takes "
            "at the speed asked for.",
            goal=ReachOnSchedule(3.0, early=0.9, late=1.1),
            **_ON_A_SLOPE,
            observe=(TARGET, "goal_distance", "time_left", *OBSERVED),
            randomise={TARGET: Uniform(0.12, 0.3), **SANDS, "terrain.slope": Uniform(radians(2.0), radians(10.0))},
            grades={"terrain.slope": (0.0, radians(6.0))},
        ),
        Task(
            name="BlindSlope",
            purpose="Come three metres up or down a sand slope on schedule without a sensor of the speed over ground. Only knowledge of the "
            "soil, or of former drives on it, tells how much faster the wheels have to turn than they would without slip: a task for "
            "policies that adapt from episode to episode (`bekker.adaptation`) to soils and effects that they are not told "
            "(`bekker.worlds`).",
            physics="The rover, drives and sand of SlopeClimb on slopes from 8 degrees down to 8 degrees up. With a model of the soil the "
            "wheel speed can be computed before the drive; a hidden effect may change it with slope, speed and distance.",
            success="The rover has moved three metres along x, which ends the episode, after 95 to 105 % of the time that the way takes "
            "at the speed asked for.",
            goal=ReachOnSchedule(3.0, early=0.95, late=1.05),
            **_ON_A_SLOPE,
            observe=(TARGET, "time_left", "pitch", "pitch_rate", "wheel.speed", "wheel.torque"),
            randomise={TARGET: Uniform(0.12, 0.25), **SANDS, "terrain.slope": Uniform(radians(-8.0), radians(8.0))},
        ),
        Task(
            name="DitchCrossing",
            purpose="Cross a ditch of loose sand with six wheels, and slowly. Full torque crosses it with a run-up; at a speed at which "
            "cameras and joints are safe, the policy has to distribute the torque among wheels whose loads change throughout the crossing.",
            physics="One side of the FSRL rover of Iagnemma's thesis (appendix C; 4.4.2) in front of a ditch three wheel "
            "diameters wide. The sand in the ditch is loose: it has half the stiffness and a sixth of the cohesion of the sand "
            "around it. The walls are at most 14 degrees steep. The stops of the bogie are at 45 degrees. An action of 1 is the torque limit of the drives, 0.706 N m.",
            success="All wheels are beyond the far rim, 1.6 m along x, which ends the episode, with a speed above 0.3 m/s in at most 10 % of "
            "the steps.",
            goal=ReachWithinSpeed(_DITCH + _RIM + 0.2 + 0.208, speed=0.3, share=0.1),
            seconds=30.0,
            rewards=_weighted(progress=2.0, energy=0.2, end=3.0, goal=3.0),
            model="fsrl_ditch",
            drive=_LIGHT,
            control="torque",
            action_scale=0.706,
            terrain={
                "preset": "ditch",
                "depth": 0.03,
                "width": 2 * _RIM,
                "position": _DITCH,
                "soil": {
                    "x": [_DITCH - _RIM, _DITCH - _RIM / 2, _DITCH + _RIM / 2, _DITCH + _RIM],
                    "k_phi_factor": [1.0, 0.5, 0.5, 1.0],
                    "k_c_factor": [1.0, 0.5, 0.5, 1.0],
                    "cohesion": [1040.0, 180.0, 180.0, 1040.0],
                },
            },
            observe=(*OBSERVED, "link.angle"),
            randomise={"soil.friction_angle": Uniform(radians(28.0), radians(32.0)), "terrain.depth": Uniform(0.02, 0.03)},
            grades={"terrain.depth": (0.01, 0.025)},
        ),
        Task(
            name="EnergyTraverse",
            purpose="Cross random rough ground on schedule, with little energy. A fast drive is in time, and a slow one is thrifty: the "
            "policy has to be as slow as the schedule of the episode allows.",
            physics="One side of a six-wheeled rocker-bogie on dry sand (Wong). Every episode has a new ground with a "
            "spectrum of k^-3, which is smoother than the k^-2 of ISO 8608. Slip, sinkage and the windings dissipate energy, and so do "
            "the gears, whose friction grows with the speed (0.05 N m s/rad, of 0.01 to 0.1 usual): at 0.25 m/s the drive takes 1.5 "
            "times the energy per metre that it takes at 0.1 m/s.",
            success="The rover has moved four metres along x, which ends the episode, within 105 % of the time T that the way takes at the "
            "speed v asked for, with an electrical energy of at most m g 4 m (0.46 + 2.6 s/m v).",
            goal=ReachOnSchedule(4.0, late=1.05, energy=0.46, energy_per_speed=2.6),
            seconds=45.0,
            rewards=_weighted(progress=1.0, energy=1.0, end=3.0, goal=3.0),
            model="rocker_bogie_velocity",
            control="speed_loop",
            terrain={"preset": "random", "roughness": 0.0, "wavelength": 4.0, "exponent": 3.0},
            drive={**_LIGHT, "viscous_friction.coefficient": 0.05},
            target_velocity=0.15,
            observe=(TARGET, "goal_distance", "time_left", *OBSERVED, "link.angle"),
            randomise={TARGET: Uniform(0.1, 0.25), TERRAIN_SEED: ANY_SEED},
            grades={"terrain.roughness": (0.0, 0.02)},
        ),
        Task(
            name="RockTraverse",
            purpose="Cross ground with rocks on schedule, and gently: the chassis carries instruments and a camera. Whoever sees the rocks in "
            "time slows down before them and makes up for it between them; some rocks stop a rover that is slow.",
            physics="One side of a six-wheeled rocker-bogie on dry sand (Wong). Every episode has another ground, and beyond one metre rocks with the "
            "sizes that Golombek and Rapp found on Mars, where rocks of all sizes cover 30 % of the ground. Only those with diameters from 3 to 8 cm "
            "are there, 0.6 per metre on average; the wheels have a diameter of 12 cm. An elevation map shows the ground from 0.3 m behind to "
            "0.8 m before the body's reference point, with noise and missing cells.",
            success="The rover has moved five metres along x, which ends the episode, within the time that the way takes at the speed asked "
            "for, and its chassis pitched faster than 0.15 rad/s for at most 1.5 s altogether.",
            goal=ReachGently(5.0, late=1.0, pitch_rate=PITCH_RATE, seconds=1.5),
            seconds=55.0,
            rewards=_weighted(progress=1.0, fast_pitching=2.0, energy=0.2, end=3.0, goal=3.0),
            model="rocker_bogie_velocity",
            control="speed_loop",
            terrain={"preset": "random", "roughness": 0.01, "wavelength": 4.0, "exponent": 3.0, "rock_coverage": 0.3, "largest_rock": 0.03},
            drive={**_LIGHT, "viscous_friction.coefficient": 0.05},
            target_velocity=0.12,
            observe=(TARGET, "goal_distance", "time_left", *OBSERVED, "link.angle", "height_ahead", "seen_ahead"),
            ahead=Ahead([k / 20 for k in range(-6, 17)], noise=0.002, dropout=0.05),
            observation_scales={"height_ahead": 0.1},
            randomise={TARGET: Uniform(0.1, 0.15), TERRAIN_SEED: ANY_SEED},
            grades={"terrain.largest_rock": (0.03, 0.08)},
        ),
        Task(
            name="SlipLimited",
            purpose="Drive with little slip. Wheels that slip dig in, loosen the soil and falsify the odometry, so every step "
            "of a wheel beyond 30 % slip reduces the reward.",
            physics="The two-wheeled rover with a payload that the policy is not told, on rolling, weak sand (cohesion 200 to 800 Pa), "
            "where slightly more torque than needed makes the wheels slip, and slightly less leaves the rover at rest. No sensor measures "
            "the slip; it follows from wheel speed and velocity.",
            success="The rover has moved three metres along x, which ends the episode, with a wheel beyond 30 % slip in at "
            "most 10 % of the steps.",
            goal=ReachWithinSlip(3.0, 0.1),
            seconds=30.0,
            rewards=_weighted(progress=1.0, slip_excess=10.0, end=3.0, goal=3.0),
            terrain={"preset": "waves", "amplitude": 0.0, "wavelength": _ROLLING, "start": 0.5},
            parameters={**SAND, "soil.cohesion": 400.0},
            drive=_HEAVY,
            randomise={"soil.cohesion": LogUniform(200.0, 800.0), "rover.mass": Uniform(8.0, 12.0)},
            grades={"terrain.amplitude": (0.0, tan(radians(5.0)) * _ROLLING / (2 * pi))},
        ),
    )
}
"""Tasks by name."""


def task_of(task: str | Task) -> Task:
    """A task by its name, ``SpeedHold`` or ``bekker/SpeedHold-v0``, or as it is."""
    if isinstance(task, Task):
        return task
    if not isinstance(task, str):
        raise InputError(f"task: expected a name or a Task, found {type(task).__name__}")
    name = task.removeprefix("bekker/").removesuffix("-v0")
    if name not in TASKS:
        raise unknown("task", task, TASKS)
    return TASKS[name]
