"""The vehicles of a traverse: two wheels on a rigid body, and one side of a six-wheeler on a rocker-bogie.

The first is the model that a comparison takes by itself. The second has as much mass on wheels of the same size over the same
length, so that runs and strengths of effects are the same for both; its joints are those of the model `rocker_bogie_speed`
that is built in. That one's own wheels, of 6 cm by 6 cm, do not climb the slopes of the runs on any soil of soils.py: their
pull at 45 % slip is at most 5 % of the weight.
"""

from dataclasses import dataclass

import numpy as np


# What the model calls the parameters of chassis, wheels and contact, and those of a link.
NAMES = {
    "wheel.radius": "radius",
    "wheel.width": "width",
    "wheel.inertia": "wheel_inertia",
    "rover.mass": "mass",
    "rover.pitch_inertia": "inertia",
    "rover.centre_of_mass_x": "centre_x",
    "rover.centre_of_mass_z": "centre_z",
    "soil.damping": "damping",
}
LINK_FIELDS = ("x", "z", "centre_of_mass_x", "centre_of_mass_z", "mass", "inertia", "damping")


@dataclass(frozen=True)
class Link:
    """A body on a passive joint of the chassis. Places are (x, z) from the chassis' reference point, all bodies level; m."""

    joint: tuple
    centre: tuple
    mass: float  # with the wheels on it
    inertia: float  # about its centre
    damping: float  # N m s, of the joint


@dataclass(frozen=True)
class Vehicle:
    """`parameters` are what may differ from run to run: those of the chassis, its wheels, and the contact's own."""

    parameters: dict
    wheels: tuple  # x of the centres from the reference point at its height, rear to front, m
    bodies: tuple  # that carry the wheels: 0 the chassis, k link k
    links: tuple = ()
    model: str = ""  # built-in model with its joints; none for the one that a comparison takes by itself

    def total_mass(self, chassis):
        """Mass of the whole, for a mass of the chassis."""
        return chassis + sum(link.mass for link in self.links) if self.links else chassis

    def stated(self):
        """What an experiment's file states: the vehicle, where it is not all that of the model."""
        if not self.model:
            return {}
        p = self.parameters
        stated = {name: p[key] for name, key in NAMES.items()}
        for k, x in enumerate(self.wheels, 1):
            stated |= {f"wheel[{k}].x": x, f"wheel[{k}].z": 0.0}
        for k, link in enumerate(self.links, 1):
            values = (*link.joint, *link.centre, link.mass, link.inertia, link.damping)
            stated |= {f"link[{k}].{field}": value for field, value in zip(LINK_FIELDS, values)}
        # The width's part of the modulus is in k_phi (soils.py).
        return {**stated, "soil.k_c": 0.0}


TWO_WHEELED = Vehicle(
    parameters={
        "radius": 0.10,
        "width": 0.15,
        "wheel_inertia": 0.01,
        "mass": 10.0,
        "inertia": 0.6,
        "centre_x": 0.0,
        "centre_z": 0.1,
        "gravity": 9.81,
        "damping": 300.0,
        "hold": 0.0005,
        "gear": 100.0,
        "torque_constant": 0.0234,
        "resistance": 2.32,
    },
    wheels=(-0.35, 0.35),
    bodies=(0, 0),
)

# In a plane the rocker is the chassis: the differential leaves it the mean of both sides.
ROCKER_BOGIE = Vehicle(
    # On level ground the wheels carry 40, 30 and 30 % of the weight.
    parameters={**TWO_WHEELED.parameters, "mass": 8.0, "inertia": 0.3, "centre_x": -0.0875},
    wheels=(-0.35, 0.0, 0.35),
    bodies=(0, 1, 1),
    links=(Link(joint=(0.175, 0.08), centre=(0.175, 0.02), mass=2.0, inertia=0.06, damping=0.1),),
    model="rocker_bogie_speed",
)


def shares(linkage):
    """Share of the weight that each wheel carries on level ground: as many wheels as bodies and one more make it a matter of
    statics. With no moment of the weight in its coordinates (linkage.py) the moments of the wheels cancel for each body."""
    bodies = len(linkage.vehicle.links) + 1
    lever_x, _ = linkage.levers(np.zeros(bodies))
    ones = np.ones(lever_x.shape[:-2] + (1, lever_x.shape[-1]))
    rows = np.concatenate([ones, lever_x], axis=-2)
    alone = np.eye(bodies + 1)[0]
    # Rounded: halves are to be halves on every machine.
    return np.round(np.linalg.solve(rows, np.broadcast_to(alone, rows.shape[:-1])[..., None])[..., 0], 12)
