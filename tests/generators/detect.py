"""How strong a hidden effect must be to be seen, and what it can be confused with.

The signature of an effect is what it changes in the clean signals. Whitened with the true noise and freed of everything
that the calibrated soil parameters can take up (their sensitivities by finite differences), its length is the number of
standard deviations by which the effect stands out: 5 give 80 % power at p = 0.01 corrected for the candidates, and a test
asks for at least 1.5 times that. The cosine of two such signatures says how alike two effects are.
"""

import copy

import numpy as np

import conditions
import noise
from soils import CALIBRATED

DETECTABLE = 5.0  # standard deviations
TIE = 0.8  # cosine from which two effects are an honest tie
STEP = 1e-3  # of a soil parameter, relative
DELAY_STEP = 0.02  # s
SEARCHES = 8  # strengths tried
REFITS = 8
SMALL_SHIFT = 0.01  # of a soil parameter, relative, for which the projection is exact enough
SHIFTS = (-0.9, 2.0)  # of a soil parameter, relative: as far as a calibration may take it
WORTH = 0.98  # share of what is left from which on a further refit is not worth it
SHORTER = 0.9  # share of the projection's length below which the refitted signature is taken


class Detector:
    """Signatures at one bench (rig, soil, conditions). `bench.simulate` takes a list of changed parameters."""

    def __init__(self, bench, noise_level, replicates, rivals):
        self.bench, self.rivals, self.level = bench, rivals, noise_level
        soil = [{name: bench.soil[name] * (1.0 + STEP)} for name in CALIBRATED]
        effects = [{f.key: f.probe} for f in rivals]
        late = [{"body_delay": conditions.DELAY + DELAY_STEP}] if "delay" in bench.conditions else []
        self.nuisances = len(late)
        clean, *changed = bench.simulate([{}] + soil + effects + late, coarse=True)
        self.clean = clean
        self.deviation = noise_level * bench.size(clean)
        self.changed, self.replicates = changed, replicates
        self.prepare()

    def prepare(self):
        """Weights, slopes and signatures at the present level of noise."""
        count, rows = len(CALIBRATED), self.clean.shape[1] - self.bench.skip
        # Cells that are not recorded tell nothing.
        told = np.sqrt(self.replicates * (1.0 - (conditions.GAPS if "gaps" in self.bench.conditions else 0.0)))
        self.weight, self.scatter = told * noise.whitener(rows), None
        self.own_weights = {
            k: told * self.deviation[k] * noise.whitener(rows, self.deviation[k], own)
            for k, own in enumerate(self.bench.own_noise)
            if own > 0.0
        }
        soil = [(y - self.clean) / STEP for y in self.changed[:count]]
        if "soil_scatter" in self.bench.conditions:
            shares = [conditions.SCATTER.get(name, 0.0) for name in CALIBRATED]
            self.scatter = [run_scatter(columns) for columns in self.by_run(soil, shares)]
        self.slopes = np.stack([self.white(y) for y in soil], axis=1)
        # A delay that nobody states is free to take up what it can.
        late = [self.white(y - self.clean) for y in self.changed[len(self.changed) - self.nuisances :]]
        self.basis = orthonormal(np.column_stack([self.slopes, *late]))
        rivals = self.changed[count : len(self.changed) - self.nuisances]
        self.signatures = [self.free(self.white(y - self.clean)) for y in rivals]

    def by_run(self, soil, shares):
        """For each run the change of its whitened signals by one standard deviation of each soil parameter's scatter from run
        to run: (runs, values, parameters)."""
        columns = [share * self.white(y).reshape(len(self.clean), -1) for y, share in zip(soil, shares)]
        return np.stack(columns, axis=2) / np.sqrt(self.replicates)

    def with_noise(self, level):
        """The same bench under another level of noise."""
        if level == self.level:
            return self
        other = copy.copy(self)
        other.level, other.deviation = level, self.deviation * (level / self.level)
        other.prepare()
        return other

    def white(self, difference):
        """Whitened and flat; runs, rows, signals in."""
        scaled = difference[:, self.bench.skip :] / self.deviation
        white = np.einsum("ij,gjs->gis", self.weight, scaled)
        for k, weight in self.own_weights.items():
            white[..., k] = scaled[..., k] @ weight.T
        if self.scatter is not None:
            runs = white.reshape(len(white), -1)
            white = np.stack([run - u @ (shrink * (u.T @ run)) for run, (u, shrink) in zip(runs, self.scatter)])
        return white.ravel()

    def free(self, signature):
        """Without what the soil parameters take up."""
        return signature - self.basis @ (self.basis.T @ signature)

    def strength_at(self, form, sign, target, other=None):
        """The strength whose signature is `target` deviations long, and the length reached: less where the bound of the
        form comes first, or the rig no longer runs. `other` is a second effect's signature that may vary freely too.
        """
        return alone(self.bench, self.finding_strength(form, sign, target, other))

    def finding_strength(self, form, sign, target, other=None):
        """The same as a search for :func:`side_by_side`."""
        tried = {}

        def length(size):
            if size not in tried:
                signals = yield from effect(form, sign * size)
                signature = yield from self.finding_signature(signals)
                tried[size] = float(np.linalg.norm(self.without(signature, other)))
            return tried[size]

        runs, at = 0.0, form.probe
        limit = form.bound
        for _ in range(SEARCHES):
            reached = yield from length(at)
            if not np.isfinite(reached):
                limit = at  # the rig does not run there
                at = 0.5 * (runs + at)
                continue
            runs = max(runs, at)
            if abs(reached / target - 1.0) < 0.02 or (reached < target and at > 0.99 * limit):
                break
            at = min(at * self.factor(tried, at, reached, target), limit if limit == form.bound else 0.5 * (runs + limit))
        best = min((size for size in tried if np.isfinite(tried[size])), key=lambda size: abs(tried[size] - target), default=None)
        if best is None:
            raise ValueError(f"{form.key}: the rig does not run even with {sign * at:.3g}")
        return sign * best, tried[best]

    def factor(self, tried, at, reached, target):
        """By how much to change the strength: the length is nearly a power of it."""
        other = [size for size in tried if size != at and np.isfinite(tried[size]) and tried[size] > 0.0]
        power = 1.0
        if other and reached > 0.0:
            near = min(other, key=lambda size: abs(np.log(size / at)))
            power = np.log(tried[near] / reached) / np.log(near / at)
        return float(np.clip((target / max(reached, 1e-9)) ** (1.0 / np.clip(power, 0.5, 4.0)), 1e-3, 1e2))

    def effect(self, form, strength):
        """Signals with one effect; NaN where the rig does not run."""
        return alone(self.bench, effect(form, strength))

    def without(self, signature, other):
        if other is None:
            return signature
        return signature - other * (other @ signature) / (other @ other)

    def signature(self, signals):
        """What is left of the difference to the clean signals after the soil is refitted to it: damped Gauss-Newton steps
        with the slopes at the true soil while they help, the rest by projection; by projection alone where that says the same."""
        return alone(self.bench, self.finding_signature(signals))

    def finding_signature(self, signals):
        """The same as a search for :func:`side_by_side`."""
        left, shift = self.white(signals - self.clean), np.zeros(len(CALIBRATED))
        projected = best = self.free(left)
        if not np.all(np.isfinite(left)):
            return projected
        for _ in range(REFITS):
            step = np.linalg.lstsq(self.slopes, left, rcond=1e-7)[0]
            if np.max(np.abs(step)) < SMALL_SHIFT:
                break
            moved = yield from self.refitted(signals, shift, step, np.linalg.norm(left))
            if moved is None or np.linalg.norm(moved[1]) > WORTH * np.linalg.norm(left):
                break
            shift, left = moved
            best = min(best, self.free(left), key=np.linalg.norm)
        # A refit turns the signature too: it is taken where the projection alone would be far too long.
        return best if np.linalg.norm(best) < SHORTER * np.linalg.norm(projected) else projected

    def refitted(self, signals, shift, step, bar):
        """Shares by which the soil differs after a step, shortened until it leaves less than `bar`, and what is left."""
        for damping in (1.0, 0.5, 0.25):
            there = np.clip(shift + damping * step, *SHIFTS)
            soil = {name: self.bench.soil[name] * (1.0 + s) for name, s in zip(CALIBRATED, there)}
            left = self.white(signals - (yield soil, True))
            if np.all(np.isfinite(left)) and np.linalg.norm(left) < bar:
                return there, left
        return None

    def alike(self, signature):
        """Cosine of this signature with that of every rival, {case: cosine}: of its most alike form."""
        length = np.linalg.norm(signature)
        cosines = {}
        for form, rival in zip(self.rivals, self.signatures):
            size = np.linalg.norm(rival)
            cosine = float(rival @ signature / (size * length)) if size > 0.0 and length > 0.0 else 0.0
            cosines[form.case] = max(cosine, cosines.get(form.case, -1.0))
        return cosines


