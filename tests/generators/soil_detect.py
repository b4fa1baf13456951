"""How clearly a test of a soil shows a hidden effect, and what it can be confused with: as detect.py for wheels and rovers.

Values scatter by shares of what they are, so signatures are those of logarithms: what the effect changes in ln p or ln tau, whitened by the
scatter of whole tests, the noise along the rows and that of the cell, without what the soil's parameters can take up. Rivals are the
effects that examples/soil_tests.md lists, in the forms given there; a bottom of the box with the reach 1 and a play with a sharp corner.
"""

import numpy as np

import soil_tests as tests
from detect import DETECTABLE, orthonormal, ties

STEP = 1e-3  # of a soil parameter, relative
SOIL = {"plate_sinkage": ("k_c", "k_phi", "n"), "shear": ("c", "phi", "K")}
LIBRARY = {"softening": "shear_softening"}  # other names of effects
SEARCHES = 12
CLEAR = 1.5 * DETECTABLE
REFITS = 12
SETTLED = 1e-4  # step of a fit, of the true soil
LEAST = 0.01  # of a soil parameter other than k_c, of the true one


def conditions(kind):
    """Settings and inputs of each group, without jitter."""
    share = (np.arange(tests.ROWS) + 1.0) / tests.ROWS
    if kind == "plate_sinkage":
        return [((diameter, speed), 0.03 * share**1.5) for diameter in tests.DIAMETERS for speed in tests.SPEEDS.values()]
    return [((sigma, speed), 0.08 * share**2) for sigma in tests.STRESSES for speed in tests.SHEAR_SPEEDS.values()]


def clean(kind, setting, x, ground):
    """What the generator measures with nothing hidden, without noise; nothing depends on the speed then."""
    if kind == "plate_sinkage":
        return tests.pressure("clean", 0.0, x, setting, None, None, ground)
    return tests.shear_stress("clean", 0.0, x, setting, None, ground)


def hidden(kind, case, strength, setting, speed, x, ground):
    """What the generator measures, without noise."""
    if kind == "plate_sinkage":
        # A seating differs from test to test; its mean counts.
        if case == "seating":
            return clean(kind, setting, x + strength, ground)
        return tests.pressure(case, strength, x, setting, speed, None, ground)
    return tests.shear_stress(case, strength, x, setting, speed, ground)


def rival(name, setting, speed, x, value, ground):
    """A small effect of the library, on the clean values `value`."""
    K, width, depth = ground["K"], tests.BOX["width"], tests.BOX["depth"]
    return {
        "plate_size": lambda: value * (0.5 * setting / 0.05) ** 0.05,
        "box_walls": lambda: value * (1.0 + 0.5 * (setting / width) ** 2),
        "box_bottom": lambda: value * (1.0 + 0.2 * np.exp(-(depth - x) / setting)),
        "rate": lambda: value * (speed / 0.01) ** 0.02,
        "seating": lambda: clean("plate_sinkage", setting, x + 1e-4, ground),
        "shear_rate": lambda: value * (speed / 1e-3) ** 0.02,
        "box_friction": lambda: value + 20.0,
        "shear_play": lambda: clean("shear", setting, x - np.minimum(1e-5, x), ground),
        "shear_softening": lambda: value * (1.0 - 0.05 * (1.0 - np.exp(-((x / (3.0 * K)) ** 2)))),
    }[name]()


RIVALS = {
    "plate_sinkage": ("plate_size", "box_walls", "box_bottom", "rate", "seating"),
    "shear": ("shear_rate", "box_friction", "shear_play", "shear_softening"),
}


