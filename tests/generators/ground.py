"""Effects at the contact of wheel and soil, each in the library's form and in other forms of the literature.

An effect is a number in the dict of parameters under the key "case.form"; absent or 0 it changes nothing. `local_soil`
turns parameters and the place of a contact into what contact.forces sums; `added_pull` is what acts beside the stresses.
"""

import numpy as np

LOAD_GROWTH = 10.0  # growth of a flexible wheel's arc radius over its deflection, where the arc grows with the load alone
LARGEST_SLIP = 0.95  # that counts in Reece's slip-sinkage, which has no bound at a slip of 1
LEAST_STATIC = 0.1  # smallest share of a sinkage that presses the soil, whatever is carried away
RATE_SPEED = 0.01  # m/s, reference speed of the rate laws
DIGGING = 0.05  # m, relaxation length with which a gradual slip-sinkage follows the slip
FLEXIBLE = ("arc", "load", "axle", "schmid")  # forms of a flexible wheel
ROUNDED = 0.02  # rad, of a slope's size
GRAVITY_OF_SOIL = 16e3  # N/m^3, unit weight of sand


def present(p):
    """The parameters without the effects that are off everywhere, so that these cost nothing."""
    return {name: value for name, value in p.items() if "." not in name or np.any(np.asarray(value) != 0.0)}


def on(p, key):
    """The strength of an effect in parameters as `present` leaves them; None where no run has it."""
    return p.get(key)


def place_at(slip, velocity, sinkage, load, angle=0.0, x=0.0, passed=0.0, lead_slip=0.0, dug=0.0):
    """Where and how a wheel touches; `passed` is 1 where another wheel has passed, with the slip `lead_slip`; `dug` is the slip to which the
    wheel has dug the ground by now."""
    return {
        "slip": slip,
        "speed": np.abs(velocity),
        "sinkage": sinkage,
        "load": load,
        "angle": angle,
        "x": x,
        "passed": passed,
        "lead_slip": lead_slip,
        "dug": dug,
    }


def local_soil(p, at):
    soil = {
        "radius": p["radius"],
        "width": p["width"],
        "modulus": p["k_phi"],
        "exponent": p["exponent"],
        "cohesion": p["cohesion"],
        "shear_modulus": p["shear_modulus"],
        "c1": p["c1"],
        "c2": p["c2"],
    }
    angle = p["friction_angle"]
    angle = slope_strength(p, at, angle)
    soil["tan_phi"] = np.tan(angle)
    for change in (radius, slip_sinkage, rebound, lugs, rate, moisture, multi_pass, soft_patch, rim_adhesion):
        change(p, at, soil)
    return soil


def radius(p, at, soil):
    """The true radius, and the larger arc of a flexible wheel; both keep the sinkage that of the soil."""
    if (s := on(p, "radius_scale.scale")) is not None:
        soil["radius"] = soil["true_radius"] = soil["radius"] * (1.0 + s)
    # Worn on the tread: the width of the worn rim shrinks with it, a third as fast.
    if (s := on(p, "radius_scale.worn")) is not None:
        soil["radius"] = soil["true_radius"] = soil["radius"] * (1.0 + s)
        soil["width"] = soil["width"] * (1.0 + s / 3.0)
    # Deflection f = C W; the arc enters the soil where the round outline does: r* = r (z + f)/z.
    # Runs with other forms stand beside each other: each form changes its own runs only.
    if (s := on(p, "flexible_wheel.arc")) is not None:
        deflected(soil, own := s * at["load"], 1.0 + own / np.maximum(at["sinkage"], 1e-6))
    if (s := on(p, "flexible_wheel.load")) is not None:  # an effective radius that grows with the load
        deflected(soil, own := s * at["load"], 1.0 + LOAD_GROWTH * own / p["radius"])
    if (s := on(p, "flexible_wheel.schmid")) is not None:  # Schmid's circle, with the flattened half behind the axle
        share = s * at["load"] / np.maximum(at["sinkage"], 1e-6)
        deflected(soil, s * at["load"], (np.sqrt(1.0 + share) + np.sqrt(share)) ** 2)
    if (s := on(p, "flexible_wheel.axle")) is not None:  # as `arc`, and the arm of the torque stays the wheel's radius
        own, round_ = s * at["load"], soil["radius"]
        deflected(soil, own, 1.0 + own / np.maximum(at["sinkage"], 1e-6))
        soil["arm"] = np.where(np.asarray(s) != 0.0, round_, soil["radius"])


