"""A wheel on deformable soil, for many contacts at once: the other side of the comparison with the Rust model.

Stresses of Bekker, Wong and Reece (1967), shear of Janosi and Hanamoto (1961). Both zones of the contact are summed by
Fejer's rule. Parameters are a dict of numbers or arrays, one entry a contact; whatever an effect
changes is changed in that dict before the stresses are summed (ground.py).

Error of the sums with 20 nodes a zone against 2000: under 1e-4 of the load (test_generators.py), a hundredth of the
smallest noise that the generators add.
"""

import functools

import numpy as np

NODES = 20


@functools.lru_cache
def grid(nodes):
    """Places and weights in 0..1 of Fejer's first rule: a cosine grid, dense at both ends, where the stress has roots."""
    angle = np.pi * (np.arange(nodes) + 0.5) / nodes
    order = np.arange(1, nodes // 2 + 1)
    series = np.sum(np.cos(2.0 * np.outer(angle, order)) / (4.0 * order**2 - 1.0), axis=1)
    return 0.5 * (1.0 - np.cos(angle)), (1.0 - 2.0 * series) / nodes


def slip_of(velocity, rim):
    """Slip: 1 - V/(r omega) driving, r omega/V - 1 in skid; 0 at standstill."""
    driving = np.abs(rim) >= np.abs(velocity)
    with np.errstate(divide="ignore", invalid="ignore"):
        slip = np.where(driving, 1.0 - velocity / rim, rim / velocity - 1.0)
    return np.where(np.maximum(np.abs(rim), np.abs(velocity)) < 1e-6, 0.0, slip)


def entry_angle(soil, sinkage):
    return np.arccos(1.0 - np.clip(sinkage / soil["radius"], 0.0, 1.0))


def exit_angle(soil, sinkage, entry):
    """Behind the lowest point: Ishigami's share lambda of the sinkage, or a share of the entry angle (Ding)."""
    end = np.zeros_like(entry)
    if "exit_ratio" in soil:
        end = end - np.arccos(1.0 - np.clip(soil["exit_ratio"] * sinkage / soil["radius"], 0.0, 1.0))
    if "exit_share" in soil:
        end = end - soil["exit_share"] * entry
    return end


def forces(soil, sinkage, velocity, spin, share=1.0, nodes=NODES):
    """Normal force, drawbar pull, torque, and the normal force of the pressure alone; zero where there is no contact.

    velocity along the ground (m/s) and spin (rad/s) may have any sign: backward the contact is mirrored, and where the
    rim turns against the motion it slides fully. `share` is the part of the slip that is established.
    """
    side = np.where((velocity < 0.0) | ((velocity == 0.0) & (spin < 0.0)), -1.0, 1.0)
    travel, rim = side * velocity, side * spin * soil["radius"]
    sliding = rim <= 1e-6 * travel
    ratio = travel / np.where(sliding, 1.0, rim)
    slip = np.where(sliding, 1.0, np.where(ratio <= 1.0, 1.0 - ratio, 1.0 - 1.0 / np.maximum(ratio, 1.0)))

    entry = np.maximum(entry_angle(soil, sinkage), 1e-9)
    end = exit_angle(soil, sinkage, entry)
    peak = np.clip(soil["c1"] + soil["c2"] * slip * share, 0.05, 0.95) * entry

    place, weight = grid(nodes)
    column = lambda x: np.asarray(x, float)[..., None]
    entry_, peak_, end_ = column(entry), column(peak), column(end)
    front = entry_ - (entry_ - peak_) * place
    rear = end_ + (peak_ - end_) * place
    theta = np.concatenate([np.broadcast_to(front, rear.shape), rear], axis=-1)
    d_theta = np.concatenate([(entry_ - peak_) * weight, (peak_ - end_) * weight], axis=-1)
    # The rear zone has the stress of the front at the same share of the way to the peak.
    radius = column(soil["radius"])
    depth = np.maximum(radius * (np.cos(front) - np.cos(entry_)), 0.0)
    sigma = pressure(soil, depth, column)
    sigma = np.concatenate([sigma, sigma], axis=-1)

    # Lugs shear the soil on a larger circle, which enters it earlier.
    outer = soil.get("shear_radius", soil["radius"])
    begin = column(np.arccos(np.clip(np.cos(entry) * soil["radius"] / outer, -1.0, 1.0))) if "shear_radius" in soil else entry_
    shear = column(outer) * (begin - theta) - radius * column(ratio) * (np.sin(begin) - np.sin(theta))
    grown = 1.0 - np.exp(-np.abs(shear) / column(soil["shear_modulus"]))
    grown = np.where(column(sliding), -1.0, np.sign(shear) * grown)
    tau = shear_stress(soil, sigma, grown, column)

    sin, cos = np.sin(theta), np.cos(theta)
    area = soil["radius"] * soil["width"]
    carried = area * np.sum(d_theta * sigma * cos, axis=-1)
    sheared = soil["width"] * outer
    normal = carried + sheared * np.sum(d_theta * tau * sin, axis=-1)
    pull = sheared * np.sum(d_theta * tau * cos, axis=-1) - area * np.sum(d_theta * sigma * sin, axis=-1)
    arm = outer * soil["arm"] / soil["radius"] if "arm" in soil else outer
    torque = sheared * arm * np.sum(d_theta * tau, axis=-1)
    touching = sinkage > 0.0
    zero = lambda x, sign=1.0: np.where(touching, sign * x, 0.0)
    return zero(normal), zero(pull, side), zero(torque, side), zero(carried)


def pressure(soil, depth, column):
    """Normal stress at a depth (Bekker); `sinkage_factor` divides the depth that carries (Lyasko)."""
    if "sinkage_factor" in soil:
        depth = depth / column(soil["sinkage_factor"])
    return column(soil["modulus"]) * depth ** column(soil["exponent"])


def shear_stress(soil, sigma, grown, column):
    """Mobilised shear stress, limited by what sticks to the rim where that is less."""
    strength = column(soil["cohesion"]) + sigma * column(soil["tan_phi"])
    tau = strength * grown
    if "rim_cohesion" in soil:
        cap = column(soil["rim_cohesion"]) + sigma * column(soil["rim_tan"])
        sharp = column(soil["rim_sharpness"])  # of the limit, run by run: infinite is a corner, 0 no limit
        limited = np.clip(tau, -cap, cap)
        rounded = (sharp > 0.0) & np.isfinite(sharp)
        if np.any(rounded):
            # Sticks fully where little is sheared, and reaches the cap where the soil is fully sheared; a rim as rough as
            # the soil changes nothing.
            power = np.where(rounded, sharp, 1.0)
            more = np.maximum((np.abs(tau) / np.maximum(cap, 1e-9)) ** power - np.abs(grown) ** power, 0.0)
            limited = np.where(rounded, tau / (1.0 + more) ** (1.0 / power), limited)
        tau = np.where(sharp > 0.0, limited, tau)
    return tau