class Detector:
    """Signatures of effects in a test on one ground, with so much noise, soil scatter from test to test, and repeats."""

    def __init__(self, kind, ground, noise, soil, repeats=3):
        self.kind, self.ground, self.conditions = kind, ground, conditions(kind)
        lag = np.abs(np.subtract.outer(np.arange(tests.ROWS), np.arange(tests.ROWS)))
        along = soil**2 + noise**2 * tests.CORRELATION**lag
        self.weights = []
        for (setting, _), x in self.conditions:
            value = clean(kind, setting, x, ground)
            cell = tests.CELL * noise * np.sqrt(np.mean(value**2)) / value
            self.weights.append(np.sqrt(repeats) * np.linalg.inv(np.linalg.cholesky(along + np.diag(cell**2))))

    def slopes(self, ground, names):
        """Whitened slopes of the logarithms in these parameters of a soil, in units of their true values."""
        step = lambda name: {name: ground[name] + STEP * self.ground[name]}
        columns = [self.changed(lambda s, v, x, y, n=name: clean(self.kind, s, x, ground | step(n)), ground) for name in names]
        return np.column_stack(columns) / STEP

    def changed(self, other, ground):
        """Whitened change of the logarithms, all groups in one vector; `other` of setting, speed, inputs and what they give on the ground."""
        parts = []
        for weight, ((setting, speed), x) in zip(self.weights, self.conditions):
            value = clean(self.kind, setting, x, ground)
            # Nearly nothing is left of what a play takes away: ten standard deviations say the same as more.
            ratio = np.maximum(other(setting, speed, x, value) / value, 1e-3)
            parts.append(weight @ np.log(ratio))
        return np.concatenate(parts)

    def signature(self, case, strength):
        """What is left of an effect after the soil is fitted to it, within the bounds, and the directions in which that soil could still go.
        No soil has a k_c below zero: where the fit would need one, the effect shows that much more."""
        ground, names = dict(self.ground), list(SOIL[self.kind])
        for _ in range(REFITS):
            left = self.changed(lambda s, v, x, y: hidden(self.kind, case, strength, s, v, x, self.ground), ground)
            slopes = self.slopes(ground, names)
            step = np.linalg.lstsq(slopes, left, rcond=None)[0]
            for name, share in zip(tuple(names), step):
                # At most a half at once, for the next step to be as good as its slopes.
                least = 0.0 if name == "k_c" else LEAST * self.ground[name]
                ground[name] = max(ground[name] + float(np.clip(share, -0.5, 0.5)) * self.ground[name], least)
                if ground[name] == 0.0:
                    names.remove(name)
            if np.max(np.abs(step)) < SETTLED:
                break
        basis = orthonormal(slopes)
        return left - basis @ (basis.T @ left), basis, ground

    def least(self, case):
        """The smallest strength that shows clearly (1.5 times the detectable); at most 16 times the usual one where none does. The usual
        one where the law differs from the clean one even at no strength, as Wong's curve with a peak does."""
        at, known = tests.STRENGTHS[case], {}
        if np.linalg.norm(self.signature(case, 1e-6 * at)[0]) > CLEAR:
            return at
        for _ in range(SEARCHES):
            known[at] = float(np.linalg.norm(self.signature(case, at)[0]))
            if 1.0 <= known[at] / CLEAR < 1.05:
                break
            # Lengths are nearly a power of the strength, of which the two nearest tell the exponent.
            near = sorted(known, key=lambda s: abs(np.log(known[s] / CLEAR)))[:2]
            power = np.log(known[near[0]] / known[near[1]]) / np.log(near[0] / near[1]) if len(near) == 2 else 1.0
            step = np.log(1.02 * CLEAR / known[near[0]]) / np.clip(power, 0.3, 3.0)
            at = min(near[0] * float(np.exp(np.clip(step, -3.0, 3.0))), 16.0 * tests.STRENGTHS[case])
        return min((s for s in known if known[s] >= CLEAR), default=max(known))

    def truth(self, case, rng):
        """The entry of an effect in truth.json: a strength between the smallest that shows clearly and the usual one, drawn in logarithms as
        for wheels and rovers; the smallest where the usual one does not show."""
        least, usual = self.least(case), tests.STRENGTHS[case]
        at = least if least >= usual else float(least * (usual / least) ** rng.uniform())
        signature, basis, ground = self.signature(case, at)
        reached = float(np.linalg.norm(signature))
        cosines = {}
        for name in RIVALS[self.kind]:
            other = self.changed(lambda s, v, x, y, n=name: rival(n, s, v, x, y, ground), ground)
            other -= basis @ (basis.T @ other)
            size = np.linalg.norm(other) * reached
            cosines[name] = float(other @ signature / size) if size > 0.0 else 0.0
        true = LIBRARY.get(case, case)
        return {
            "case": true, "form": None, "strength": at, "deviations": reached, "visible": bool(reached >= CLEAR * 0.999),
            "allowed_ties": ties(cosines, true),
            "cosines": {name: round(cosine, 4) for name, cosine in sorted(cosines.items(), key=lambda kv: -abs(kv[1]))},
        }  # fmt: skip
