"""Runs of the rover recorded as an experiment records them: rows, commands that hold from row to row, sensors."""

import numpy as np

import drive
import ground
import vehicles
from rover import Rover

# Steps of the first rows, as shares of a row: there the contacts break loose.
FIRST_ROWS = 4
FIRST = (0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.3)

DECIMALS = 6  # of a signal


def signals(vehicle):
    """What is recorded of a vehicle; wheels and links are numbered from 1."""
    each = [f"wheel[{k}].{what}" for what in ("torque", "current", "sinkage") for k in range(1, len(vehicle.wheels) + 1)]
    angles = [f"link[{k}].angle" for k in range(1, len(vehicle.links) + 1)]
    return ("x", "pitch", "velocity", *each, "power", *angles)


def drive_runs(p, profile, commands, row_time, parts, nodes, x0=0.0, vehicle=vehicles.TWO_WHEELED):
    """Signals (rows, runs, signals) of runs that start at rest and follow `commands` (rows, runs, wheels). `row_time` is the time
    from row to row, s: a number, or one for each row but the first.

    `parts` are the steps from row to row as shares of the time between them: short ones first, since the slip settles
    within milliseconds after a command. Signals of a row are read before its command acts. NaN from where a run cannot go on.
    """
    p = ground.present(p)
    rover = Rover(p, profile, nodes, vehicle)
    q, u, hold = rover.settle(x0)
    a = np.zeros_like(u)
    turned = np.zeros(u.shape[:-1] + (rover.count,))
    states, slopes, time, at = [], {}, [0.0], []
    command = np.zeros_like(turned)
    between = np.broadcast_to(row_time, len(commands) - 1)
    for row in range(len(commands)):
        for part in () if row == 0 else FIRST if row <= FIRST_ROWS else parts:
            dt = part * between[row - 1]
            time.append(time[-1] + dt)
            q, u, a, hold = rover.step(q, u, hold, command, dt, slopes)
            turned = turned + dt * command
            states.append(read(rover, q, u, hold, command, a, turned))
        if row == 0:
            states.append(read(rover, q, u, hold, command, a, turned))
        at.append(len(states) - 1)
        command = commands[row]
        slopes.clear()
    return sensors(p, np.stack(states), np.array(time), rover.count)[at]


def read(rover, q, u, hold, command, acceleration, turned):
    """What there is to measure at one instant: x, pitch, velocity, rim torques, sinkages, wheel speeds, turns, joint angles."""
    _, _, torque, _, (_, sinkage, _, _) = rover.touch(q, u, hold, command, 0.0)
    (x, _), (v_x, v_z) = rover.reference_point(q, u)
    if not np.any(u):
        torque = 0.0 * torque  # parked: the brakes hold until the first command
    # The wheels turn with their body's pitching at a given speed relative to it.
    torque = torque - wheels_inertia(rover) * acceleration[..., 2 + rover.bodies]
    body = [x, q[..., 2], np.copysign(np.hypot(v_x, v_z), v_x)]
    angles = q[..., 3:] - q[..., 2:3]
    return np.concatenate([np.stack(body, axis=-1), torque, sinkage, command, turned, angles], axis=-1)


def wheels_inertia(rover):
    value = np.asarray(rover.p["wheel_inertia"], float)
    return value if value.ndim == 0 else value[..., None]


def sensors(p, states, time, wheels):
    """Recorded signals from the states (steps, runs, values)."""
    per_wheel = {name: np.asarray(v, float)[..., None] if np.ndim(v) else v for name, v in p.items()}
    clock = time[:, None, None]
    body, torque, sinkage, speed, turned, angles = np.split(states, 3 + wheels * np.arange(5), axis=-1)
    body = body.copy()
    motor = drive.motor_torque(per_wheel, torque, speed) + drive.ripple(per_wheel, turned)
    cold = p["resistance"] * (motor / (p["gear"] * p["torque_constant"])) ** 2
    heat, magnet = drive.windings(per_wheel, time, cold)
    # A torque constant that is off, or an amplifier's gain: torque and power are reckoned from the current that is recorded.
    shown = drive.recorded_torque(per_wheel, motor)
    current = shown / (p["gear"] * p["torque_constant"] * magnet)
    power = np.sum(p["resistance"] * heat * current**2, axis=-1, keepdims=True)
    if (s := ground.on(per_wheel, "drift.time")) is not None:  # outside the library: the rear torque cell drifts
        shown = shown + s * (clock / time[-1]) * np.eye(wheels)[0]
    if (s := ground.on(p, "radius_scale.odometry")) is not None:  # of way and speed
        body[..., 0] += s * (body[..., 0] - body[0, ..., 0])
        body[..., 2] *= 1.0 + s
    if (s := ground.on(p, "pitch_bias.constant")) is not None:
        body[..., 1] += s
    if (s := ground.on(p, "pitch_bias.drifting")) is not None:  # an inclinometer that also creeps while it warms up
        body[..., 1] += s * (1.0 + 0.2 * time[:, None] / time[-1])
    if (s := ground.on(p, "body_delay")) is not None:  # a condition of the study: one clock is late
        body = drive.delayed(body, np.broadcast_to(np.asarray(s, float).ravel(), body.shape[1:2]), time)
    signals = np.concatenate([body, shown, current, sinkage, power, angles], axis=-1)
    return drive.sensor_lag(per_wheel, time, signals)
