"""A planar rover with two wheels on a rigid body, driven by imposed wheel speeds: an implicit integrator of its own.

Coordinates are x, z of the centre of mass and the pitch; the mass matrix is then diagonal and constant. Steps are a
two-stage diagonally implicit Runge-Kutta method (Alexander 1977, L-stable, second order) solved by a chord Newton method
over all runs at once. The memory of a standing contact (physics: forces build up over a displacement `hold`) is
integrated along with it in closed form.

Parameters are a dict: numbers or arrays over runs. The wheels are 0 (rear) and 1 (front).
"""

import numpy as np

import contact
import drive
import ground

GAMMA = 1.0 - 1.0 / np.sqrt(2.0)
HOLD_TIME = 0.01  # s, damping of a standing contact
DAMPING_DEPTH = 0.001  # m, over which the normal damping sets in
ITERATIONS = 25
TOLERANCE = 1e-8  # m/s and rad/s
SLOW = 0.1  # of convergence: a step slower than this renews the Jacobian

VEHICLE = {
    "radius": 0.10,
    "width": 0.15,
    "wheel_inertia": 0.01,
    "mass": 10.0,
    "inertia": 0.6,
    "centre_x": 0.0,
    "centre_z": 0.1,
    "rear": -0.35,
    "front": 0.35,
    "gravity": 9.81,
    "damping": 300.0,
    "hold": 0.0005,
    "gear": 100.0,
    "torque_constant": 0.0234,
    "resistance": 2.32,
}


def wheels(value):
    """A per-run value beside (run, wheel) arrays."""
    value = np.asarray(value, float)
    return value if value.ndim == 0 else value[..., None]


