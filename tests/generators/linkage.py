"""Bodies on passive joints: where the points of a vehicle are, how they move, and its inertia.

Coordinates are x, z of the centre of mass of the whole and the pitch of each body: of the chassis, then of its links. A
point is then the centre of mass and one lever for each body, fixed in it; its velocity has no other terms. Weight acts on
the first two coordinates alone, these are free of the rest, and what remains of the equations of motion (Lagrange's) is a
small block for the pitches: constant for a rigid body, and for a link dependent on how it stands to the chassis.

Parameters are a dict as in rover.py: numbers or arrays over runs.
"""

import numpy as np

from ground import on

REVERSAL = 0.005  # rad/s, over which dry friction of a joint changes its sign
STRIBECK = 0.05  # rad/s


class Linkage:
    """Levers of a vehicle with parameters `p`; arrays end with (body) for a point, with (body, point) for several."""

    def __init__(self, p, vehicle):
        self.p, self.vehicle, links = p, vehicle, vehicle.links
        self.bodies = np.array(vehicle.bodies)
        self.total = vehicle.total_mass(p["mass"])
        centre = [p["centre_x"], p["centre_z"]]
        # The centre of mass of the whole from the reference point: a part fixed in each body.
        parts = [list(centre)]
        for link in links:
            share = link.mass / self.total
            parts[0] = [part + share * (a - c) for part, a, c in zip(parts[0], link.joint, centre)]
            parts.append([share * (b - a) for a, b in zip(link.joint, link.centre)])
        self.reference = [-over_bodies(part[k] for part in parts) for k in (0, 1)]
        self.wheels = self.fixed([(x, 0.0) for x in vehicle.wheels], vehicle.bodies)
        self.masses = [p["mass"]] + [link.mass for link in links]
        self.centres = self.fixed([centre] + [link.centre for link in links], range(len(links) + 1))
        inertias = [p["inertia"]] + [link.inertia for link in links]
        # The speed of a wheel relative to its body is imposed: it pitches with it.
        self.inertias = [own + float(vehicle.bodies.count(k)) * p["wheel_inertia"] for k, own in enumerate(inertias)]
        self.carried = np.array([[float(b == k) for b in vehicle.bodies] for k in range(len(links) + 1)])

    def fixed(self, places, bodies):
        """Points at these places on these bodies, from the reference point: x and z of their parts in each body."""
        parts = []
        for k in (0, 1):
            columns = []
            for place, body in zip(places, bodies):
                joint = self.vehicle.links[body - 1].joint[k] if body else None
                column = [place[k] if body == 0 else joint] + [0.0] * len(self.vehicle.links)
                if body:
                    column[body] = place[k] - joint
                columns.append(over_bodies(column))
            parts.append(np.stack(np.broadcast_arrays(*columns), axis=-1))
        return parts

    def levers(self, pitch, points=None):
        """Levers of points (the wheel centres where none are given): x and z."""
        part_x, part_z = self.wheels if points is None else points
        sin, cos = np.sin(pitch)[..., None], np.cos(pitch)[..., None]
        reference = self.reference_levers(pitch)
        return (
            reference[0][..., None] + (cos * part_x - sin * part_z),
            reference[1][..., None] + (sin * part_x + cos * part_z),
        )

    def reference_levers(self, pitch):
        sin, cos = np.sin(pitch), np.cos(pitch)
        x, z = self.reference
        return cos * x - sin * z, sin * x + cos * z

    def moments(self, pitch, rate):
        """What acts on the pitches besides forces at points: joint friction and what is left of the accelerations of the centres
        of mass while no pitch accelerates."""
        moment = np.zeros(np.broadcast_shapes(pitch.shape, rate.shape))
        for k, link in enumerate(self.vehicle.links, 1):
            turning = rate[..., k] - rate[..., 0]
            friction = link.damping * turning + self.dry_friction(turning)
            moment[..., k] -= friction
            moment[..., 0] += friction
        lever_x, lever_z = self.levers(pitch, self.centres)
        squared = rate**2
        for k, mass in enumerate(self.masses):
            x, z = lever_x[..., k], lever_z[..., k]
            inward_x, inward_z = (np.sum(squared * lever, axis=-1, keepdims=True) for lever in (x, z))
            moment += np.asarray(mass)[..., None] * (x * inward_z - z * inward_x)
        return moment

    def dry_friction(self, turning):
        """Moment of a joint that turns with this rate, N m."""
        sign = turning / np.sqrt(turning * turning + REVERSAL * REVERSAL)
        if (s := on(self.p, "suspension_friction.constant")) is not None:
            return s * sign
        if (s := on(self.p, "suspension_friction.stribeck")) is not None:
            return s * sign * (1.0 + 0.3 * np.exp(-((turning / STRIBECK) ** 2)))
        return 0.0

    def inertia(self, pitch):
        """The block of the mass matrix that belongs to the pitches."""
        lever_x, lever_z = self.levers(pitch, self.centres)
        count = len(self.masses)
        block = np.zeros(lever_x.shape[:-2] + (count, count))
        for k, mass in enumerate(self.masses):
            x, z = lever_x[..., k], lever_z[..., k]
            outer = x[..., :, None] * x[..., None, :] + z[..., :, None] * z[..., None, :]
            block += np.asarray(mass)[..., None, None] * outer
            block[..., k, k] += self.inertias[k]
        return block

    def kinetic_energy(self, u, pitch):
        """J, without what the wheels have from turning relative to their bodies."""
        turning = np.einsum("...i,...ij,...j->...", u[..., 2:], self.inertia(pitch), u[..., 2:])
        return 0.5 * (self.total * (u[..., 0] ** 2 + u[..., 1] ** 2) + turning)


def over_bodies(values):
    """Numbers or arrays over runs, one a body, along a last axis."""
    return np.stack(np.broadcast_arrays(*[np.asarray(v, float) for v in values]), axis=-1)
