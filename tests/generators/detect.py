"""How strong a hidden effect must be to be seen, and what it can be confused with.

The signature of an effect is what it changes in the clean signals. Whitened with the true noise and freed of everything
that the calibrated soil parameters can take up (`refit`), its length is the number of
standard deviations by which the effect stands out: 5 give 80 % power at p = 0.01 corrected for the candidates, and a test
asks for at least 1.5 times that. How alike a rival is to the hidden effect follows from a fit with the rival in its place
(`Detector.cosine_in_place`).
"""

import copy

import numpy as np

import cases
import conditions
import noise
from refit import STEP, Free, finding_fit, finding_in_place, promised
from soils import CALIBRATED

DETECTABLE = 5.0  # standard deviations
TIE = 0.8  # cosine from which two effects are an honest tie
DELAY_STEP = 0.02  # s
SEARCHES = 8  # strengths tried


class Detector:
    """Signatures at one bench (rig, soil, conditions). `bench.simulate` takes a list of changed parameters."""

    def __init__(self, bench, noise_level, replicates, rivals):
        self.bench, self.rivals, self.level = bench, rivals, noise_level
        self.free = Free(bench.soil)
        soil = [{name: bench.soil[name] * (1.0 + STEP)} for name in CALIBRATED]
        late = [{"body_delay": conditions.DELAY + DELAY_STEP}] if "delay" in bench.conditions else []
        self.nuisances = len(late)
        clean, *changed = bench.simulate([{}] + soil + late, coarse=True)
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
        # A delay that nobody states is free to take up what it can.
        late = [self.white(y - self.clean) for y in self.changed[len(self.changed) - self.nuisances :]]
        self.late = orthonormal(np.stack(late, axis=1)) if late else None
        self.slopes = np.stack([self.told(y) for y in soil], axis=1)

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

    def told(self, difference):
        """The same without what an unstated delay takes up."""
        white = self.white(difference)
        return white if self.late is None else white - self.late @ (self.late.T @ white)

    def strength_at(self, form, sign, target, other=None):
        """The strength whose signature is `target` deviations long, and the length reached: less where the bound of the
        form comes first, or the rig no longer runs. `other` is a second effect's signature that may vary freely too.
        """
        return alone(self.bench, self.finding_strength(form, sign, target, other))[:2]

    def finding_strength(self, form, sign, target, other=None):
        """The same as a search for :func:`side_by_side`, and {size of a strength: its fit}."""
        tried, fits = {}, {}

        def length(size):
            if size not in tried:
                signals = yield from effect(form, sign * size)
                fit = yield from finding_fit(self, signals, *nearest(fits, size))
                tried[size] = float(np.linalg.norm(self.without(promised(self, fit), other)))
                if np.isfinite(tried[size]):
                    fits[size] = fit
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
        return sign * best, tried[best], fits

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
        """What is left of the difference to the clean signals after the soil is refitted to it."""
        return alone(self.bench, self.finding_signature(signals))

    def finding_signature(self, signals):
        """The same as a search for :func:`side_by_side`."""
        fit = yield from finding_fit(self, signals)
        return promised(self, fit)

    def cosine_in_place(self, hidden, own, rival):
        """How alike two effects are where the rival is fitted in the place of one: sqrt(1 - d^2/l^2), with l what a fit of the soil and of the
        other hidden effects leaves, in standard deviations, and d what is left where the rival is fitted too.

        `hidden` {form: strength} is all that acts, `own` the form whose place the case `rival` takes. Where the signals are linear in all
        parameters and no bound is met this is the cosine of the two signatures. NaN where the rig does not run.
        """
        (signals,) = self.bench.simulate([{form.key: strength for form, strength in hidden.items()}], coarse=True)
        others = [form for form in hidden if form is not own]
        return alone(self.bench, self.finding_cosine(signals, others, in_place_of(self.rivals, rival)))

    def finding_cosine(self, signals, others, choices):
        """The same as a search for :func:`side_by_side`; `choices` are sets of the rival's forms, the best of which counts."""
        soil, without = (yield from finding_fit(self, signals)), self.with_free(others)
        rest = (yield from finding_in_place(without, signals, soil)) if others else soil
        length, least = np.linalg.norm(promised(without, rest)), np.nan
        for forms in choices:
            detector = self.with_free([*others, *forms])
            fit = yield from finding_in_place(detector, signals, rest)
            least = np.fmin(least, np.linalg.norm(promised(detector, fit)))
        return float(np.sqrt(np.maximum(0.0, 1.0 - (least / length) ** 2)))

    def with_free(self, forms):
        """The same with strengths of effects free besides the soil."""
        other = copy.copy(self)
        other.free = Free(self.bench.soil, forms)
        return other


def in_place_of(library, case):
    """Sets of forms that a fit may have free as one effect: all of them where the effect has a parameter for each, else each alone."""
    forms = [form for form in library if form.case == case]
    return [forms] if case in cases.TOGETHER else [[form] for form in forms]


def nearest(fits, size):
    """Of {size of a strength: fit} the fit nearest to a size, and the size's ratio to its own."""
    near = min(fits, key=lambda known: abs(np.log(size / known)), default=None)
    return (fits[near], size / near) if fits else (None, 1.0)


def effect(form, strength):
    """The search for the signals with one effect: one simulation, NaN where the rig does not run."""
    (signals,) = yield [{form.key: strength}], True
    return signals


def alone(bench, search):
    """Runs a search; gives its result."""
    (result,) = side_by_side(bench, [search])
    if isinstance(result, ValueError):
        raise result
    return result


def side_by_side(bench, searches):
    """Runs searches, those simulations of which none needs another's result as one: many small ones take the time of a few.

    A search is a generator: it yields a list of changed parameters and whether coarse steps do, and is sent the signals of each. Gives
    the results in order; in the place of one that raised ValueError the error.
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
                signals = bench.simulate([change for k in members for change in asked[k][0]], coarse=coarse)
                ends = np.cumsum([len(asked[k][0]) for k in members])
                for k, own in zip(members, np.split(signals, ends[:-1])):
                    go_on(k, own)
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


def ties(cosines, case):
    """Of {case: cosine} those that count as right when they are tied with the hidden case: their signature is like its own."""
    return sorted(name for name, cosine in cosines.items() if name != case and cosine > TIE)
