"""Steady points of a wheel on a carriage: load, slip and wheel speed set, drawbar pull, torque and sinkage measured."""

import numpy as np

import contact
import drive
import ground

SIGNALS = ("drawbar_pull", "torque", "sinkage")
BISECTIONS = 42  # of the entry angle: 90 degrees to 4e-13 rad
DEEPEST = 0.9  # sinkage over the radius beyond which a carriage does not measure: noise must not pass the axle
GRAVITY = 9.81

# Places of numbers on a signal's decimal grid, for the files.
DECIMALS = {"drawbar_pull": 4, "torque": 5, "sinkage": 6}


def steady_points(p, load, slip, wheel_speed):
    """The three signals (last axis) where the soil carries the load (N); arrays of one shape.

    NaN where the wheel sinks nearly to its axle. The slip is what the carriage sets by the nominal radius, V = r omega (1 - i) or r omega/(1 + i) in skid.
    """
    p = ground.present(p)
    load, slip, wheel_speed = np.broadcast_arrays(*(np.asarray(v, float) for v in (load, slip, wheel_speed)))
    velocity = p["radius"] * wheel_speed * np.where(slip >= 0.0, 1.0 - slip, 1.0 / (1.0 + np.minimum(slip, 0.0)))
    load = true_load(p, load)
    low, high = np.full(load.shape, 1e-5), np.full(load.shape, 0.5 * np.pi - 1e-6)

    def at(entry):
        sinkage = p["radius"] * (1.0 - np.cos(entry))
        place = ground.place_at(slip, velocity, sinkage, load)
        soil = ground.local_soil(p, place)
        # What slips is the true rim.
        place["slip"] = contact.slip_of(velocity, soil.get("true_radius", p["radius"]) * wheel_speed)
        soil = ground.local_soil(p, place)
        rim = soil.get("true_radius", p["radius"]) * wheel_speed
        return sinkage, place, contact.forces(soil, sinkage, velocity, rim / soil["radius"])

    sunk = at(high)[2][0] < load
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        light = at(middle)[2][0] < load
        low, high = np.where(light, middle, low), np.where(light, high, middle)
    sinkage, place, (normal, pull, torque, _) = at(0.5 * (low + high))
    torque = torque + ground.added_torque(p, normal, wheel_speed)
    pull = pull + ground.added_pull(p, place) + drive.resistance(p, velocity, np.zeros_like(velocity))
    torque = drive.recorded_torque(p, drive.motor_torque(p, torque, wheel_speed) + drive.ripple(p, p.get("turned", 0.0)))
    if (s := ground.on(p, "drift.order")) is not None:  # outside the library: the force sensor drifts from run to run
        pull = pull + s * p["order"]
    signals = np.stack(np.broadcast_arrays(pull, torque, sinkage), axis=-1)
    signals[sunk | (sinkage > DEEPEST * p["radius"])] = np.nan
    return signals


def true_load(p, load):
    if (s := ground.on(p, "payload.mass")) is not None:
        load = load + s * GRAVITY
    if (s := ground.on(p, "payload.share")) is not None:  # the load cell's scale is off, s over 20 N
        load = load * (1.0 + s * GRAVITY / 20.0)
    return load
