"""A planar rover on a rigid body or a linkage, driven by imposed wheel speeds: an implicit integrator of its own.

Coordinates are x, z of the centre of mass and the pitch of each body (linkage.py); the mass matrix of a rigid body is then
diagonal and constant. Steps are a two-stage diagonally implicit Runge-Kutta method (Alexander 1977, L-stable, second order)
solved by a chord Newton method over all runs at once. The memory of a standing contact (physics: forces build up over a
displacement `hold`) is integrated along with it in closed form.

Parameters are a dict: numbers or arrays over runs. The wheels are numbered from 0 at the rear.
"""

import numpy as np

import contact
import drive
import ground
import vehicles
from linkage import Linkage

GAMMA = 1.0 - 1.0 / np.sqrt(2.0)
HOLD_TIME = 0.01  # s, damping of a standing contact
DAMPING_DEPTH = 0.001  # m, over which the normal damping sets in
PASSED = 0.05  # m, over which ground turns from fresh to passed: about the length of a contact
ITERATIONS = 25
HALVINGS = 3  # of a step
GIVEN_UP = 30  # smallest steps without a solution, after which a run counts as stuck
TOLERANCE = 1e-8  # m/s and rad/s
STANDS, STAND_STEPS = 1e-9, 30  # relative change of a sinkage below which a flexible wheel stands, and steps until then
LEAST_SINKAGE = 0.02  # share of that of the undeformed wheel within which it is looked for
SLOW = 0.1  # of convergence: a step slower than this renews the Jacobian
ALONE = 0.25  # share of the runs: where no more are unsolved, these go on without the others


def wheels(value):
    """A per-run value beside (run, wheel) arrays."""
    value = np.asarray(value, float)
    return value if value.ndim == 0 else value[..., None]


