"""How strong a hidden effect must be to be seen, and what it can be confused with.

The signature of an effect is what it changes in the clean signals. Whitened with the true noise and freed of everything
that the calibrated soil parameters can take up (their sensitivities by finite differences), its length is the number of
standard deviations by which the effect stands out: 5 give 80 % power at p = 0.01 corrected for the candidates, and a test
asks for at least 1.5 times that. The cosine of two such signatures says how alike two effects are.
"""

import numpy as np

import noise
from soils import CALIBRATED

DETECTABLE = 5.0  # standard deviations
TIE = 0.8  # cosine from which two effects are an honest tie
STEP = 1e-3  # of a soil parameter, relative
GRID = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0)  # strengths tried, of the bound


class Detector:
    """Signatures at one bench (rig, soil, conditions). `bench.simulate` takes a list of changed parameters."""

    def __init__(self, bench, noise_level, replicates, rivals):
        self.bench, self.rivals = bench, rivals
        soil = [{name: bench.soil[name] * (1.0 + STEP)} for name in CALIBRATED]
        effects = [{f.key: f.probe} for f in rivals]
        clean, *changed = bench.simulate([{}] + soil + effects)
        self.clean = clean
        self.deviation = noise_level * bench.size(clean)
        self.weight = np.sqrt(replicates) * noise.whitener(clean.shape[1])
        soil_part = [self.white(y - clean) / STEP for y in changed[: len(soil)]]
        self.basis = orthonormal(np.stack(soil_part, axis=1))
        self.signatures = [self.free(self.white(y - clean)) for y in changed[len(soil) :]]

    def white(self, difference):
        """Whitened and flat; runs, rows, signals in."""
        return np.einsum("ij,gjs->gis", self.weight, difference / self.deviation).ravel()

    def free(self, signature):
        """Without what the soil parameters take up."""
        return signature - self.basis @ (self.basis.T @ signature)

    def strength_at(self, form, sign, target, other=None):
        """The strength whose signature is `target` deviations long; the bound and what it reaches where that is less.

        Also sets `strongest`, the largest strength that can be simulated. `other` is a second effect's whitened signature that may vary freely too.
        """
        tries = [sign * share * form.bound for share in GRID]
        lengths = np.array([np.linalg.norm(self.without(self.signature(y), other)) for y in self.effects(form, tries)])
        # Beyond the last strength with which the rig still runs there is nothing to measure.
        runs = len(tries) if np.all(np.isfinite(lengths)) else int(np.argmin(np.isfinite(lengths)))
        tries, lengths = tries[:runs], lengths[:runs]
        if not tries:
            raise ValueError(f"{form.key}: the rig does not run even with {sign * GRID[0] * form.bound:.3g}")
        self.strongest = abs(tries[-1])
        if not np.any(lengths >= target):
            return tries[-1], float(lengths[-1])
        first = int(np.argmax(lengths >= target))
        if first == 0:
            return tries[0] * target / lengths[0], float(target)
        low, high = np.log(np.maximum(lengths[first - 1], 1e-9)), np.log(lengths[first])
        share = (np.log(target) - low) / (high - low)
        return float(tries[first - 1] * (tries[first] / tries[first - 1]) ** share), float(target)

    def without(self, signature, other):
        if other is None:
            return signature
        return signature - other * (other @ signature) / (other @ other)

    def effects(self, form, strengths):
        """Signals at several strengths; NaN where the soil no longer carries the wheel."""
        return self.bench.simulate([{form.key: s} for s in strengths])

    def signature(self, signals):
        return self.free(self.white(signals - self.clean))

    def alike(self, signature):
        """Cosine of this signature with that of every rival, {case: cosine}, and the rivals that one cannot see at all."""
        length = np.linalg.norm(signature)
        cosines = {}
        for form, rival in zip(self.rivals, self.signatures):
            size = np.linalg.norm(rival)
            cosines[form.case] = float(rival @ signature / (size * length)) if size > 0.0 and length > 0.0 else 0.0
        return cosines


def orthonormal(columns):
    """Orthonormal basis of the columns; directions that nothing depends on are left out."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > 0.0] / size[size > 0.0]
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, values > 1e-7 * values[0]]


def ties(cosines, case, signed):
    """Cases that count as right when they are named or tied: their signature cannot be told from the hidden one."""
    alike = lambda name, c: abs(c) if name in signed else c
    return sorted(name for name, c in cosines.items() if name != case and alike(name, c) > TIE)
