"""What can be hidden: the cases, their forms, how strong they may be.

`library` marks the form that the model's own library has (physics of the usual reference); the others are other forms
of the same effect in the literature, for the report. Cases of the kind "outside" have no effect in the library.
"""

from dataclasses import dataclass

WHEEL, ROVER = "single_wheel", "traverse"


@dataclass(frozen=True)
class Form:
    case: str
    form: str
    typical: float  # the strong end of what is usual
    bound: float  # beyond it the form is not physical
    kinds: tuple
    library: bool = False
    outside: bool = False
    signed: bool = False  # may be negative as well
    rival: float = 0.0  # strength at which its difference quotients are taken; 0: a twentieth of the typical one
    jointed: bool = False  # only where the vehicle has joints (condition rocker_bogie)

    @property
    def probe(self):
        return self.rival or 0.05 * self.typical

    @property
    def key(self):
        return f"{self.case}.{self.form}"


BOTH, W, R = (WHEEL, ROVER), (WHEEL,), (ROVER,)

FORMS = [
    Form("slip_sinkage", "ding", 0.5, 1.0, BOTH, library=True),
    Form("slip_sinkage", "lyasko", 1.0, 1.5, BOTH, library=True),
    Form("slip_sinkage", "reece", 0.004, 0.02, BOTH, library=True),
    Form("slip_sinkage", "quadratic", 0.4, 0.8, BOTH),
    # The library has it too, but with a length that is no free parameter of a diagnosis.
    Form("slip_sinkage", "gradual", 0.5, 1.0, R),
    Form("exit_angle", "ishigami", 0.8, 1.2, BOTH, library=True),
    Form("exit_angle", "share", 0.6, 0.9, BOTH),
    Form("multi_pass", "holm", 0.5, 1.0, R, library=True),
    Form("multi_pass", "senatore", 0.5, 1.5, R),
    Form("grousers", "lugs", 0.012, 0.03, BOTH, library=True),
    Form("grousers", "radius", 0.012, 0.03, BOTH),
    Form("bulldozing", "passive", 1.0, 3.0, BOTH, library=True),
    Form("bulldozing", "hegedus", 1.0, 3.0, BOTH),
    Form("flexible_wheel", "arc", 1e-4, 3e-4, BOTH, library=True),
    # The library has both arms of the torque in one effect: that of the arc (its arm share is 1) and the axle's height (0).
    Form("flexible_wheel", "axle", 1e-4, 3e-4, BOTH, library=True),
    Form("flexible_wheel", "load", 1e-4, 3e-4, BOTH, library=True),
    Form("flexible_wheel", "schmid", 3e-5, 1e-4, BOTH),
    Form("rate", "grahn", 0.2, 0.4, BOTH, library=True),
    Form("rate", "logarithm", 0.15, 0.3, BOTH),
    Form("soft_patch", "window", 0.5, 0.8, R, library=True),
    Form("soft_patch", "bell", 0.5, 0.8, R),
    Form("slope_strength", "linear", 0.3, 0.4, R, library=True),
    Form("slope_strength", "quadratic", 0.35, 0.7, R),
    Form("coulomb_friction", "constant", 0.2, 1.0, BOTH, library=True),
    Form("coulomb_friction", "stribeck", 0.2, 1.0, BOTH),
    Form("viscous_friction", "linear", 0.1, 0.5, BOTH, library=True),
    Form("viscous_friction", "power", 0.1, 0.5, BOTH),
    Form("gear_efficiency", "constant", 0.3, 0.5, BOTH, library=True),
    Form("gear_efficiency", "load", 0.25, 0.4, BOTH),
    Form("torque_scale", "gain", 0.1, 0.2, BOTH, library=True, signed=True),
    Form("torque_scale", "saturating", 0.1, 0.2, BOTH, signed=True),
    Form("winding_heat", "loss", 20.0, 30.0, R, library=True),
    Form("winding_heat", "ramp", 20.0, 30.0, R),
    Form("radius_scale", "scale", 0.03, 0.1, BOTH, library=True, signed=True),
    Form("radius_scale", "odometry", 0.03, 0.1, R, library=True, signed=True),
    Form("radius_scale", "worn", 0.03, 0.1, BOTH, signed=True),
    Form("payload", "mass", 1.0, 3.0, BOTH, library=True),
    Form("payload", "deck", 1.0, 3.0, R),
    Form("centre_of_mass", "along", 0.05, 0.15, R, library=True, signed=True),
    Form("centre_of_mass", "both", 0.05, 0.15, R, signed=True),
    Form("pitch_bias", "constant", 0.02, 0.1, R, library=True, signed=True),
    Form("pitch_bias", "drifting", 0.02, 0.1, R, signed=True),
    Form("drag", "constant", 3.0, 15.0, BOTH, library=True),
    # Both of the library's forms at once, with the growth of a usual cable.
    Form("drag", "speed", 3.0, 15.0, BOTH),
    Form("drag", "growth", 10.0, 50.0, BOTH, library=True),
    Form("tether", "linear", 1.0, 8.0, R, library=True),
    Form("tether", "slack", 1.0, 8.0, R),
    Form("sensor_lag", "first_order", 0.2, 1.0, R, library=True),
    Form("sensor_lag", "dead_time", 0.2, 1.0, R),
    # A sticking limit bites only where it is far below the soil's strength.
    Form("rim_adhesion", "minimum", 0.4, 0.7, BOTH, library=True, rival=0.3),
    # A rounded limit as the library's, of the roundings 1/6 and 1/2.
    Form("rim_adhesion", "smooth", 0.4, 0.7, BOTH, rival=0.3),
    Form("rim_adhesion", "round", 0.4, 0.7, BOTH, library=True, rival=0.3),
    Form("rolling_resistance", "moment", 0.05, 0.2, BOTH, library=True),
    Form("rolling_resistance", "hertz", 0.05, 0.2, BOTH, library=True),
    # Between the library's two laws.
    Form("rolling_resistance", "sphere", 0.05, 0.2, BOTH),
    Form("suspension_friction", "constant", 1.0, 5.0, R, library=True, jointed=True),
    Form("suspension_friction", "stribeck", 1.0, 5.0, R, jointed=True),
    Form("hump", "slip", 0.05, 0.3, BOTH, outside=True, signed=True),
    Form("ripple", "turn", 0.3, 3.0, BOTH, outside=True),
    Form("drift", "order", 5.0, 40.0, W, outside=True, signed=True),
    Form("drift", "time", 1.0, 10.0, R, outside=True, signed=True),
]

# Effects of the library that have a parameter for each of their forms, which may therefore act together.
TOGETHER = ("slip_sinkage", "flexible_wheel", "drag", "radius_scale", "rolling_resistance")

# Cases that hide no effect but mislead: what is stated about the experiment is wrong, or it is too small to tell.
CAUTION = ("wrong_prior", "noise_half", "noise_double", "poor")


def find(kind, case, form=None):
    """The form of a case; its library form where none is named."""
    known = [f for f in FORMS if f.case == case and kind in f.kinds]
    if not known:
        raise SystemExit(f"no case `{case}` of kind {kind}; known are {', '.join(cases_of(kind, True))}")
    if form is None:
        return next((f for f in known if f.library), known[0])
    for f in known:
        if f.form == form:
            return f
    raise SystemExit(f"no form `{form}` of {case}; known are {', '.join(f.form for f in known)}")


def cases_of(kind, jointed=False):
    return list(dict.fromkeys(f.case for f in FORMS if kind in f.kinds and (jointed or not f.jointed)))


def library(kind, jointed=False):
    """The library's forms, that a diagnosis of this kind chooses from; an effect of two parameters has several."""
    return [f for f in FORMS if f.library and kind in f.kinds and (jointed or not f.jointed)]