def deflected(soil, deflection, growth):
    """A wheel whose axle descends by `deflection` (m) and whose arc is `growth` times as large."""
    soil["deflection"] = soil.get("deflection", 0.0) + deflection
    soil["radius"] = soil["radius"] * growth


def slip_sinkage(p, at, soil):
    size = np.minimum(np.abs(at["slip"]), 1.0)
    if (s := on(p, "slip_sinkage.ding")) is not None:  # n = n0 + n1 |i|
        soil["exponent"] = soil["exponent"] + s * size
    if (s := on(p, "slip_sinkage.lyasko")) is not None:  # z = z0 (1 + i)/(1 - 0.5 i), the share s of its growth
        deeper(soil, 1.0 + s * ((1.0 + size) / (1.0 - 0.5 * size) - 1.0))
    if (s := on(p, "slip_sinkage.reece")) is not None:  # z = z0 + s i/(1 - i), s the height of lugs that carry soil away (Reece 1965)
        slipping = np.minimum(size, LARGEST_SLIP)
        carried = s * slipping / (1.0 - slipping) / np.maximum(at["sinkage"], 1e-6)
        deeper(soil, 1.0 / np.maximum(1.0 - carried, LEAST_STATIC))
    if (s := on(p, "slip_sinkage.gradual")) is not None:  # Ding's, of the slip to which the ground is dug by now
        soil["exponent"] = soil["exponent"] + s * np.clip(at["dug"], 0.0, 1.0)
    if (s := on(p, "slip_sinkage.quadratic")) is not None:  # n = n0 + n1 |i| + n2 i^2 with n2 = n1/2 (Ding's second form)
        soil["exponent"] = soil["exponent"] + s * (size + 0.5 * size * size)


def deeper(soil, factor):
    """Soil that is pressed by the share 1/factor of its depth only."""
    soil["sinkage_factor"] = soil.get("sinkage_factor", 1.0) * factor


def rebound(p, at, soil):
    if (s := on(p, "exit_angle.ishigami")) is not None:
        soil["exit_ratio"] = s
    if (s := on(p, "exit_angle.share")) is not None:
        soil["exit_share"] = s


def lugs(p, at, soil):
    """Lugs of height h = s hold the soil between them: it is sheared at r + h (Ding et al. 2011)."""
    for form in ("lugs", "radius"):
        if (s := on(p, f"grousers.{form}")) is None:
            continue
        soil["shear_radius"] = soil.get("shear_radius", soil["radius"]) + s
        if form == "lugs":  # and along their sides: Bekker's c (1 + 2 h/b), tan phi (1 + 0.64 (h/b) acot(h/b))
            ratio = np.maximum(s, 0.0) / p["width"]
            soil["cohesion"] = soil["cohesion"] * (1.0 + 2.0 * ratio)
            soil["tan_phi"] = soil["tan_phi"] * (1.0 + 0.64 * ratio * np.arctan2(1.0, ratio))


def rate(p, at, soil):
    entry = np.arccos(1.0 - np.clip(at["sinkage"] / p["radius"], 0.0, 1.0))
    speed = np.maximum(at["speed"] * np.tan(0.5 * entry), 1e-4) / RATE_SPEED
    if (s := on(p, "rate.grahn")) is not None:  # p = k z^n v^m, v the penetration speed (Grahn 1991)
        soil["modulus"] = soil["modulus"] * speed**s
    if (s := on(p, "rate.logarithm")) is not None:
        soil["modulus"] = soil["modulus"] * np.maximum(1.0 + s * np.log(speed), 0.2)


def moisture(p, at, soil):
    # Cohesion that the recorded water content w (0..1) of the run brings, Pa.
    if (s := on(p, "moisture.linear")) is not None:
        soil["cohesion"] = soil["cohesion"] + s * p["water"]
    if (s := on(p, "moisture.saturating")) is not None:
        soil["cohesion"] = soil["cohesion"] + s * (1.0 - np.exp(-3.0 * p["water"])) / (1.0 - np.exp(-3.0))


def multi_pass(p, at, soil):
    passed = at["passed"]
    if (s := on(p, "multi_pass.holm")) is not None:  # stiffer and more cohesive after a pass
        soil["modulus"] = soil["modulus"] * (1.0 + s * passed)
        soil["cohesion"] = soil["cohesion"] * (1.0 + s * passed)
    # Density grows with the slip of the pass; cohesion and K follow it (Senatore and Sandu 2011).
    if (s := on(p, "multi_pass.senatore")) is not None:
        slip = np.clip(np.abs(at["lead_slip"]), 0.0, 1.0)
        dense = passed * (1.0 - (1.0 - slip) * np.exp(-slip / 0.2) * 0.5)
        soil["modulus"] = soil["modulus"] * (1.0 + s * dense)
        soil["cohesion"] = soil["cohesion"] * (1.0 + s * dense)
        soil["shear_modulus"] = soil["shear_modulus"] * (1.0 - 0.4 * np.minimum(s, 1.0) * dense)