def smooth(s):
    s = np.clip(s, 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


class Rover:
    """Equations of motion of many runs on their profile; `p` has numbers or arrays over runs."""

    def __init__(self, p, profile, nodes=contact.NODES, vehicle=vehicles.TWO_WHEELED):
        self.profile, self.nodes, self.given, self.vehicle = profile, nodes, p, vehicle
        shares = vehicles.shares(Linkage(p, vehicle))
        p = self.p = loaded(ground.present(p))
        self.linkage = Linkage(p, vehicle)
        self.bodies, self.count = self.linkage.bodies, len(vehicle.wheels)
        self.per_wheel = {name: wheels(value) for name, value in p.items()}
        # What a wheel carries by the data sheet and the mass that there is.
        self.load = shares * wheels(self.linkage.total) * self.per_wheel["gravity"]
        compliance = sum((self.per_wheel.get(f"flexible_wheel.{form}", 0.0) for form in ground.FLEXIBLE), np.zeros(()))
        self.ones = np.ones_like(np.asarray(p["mass"], float) + 0.0 * profile.slope)
        # Runs whose wheels flatten.
        self.compliance = np.broadcast_to(compliance, self.ones.shape + (self.count,))
        self.flexible = np.flatnonzero(self.compliance[:, 0])
        self.of_flexible = ground.present({name: value if value.ndim == 0 else value[self.flexible] for name, value in self.per_wheel.items()})
        total = self.linkage.total * self.ones
        self.mass = np.stack([total, total] + [inertia * self.ones for inertia in self.linkage.inertias], axis=-1)
        self.unknowns = self.mass.shape[-1]
        self.start = np.zeros_like(self.ones)  # x of the reference point at the start
        self.unsolved = np.zeros(self.ones.shape, int)  # smallest steps without a solution
        self.tracks = np.full(self.ones.shape + (self.count,), np.nan)  # where the tracks of the wheels' feet begin

    def of(self, runs):
        """A rover of these runs only."""
        given = {name: value if np.ndim(value) == 0 else np.asarray(value)[runs] for name, value in self.given.items()}
        some = Rover(given, self.profile.of(runs), self.nodes, self.vehicle)
        some.start, some.tracks, some.unsolved = self.start[runs], self.tracks[runs], self.unsolved[runs]
        return some

    def geometry(self, q, u):
        """Levers of the reference point and of the wheel centres, (body) and (body, wheel), and velocities of the centres."""
        reference = np.stack(self.linkage.reference_levers(q[..., 2:]), axis=-1)
        lever_x, lever_z = self.linkage.levers(q[..., 2:])
        v_x = u[..., 0:1] - np.sum(u[..., 2:, None] * lever_z, axis=-2)
        v_z = u[..., 1:2] + np.sum(u[..., 2:, None] * lever_x, axis=-2)
        return reference, lever_x, lever_z, v_x, v_z

    def reference_point(self, q, u):
        """Place and velocity of the reference point: x, z, each."""
        x, z = self.linkage.reference_levers(q[..., 2:])
        place = q[..., 0] + x.sum(-1), q[..., 1] + z.sum(-1)
        return place, (u[..., 0] - np.sum(u[..., 2:] * z, axis=-1), u[..., 1] + np.sum(u[..., 2:] * x, axis=-1))

    def touch(self, q, u, hold, command, held):
        """Forces of the wheels. `hold` is the contact's memory, and the slip to which the ground is dug; `held` is the time for which they
        have followed this motion."""
        p = self.per_wheel
        _, lever_x, lever_z, v_x, v_z = self.geometry(q, u)
        foot, distance, cos, sin = self.profile.foot(q[..., 0:1] + lever_x.sum(-2), q[..., 1:2] + lever_z.sum(-2))
        along, up = v_x * cos + v_z * sin, -v_x * sin + v_z * cos
        spin = command - u[..., 2 + self.bodies]
        rim = p["radius"] * spin
        speed = np.hypot(along, rim)
        memory = follow(hold, along, rim, speed, held, p["hold"])
        dug = dig(hold[2], along, rim, distance < p["radius"], held)
        scale = 1.0 / (p["hold"] + HOLD_TIME * speed)
        travel = (p["hold"] * memory[0] + HOLD_TIME * along) * scale
        turn = (p["hold"] * memory[1] + HOLD_TIME * rim) * scale
        length = np.minimum(np.hypot(travel, turn), 1.0)
        angle = np.arctan2(sin, cos)
        nominal = contact.slip_of(travel, turn) * length
        passed, lead = self.passed(foot, command, nominal)
        place = ground.place_at(nominal, along, p["radius"] - distance, self.load, angle, foot, passed, lead, dug)
        if len(self.flexible):
            place["load"] = self.carried(place, travel, turn, length)
        soil, place, turn, (normal, pull, torque) = self.contact(p, place, travel, turn, length)
        sinkage = place["sinkage"]
        pull = pull + ground.added_pull(p, place) * np.sign(along) * length
        torque = torque + ground.added_torque(p, np.maximum(normal, 0.0), turn) * length
        normal = np.where(sinkage > 0.0, np.maximum(normal - p["damping"] * smooth(sinkage / DAMPING_DEPTH) * up, 0.0), 0.0)
        slip = contact.slip_of(along, soil.get("true_radius", p["radius"]) * spin)
        return normal, pull, torque, (lever_x, lever_z, cos, sin), ((*memory, dug), sinkage, slip, spin)

    def contact(self, p, place, travel, turn, length):
        """The soil, the place with the soil's sinkage, the turning of the true rim, and the forces, of contacts at the sinkage of the
        nominal rim."""
        soil = ground.local_soil(p, place)
        if soil["radius"] is not p["radius"]:
            # A true radius other than the nominal one: sinkage and rim follow it; a flexible wheel descends further.
            true = soil.get("true_radius", p["radius"])
            turn = turn * true / p["radius"]
            sinkage = place["sinkage"] + true - p["radius"] - soil.get("deflection", 0.0)
            place = {**place, "sinkage": sinkage, "slip": contact.slip_of(travel, turn) * length}
            soil = ground.local_soil(p, place)
        normal, pull, torque, carried = contact.forces(soil, place["sinkage"], travel, turn / soil["radius"], length, self.nodes)
        return soil, place, turn, (carried + length * (normal - carried), length * pull, length * torque)

    def carried(self, place, travel, turn, length):
        """The load of each wheel from which its deflection follows: of flexible wheels the force of the soil, found by the secant method
        in the soil's sinkage z = Z - C N, which is that of the undeformed wheel less the deflection; of others the nominal load."""
        some = self.flexible

        def of(value):
            """The runs whose wheels flatten; what is the same for all runs stays."""
            return value if np.ndim(value) < 2 or np.shape(value)[-2] == 1 else np.asarray(value)[..., some, :]

        p, here = self.of_flexible, {name: of(value) for name, value in place.items()}
        whole, compliance = np.maximum(here["sinkage"], 0.0), self.compliance[some]
        apart = np.where(whole > 0.0, whole, 1.0)

        def rest(z):
            here["load"] = (whole - z) / compliance
            normal = self.contact(p, here, of(travel), of(turn), of(length))[-1][0]
            return (z + compliance * np.maximum(normal, 0.0) - whole) / apart

        within = lambda z: np.clip(z, LEAST_SINKAGE * whole, whole)
        before = within(whole - compliance * of(self.load))
        left = rest(before)
        deflection = (left + 1.0) * apart - before
        # The force grows with about the power 1.5 of the sinkage.
        z = within(before - left * apart / (1.0 + 1.5 * deflection / np.where(before > 0.0, before, 1.0)))
        for _ in range(STAND_STEPS):
            if np.max(np.abs(z - before) / apart, initial=0.0) < STANDS:
                break
            now = rest(z)
            change = z - before
            slope = np.where(now != left, (now - left) / np.where(change != 0.0, change, 1.0), 1.0 / apart)
            # The left side grows nearly as fast as z itself, or faster.
            before, left, z = z, now, within(z - now / np.maximum(slope, 1.0 / apart))
        load = np.broadcast_to(self.load, np.broadcast_shapes(np.shape(place["sinkage"]), self.load.shape)).copy()
        load[..., some, :] = (whole - z) / compliance
        return load

    def passed(self, foot, command, slip):
        """How many wheels have passed the ground under each, and the slip of the nearest one that did.

        Forwards the wheels in front have, backwards those behind."""
        passed = np.zeros_like(foot)
        for k in range(self.count):
            for other in range(self.count):
                side = 1.0 if other > k else -1.0
                if other != k:
                    past = side * (foot[..., k] - self.tracks[..., other])
                    passed[..., k] += smooth(np.nan_to_num(past / PASSED + 0.5))
        ahead, behind = np.roll(slip, -1, axis=-1), np.roll(slip, 1, axis=-1)
        ahead[..., -1], behind[..., 0] = behind[..., -1], ahead[..., 0]
        return passed, np.where(command >= 0.0, ahead, behind)

    def acceleration(self, q, u, hold, command, held):
        p = self.p
        normal, pull, torque, (lever_x, lever_z, cos, sin), _ = self.touch(q, u, hold, command, held)
        f_x, f_z = pull * cos - normal * sin, pull * sin + normal * cos
        (x, _), (velocity, _) = self.reference_point(q, u)
        extra = drive.resistance(p, velocity, x - self.start)
        at_wheels = lever_x * f_z[..., None, :] - lever_z * f_x[..., None, :] + self.linkage.carried * torque[..., None, :]
        _, reference_z = self.linkage.reference_levers(q[..., 2:])
        moments = at_wheels.sum(-1) - extra[..., None] * reference_z
        forces = np.stack([f_x.sum(-1) + extra, f_z.sum(-1) - self.linkage.total * p["gravity"]], axis=-1)
        if self.unknowns == 3:
            return np.concatenate([forces, moments], axis=-1) / self.mass
        moments = moments + self.linkage.moments(q[..., 2:], u[..., 2:])
        pitching = np.linalg.solve(self.linkage.inertia(q[..., 2:]), moments[..., None])[..., 0]
        return np.concatenate([forces / self.mass[..., :2], pitching], axis=-1)

    def settle(self, x0):
        """At rest with the reference point above x0, held on a slope by locked wheels (NaN where it cannot stand): unknown are the share of the
        friction that holds, z and the pitches."""
        runs = self.mass.shape[:-1]
        height, slope, _ = self.profile.at(np.full(runs, x0))
        pitches = [np.arctan(slope)] * (self.unknowns - 2)
        unknown = np.stack([np.zeros(runs), height + self.p["radius"] * 0.95] + pitches, axis=-1)
        zero, still = np.zeros(runs + (self.count,)), np.zeros(runs + (self.unknowns,))

        def left(y):
            level = np.zeros(y.shape[:-1])
            q = np.concatenate([np.stack([level, level], axis=-1), y[..., 2:]], axis=-1)
            (x, z), _ = self.reference_point(q, np.zeros_like(q))
            q = np.concatenate([np.stack([x0 - x, y[..., 1] - z], axis=-1), y[..., 2:]], axis=-1)
            shape = y.shape[:-1] + (self.count,)
            hold = (np.broadcast_to(-np.clip(y[..., 0:1], -1.0, 1.0), shape), np.zeros(shape), np.zeros(shape))
            return self.acceleration(q, 0.0 * q, hold, zero, 0.0), q, hold

        for _ in range(60):
            residual, q, hold = left(unknown)
            if np.all(np.abs(residual) < 1e-7):
                break
            steps = 1e-6 * np.eye(self.unknowns)
            slopes = np.stack([(left(unknown + d)[0] - residual) / 1e-6 for d in steps], axis=-1)
            change = (np.linalg.pinv(np.nan_to_num(slopes)) @ np.nan_to_num(residual)[..., None])[..., 0]
            limit = np.abs(change) / np.array([0.5, 0.01] + [0.05] * (self.unknowns - 2))
            unknown = unknown - change / np.maximum(np.max(limit, axis=-1, keepdims=True), 1.0)
        q = np.where(np.all(np.abs(residual[..., 1:]) < 1e-3, axis=-1)[..., None], q, np.nan)
        self.start = np.full(runs, float(x0))
        lever_x, lever_z = self.linkage.levers(q[..., 2:])
        self.tracks = self.profile.foot(q[..., 0:1] + lever_x.sum(-2), q[..., 1:2] + lever_z.sum(-2))[0]
        return q, still, hold

    def step(self, q, u, hold, command, dt, slopes, halved=0):
        """One step of two implicit stages. `slopes` holds the factor of the chord method, renewed where it is slow. Runs in which
        a stage has no solution do two half steps; those in which halves do not help either are given up in the end (NaN)."""
        before, span = (q, u, *hold), GAMMA * dt
        (_, first_u, first_a), unsolved = self.stage(q, u, u, hold, command, span, span, slopes)
        base_q = q + (dt - span) * first_u
        base_u = u + (dt - span) * first_a
        (q, u, a), later = self.stage(base_q, base_u, first_u, hold, command, span, dt, slopes)
        *_, (memory, *_) = self.touch(q, u, hold, command, dt)
        if len(some := np.union1d(unsolved, later)):
            if halved < HALVINGS:
                rover, slopes = self.of(some), {}
                q_, u_, *hold_ = (value[some] for value in before)
                for _ in range(2):
                    q_, u_, a_, hold_ = rover.step(q_, u_, hold_, command[some], 0.5 * dt, slopes, halved + 1)
                for whole, part in zip((q, u, a, *memory, self.unsolved), (q_, u_, a_, *hold_, rover.unsolved)):
                    whole[some] = part
            else:
                self.unsolved[some] += 1
                q[self.unsolved > GIVEN_UP] = np.nan
        return q, u, a, memory

    def stage(self, base_q, base_u, guess, hold, command, h, since, slopes):
        """Solves u = base_u + h a(base_q + h u, u), `since` seconds into the step; gives q, u, a, and the runs without a solution."""
        v, unsolved = self.solved(base_q, base_u, guess, hold, command, h, since, slopes)
        return (base_q + h * v, v, (v - base_u) / h), unsolved

    def solved(self, base_q, base_u, v, hold, command, h, since, slopes, first=0):
        """The u of a stage from v on, and the runs in which it is not found; a few that need more iterations than the rest go on
        alone. `first`: iterations before."""

        def residual(v):
            return v - base_u - h * self.acceleration(base_q + h * v, v, hold, command, since)

        size, left, unsolved = np.inf, residual(v), np.arange(len(v))
        for iteration in range(first + 1, ITERATIONS + 1):
            if slopes.get("span") != h:
                each = np.eye(self.unknowns)[:, None, :]
                columns = (residual(v + 1e-6 * each) - left) / 1e-6
                columns = np.where(np.isfinite(columns), columns, each)
                slopes["inverse"], slopes["span"] = np.linalg.inv(np.moveaxis(columns, 0, -1)), h
            change = np.clip(np.einsum("...ij,...j->...i", slopes["inverse"], left), -0.2, 0.2)
            before, (v, left) = np.sum(left**2, axis=-1), (v - change, residual(v - change))
            # A run that got worse (a contact that opens, a slip that changes its sign) goes half the way.
            worse = np.sum(left**2, axis=-1) > 4.0 * before
            if np.any(worse):
                v = np.where(worse[..., None], v + 0.5 * change, v)
                left = residual(v)
            error = np.max(np.abs(change), axis=-1)
            unsolved = np.flatnonzero(error >= TOLERANCE)  # NaN is not: such a run does not go on
            if not len(unsolved):
                break
            slow = np.nanmax(error) > SLOW * size or np.any(worse)
            if len(unsolved) <= ALONE * len(error):
                own = {"inverse": slopes["inverse"][unsolved], "span": None if slow else h}
                given = (value[unsolved] for value in (base_q, base_u, v))
                memory = tuple(value[unsolved] for value in hold)
                v[unsolved], still = self.of(unsolved).solved(*given, memory, command[unsolved], h, since, own, iteration)
                slopes["inverse"][unsolved] = own["inverse"]
                return v, unsolved[still]
            if slow:
                slopes.pop("span")
            size = np.nanmax(error)
        return v, unsolved


def follow(hold, along, rim, speed, span, distance):
    """The contact's memory after `span` seconds of this motion: h' = (v - h |v|)/d with v held, in closed form."""
    way = span * speed / distance
    left = np.exp(-way)
    gain = span / distance * np.where(way > 1e-6, -np.expm1(-way) / np.maximum(way, 1e-6), 1.0)
    return left * hold[0] + gain * along, left * hold[1] + gain * rim


def dig(dug, along, rim, touches, span):
    """The slip to which the ground is dug after `span` seconds of this motion: s' = (min(|r omega - V|, v) - s v)/l, v = max(|V|, |r omega|)
    on the ground; off it v = |V| and no slip. The motion at the end counts for all of a step (order 1), and the rim is the nominal one."""
    fastest = np.where(touches, np.maximum(np.abs(along), np.abs(rim)), np.abs(along))
    slip = np.where(touches, np.minimum(np.abs(rim - along), fastest), 0.0) / np.maximum(fastest, 1e-12)
    return slip + (dug - slip) * np.exp(-span * fastest / ground.DIGGING)


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