def effect(form, strength):
    """The search for the signals with one effect: one simulation, NaN where the rig does not run."""
    return (yield {form.key: strength}, True)


def alone(bench, search):
    """Runs a search; gives its result."""
    (result,) = side_by_side(bench, [search])
    if isinstance(result, ValueError):
        raise result
    return result


def side_by_side(bench, searches):
    """Runs searches, those simulations of which none needs another's result as one: many small ones take the time of a few.

    A search is a generator: it yields changed parameters and whether coarse steps do, and is sent the signals. Gives the results in
    order; in the place of one that raised ValueError the error.
    """
    results, wanted = [None] * len(searches), {}

    def go_on(k, signals):
        try:
            wanted[k] = searches[k].send(signals)
        except StopIteration as done:
            results[k] = done.value
        except ValueError as error:
            results[k] = error

    for k in range(len(searches)):
        go_on(k, None)
    while wanted:
        asked = dict(wanted)
        wanted.clear()
        for coarse in (True, False):
            members = [k for k, (_, c) in asked.items() if c == coarse]
            if members:
                for k, signals in zip(members, bench.simulate([asked[k][0] for k in members], coarse=coarse)):
                    go_on(k, signals)
    return results


def run_scatter(columns):
    """Directions of a run's whitened signals in which its soil scatters, and by how much these are to be shortened to be white."""
    u, size, _ = np.linalg.svd(columns, full_matrices=False)
    return u, 1.0 - 1.0 / np.sqrt(1.0 + size**2)


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