def soft_patch(p, at, soil):
    away = (at["x"] - p.get("patch_at", 0.0)) / p.get("patch_half", 1.0)
    if (s := on(p, "soft_patch.window")) is not None:
        soil["modulus"] = soil["modulus"] * (1.0 - s / (1.0 + away**4))
    if (s := on(p, "soft_patch.bell")) is not None:
        soil["modulus"] = soil["modulus"] * (1.0 - s * np.exp(-0.7 * away**2))


def slope_strength(p, at, angle):
    size = np.abs(at["angle"])
    if (s := on(p, "slope_strength.linear")) is not None:  # phi - beta |alpha|, with the library's rounding at level ground
        angle = angle - s * (np.hypot(size, ROUNDED) - ROUNDED)
    if (s := on(p, "slope_strength.quadratic")) is not None:
        angle = angle - s * size * size / 0.15
    return angle


def rim_adhesion(p, at, soil):
    """A rim to which the soil sticks less than to itself: at most (1 - s) of the soil's strength, each run in its own form."""
    for form, sharpness in (("minimum", np.inf), ("smooth", 6.0), ("round", 2.0)):
        s = on(p, f"rim_adhesion.{form}")
        if s is None:
            continue
        own = np.asarray(s) + 0.0 * np.asarray(soil["cohesion"])
        # The strength of 1 - s where the effect is on, out of reach where it is off.
        share = np.where(own > 0.0, 1.0 - own, 2.0)
        here = lambda name, value, usual: np.where(own > 0.0, value, soil.get(name, usual))
        soil["rim_cohesion"] = here("rim_cohesion", share * soil["cohesion"], 2.0 * soil["cohesion"])
        soil["rim_tan"] = here("rim_tan", share * soil["tan_phi"], 2.0 * soil["tan_phi"])
        soil["rim_sharpness"] = here("rim_sharpness", sharpness, 0.0)


def added_pull(p, at):
    """Forces along the ground at the wheel beside the stresses, N, for a wheel that rolls forward."""
    pull = 0.0 * np.asarray(at["sinkage"])
    z = np.maximum(at["sinkage"], 0.0)
    angle = p["friction_angle"]
    if (s := on(p, "bulldozing.passive")) is not None:  # Rankine's wall of height z in front of the wheel
        passive = np.tan(0.25 * np.pi + 0.5 * angle) ** 2
        pull = pull - s * p["width"] * (0.5 * GRAVITY_OF_SOIL * z * z * passive + 2.0 * p["cohesion"] * z * np.sqrt(passive))
    if (s := on(p, "bulldozing.hegedus")) is not None:  # Hegedus 1960: bulldozed area at the destructive angle X
        x = 0.25 * np.pi - 0.5 * angle
        share = (1.0 / np.tan(x) + np.tan(x + angle)) / (1.0 - np.tan(0.1) * np.tan(x + angle))
        pull = pull - s * p["width"] * share * (z * p["cohesion"] + 0.5 * GRAVITY_OF_SOIL * z * z)
    if (s := on(p, "hump.slip")) is not None:  # outside the library: a bump of the pull over slip
        pull = pull + s * at["load"] * np.exp(-0.5 * ((at["slip"] - p["hump_at"]) / p["hump_width"]) ** 2)
    return pull * np.where(at["speed"] > 0.0, 1.0, 0.0)


def added_torque(p, normal, turn):
    """Moment of the wheel itself against its turning, N m, under a normal force and with the sign of `turn`."""
    moment = 0.0 * normal
    if (s := on(p, "rolling_resistance.moment")) is not None:  # s r N
        moment = moment + s * p["radius"] * normal
    if (s := on(p, "rolling_resistance.hertz")) is not None:  # losses of an elastic cylinder, N^1.5 (Tabor 1955), s at 40 N
        moment = moment + s * p["radius"] * normal * np.sqrt(normal / 40.0)
    if (s := on(p, "rolling_resistance.sphere")) is not None:  # those of an elastic sphere, N^(4/3) (Tabor 1955), s at 40 N
        moment = moment + s * p["radius"] * normal * np.cbrt(normal / 40.0)
    return moment * np.sign(turn)