def smooth(s):
    s = np.clip(s, 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


class Rover:
    """Equations of motion of many runs on their profile; `p` has numbers or arrays over runs."""

    def __init__(self, p, profile, nodes=contact.NODES):
        self.profile, self.nodes = profile, nodes
        p = self.p = loaded(p)
        self.per_wheel = {name: wheels(value) for name, value in p.items()}
        self.mounts = np.stack([p["rear"], p["front"]], axis=-1)
        ones = np.ones_like(np.asarray(p["mass"], float) + 0.0 * profile.slope)
        self.mass = np.stack([p["mass"] * ones, p["mass"] * ones, (p["inertia"] + 2.0 * p["wheel_inertia"]) * ones], axis=-1)
        self.start = np.zeros_like(ones)  # x of the reference point at the start
        self.tracks = np.full(ones.shape + (2,), np.nan)  # where the tracks of the rear and the front wheel begin

    def geometry(self, q, u):
        """Reference point, wheel centres relative to the centre of mass, and their velocities."""
        sin, cos = np.sin(q[..., 2]), np.cos(q[..., 2])
        c_x, c_z = self.p["centre_x"], self.p["centre_z"]
        reference = np.stack([-(cos * c_x - sin * c_z), -(sin * c_x + cos * c_z)], axis=-1)
        arm_x = reference[..., 0:1] + cos[..., None] * self.mounts
        arm_z = reference[..., 1:2] + sin[..., None] * self.mounts
        v_x = u[..., 0:1] - u[..., 2:3] * arm_z
        v_z = u[..., 1:2] + u[..., 2:3] * arm_x
        return reference, arm_x, arm_z, v_x, v_z

    def touch(self, q, u, hold, command, held):
        """Forces of both wheels. `hold` is the contact's memory; `held` is the time for which it has followed this motion."""
        p = self.per_wheel
        _, arm_x, arm_z, v_x, v_z = self.geometry(q, u)
        foot, distance, cos, sin = self.profile.foot(q[..., 0:1] + arm_x, q[..., 1:2] + arm_z)
        along, up = v_x * cos + v_z * sin, -v_x * sin + v_z * cos
        spin = command - u[..., 2:3]
        rim = p["radius"] * spin
        speed = np.hypot(along, rim)
        memory = follow(hold, along, rim, speed, held, p["hold"])
        scale = 1.0 / (p["hold"] + HOLD_TIME * speed)
        travel = (p["hold"] * memory[0] + HOLD_TIME * along) * scale
        turn = (p["hold"] * memory[1] + HOLD_TIME * rim) * scale
        length = np.minimum(np.hypot(travel, turn), 1.0)
        angle = np.arctan2(sin, cos)
        load = 0.5 * p["mass"] * p["gravity"]
        nominal = contact.slip_of(travel, turn) * length
        passed = np.zeros_like(foot)
        # Forwards the rear wheel follows the front wheel, backwards the other way round.
        passed[..., 0] = smooth(np.nan_to_num((foot[..., 0] - self.tracks[..., 1]) / 0.02 + 0.5))
        passed[..., 1] = smooth(np.nan_to_num((self.tracks[..., 0] - foot[..., 1]) / 0.02 + 0.5))
        place = ground.place_at(nominal, along, p["radius"] - distance, load, angle, foot, passed, nominal[..., ::-1])
        soil = ground.local_soil(p, place)
        if soil["radius"] is not p["radius"]:
            # A true radius other than the nominal one: sinkage and rim follow it; a flexible wheel descends further.
            true = soil.get("true_radius", p["radius"])
            place["sinkage"] = true - distance - soil.get("deflection", 0.0)
            turn = turn * true / p["radius"]
            place["slip"] = contact.slip_of(travel, turn) * length
            soil = ground.local_soil(p, place)
        sinkage = place["sinkage"]
        normal, pull, torque, carried = contact.forces(soil, sinkage, travel, turn / soil["radius"], length, self.nodes)
        normal, pull, torque = carried + length * (normal - carried), length * pull, length * torque
        pull = pull + ground.added_pull(p, place) * np.sign(along) * length
        torque = torque + ground.added_torque(p, np.maximum(normal, 0.0), turn) * length
        normal = np.where(
            sinkage > 0.0, np.maximum(normal - p["damping"] * smooth(sinkage / DAMPING_DEPTH) * up, 0.0), 0.0
        )
        slip = contact.slip_of(along, soil.get("true_radius", p["radius"]) * spin)
        return normal, pull, torque, (arm_x, arm_z, cos, sin), (memory, sinkage, slip, spin)

    def acceleration(self, q, u, hold, command, held):
        p = self.p
        normal, pull, torque, (arm_x, arm_z, cos, sin), _ = self.touch(q, u, hold, command, held)
        f_x, f_z = pull * cos - normal * sin, pull * sin + normal * cos
        reference, *_ = self.geometry(q, u)
        v_reference = u[..., 0] - u[..., 2] * reference[..., 1]
        extra = drive.resistance(p, v_reference, q[..., 0] + reference[..., 0] - self.start)
        force = np.stack(
            [
                f_x.sum(-1) + extra,
                f_z.sum(-1) - p["mass"] * p["gravity"],
                (arm_x * f_z - arm_z * f_x + torque).sum(-1) - extra * reference[..., 1],
            ],
            axis=-1,
        )
        return force / self.mass

    def settle(self, x0):
        """At rest with the reference point above x0, held on a slope by locked wheels (NaN where it cannot stand): unknown are the share of the
        friction that holds, z and the pitch."""
        runs = self.mass.shape[:-1]
        height, slope, _ = self.profile.at(np.full(runs, x0))
        unknown = np.stack([np.zeros(runs), height + self.p["radius"] * 0.95, np.arctan(slope)], axis=-1)
        zero, still = np.zeros(runs + (2,)), np.zeros(runs + (3,))

        def left(y):
            q = np.stack([np.zeros(y.shape[:-1]), np.zeros(y.shape[:-1]), y[..., 2]], axis=-1)
            reference, *_ = self.geometry(q, np.zeros_like(q))
            q = np.stack([x0 - reference[..., 0], y[..., 1] - reference[..., 1], y[..., 2]], axis=-1)
            hold = (np.broadcast_to(-np.clip(y[..., 0:1], -1.0, 1.0), y.shape[:-1] + (2,)), np.zeros(y.shape[:-1] + (2,)))
            return self.acceleration(q, 0.0 * q, hold, zero, 0.0), q, hold

        for _ in range(60):
            residual, q, hold = left(unknown)
            if np.all(np.abs(residual) < 1e-7):
                break
            steps = 1e-6 * np.eye(3)
            slopes = np.stack([(left(unknown + d)[0] - residual) / 1e-6 for d in steps], axis=-1)
            change = (np.linalg.pinv(np.nan_to_num(slopes)) @ np.nan_to_num(residual)[..., None])[..., 0]
            limit = np.abs(change) / np.array([0.5, 0.01, 0.05])
            unknown = unknown - change / np.maximum(np.max(limit, axis=-1, keepdims=True), 1.0)
        q = np.where(np.all(np.abs(residual[..., 1:]) < 1e-3, axis=-1)[..., None], q, np.nan)
        self.start = np.full(runs, float(x0))
        _, arm_x, *_ = self.geometry(q, still)
        self.tracks = q[..., 0:1] + arm_x
        return q, still, hold

    def step(self, q, u, hold, command, dt, slopes):
        """One step of two implicit stages. `slopes` holds the factor of the chord method, renewed where it is slow."""
        span = GAMMA * dt
        _, first_u, first_a = self.stage(q, u, u, hold, command, span, span, slopes)
        base_q = q + (dt - span) * first_u
        base_u = u + (dt - span) * first_a
        q, u, a = self.stage(base_q, base_u, first_u, hold, command, span, dt, slopes)
        *_, (memory, *_) = self.touch(q, u, hold, command, dt)
        return q, u, a, memory

    def stage(self, base_q, base_u, guess, hold, command, h, since, slopes):
        """Solves u = base_u + h a(base_q + h u, u), `since` seconds into the step; gives q, u, a."""

        def residual(v):
            return v - base_u - h * self.acceleration(base_q + h * v, v, hold, command, since)

        v, size = guess, np.inf
        left = residual(v)
        for _ in range(ITERATIONS):
            if slopes.get("span") != h:
                columns = (residual(v + 1e-6 * np.eye(3)[:, None, :]) - left) / 1e-6
                columns = np.where(np.isfinite(columns), columns, np.eye(3)[:, None, :])
                slopes["inverse"], slopes["span"] = np.linalg.inv(np.moveaxis(columns, 0, -1)), h
            change = np.clip(np.einsum("...ij,...j->...i", slopes["inverse"], left), -0.2, 0.2)
            before, (v, left) = np.sum(left**2, axis=-1), (v - change, residual(v - change))
            # A run that got worse (a contact that opens, a slip that changes its sign) goes half the way.
            worse = np.sum(left**2, axis=-1) > 4.0 * before
            if np.any(worse):
                v = np.where(worse[..., None], v + 0.5 * change, v)
                left = residual(v)
            new = np.nanmax(np.abs(change), initial=0.0)
            if new < TOLERANCE:
                break
            if new > SLOW * size or np.any(worse):
                slopes.pop("span")
            size = new
        return base_q + h * v, v, (v - base_u) / h


def follow(hold, along, rim, speed, span, distance):
    """The contact's memory after `span` seconds of this motion: h' = (v - h |v|)/d with v held, in closed form."""
    way = span * speed / distance
    left = np.exp(-way)
    gain = span / distance * np.where(way > 1e-6, -np.expm1(-way) / np.maximum(way, 1e-6), 1.0)
    return left * hold[0] + gain * along, left * hold[1] + gain * rim


def loaded(p):
    """Effects on mass and its place: payload, shifted centre of mass."""
    p = dict(p)
    if (s := ground.on(p, "payload.mass")) is not None:
        p["mass"] = p["mass"] + s
    if (s := ground.on(p, "payload.deck")) is not None:  # strapped on the deck 10 cm above the centre of mass
        total = p["mass"] + s
        p["inertia"] = p["inertia"] + p["mass"] * s / total * 0.1**2
        p["centre_z"] = p["centre_z"] + 0.1 * s / total
        p["mass"] = total
    if (s := ground.on(p, "centre_of_mass.along")) is not None:
        p["centre_x"] = p["centre_x"] + s
    if (s := ground.on(p, "centre_of_mass.both")) is not None:  # shifted along and up
        p["centre_x"], p["centre_z"] = p["centre_x"] + s, p["centre_z"] + 0.5 * np.abs(s)
    return p
