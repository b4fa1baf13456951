"""What an effect leaves once the soil is fitted to it, as a calibration fits it: Levenberg-Marquardt steps within the bounds of the
soil's parameters, with slopes taken anew where the old ones no longer lead on.

Where the soil can imitate an effect along a curved valley, slopes at the true soil alone end far from the best fit and make the
effect look several times as strong as it is.
"""

from dataclasses import dataclass

import numpy as np

from soils import BOUNDS, CALIBRATED

STEP = 1e-3  # of a soil parameter, relative
STEPS = 12  # at most
SMALL_SHIFT = 0.01  # of a soil parameter, relative, or of a usual strength, for which the projection is exact enough
# Further steps tell nothing new where what the slopes promise changes relatively by less than SAME and what is left is near it.
SAME, NEAR = 0.03, 1.2
DAMPING, FACTOR = 1e-3, 10.0  # of the first step, and from one that is tried to the next
MOST_DAMPING = 10.0


class Free:
    """What a fit may change: the calibrated parameters of the soil, as shares of their true values, and strengths of effects, in units of
    their usual strengths.

    Attributes:
        names: of the parameters as a bench knows them.
        bounds: least and largest shift of each, (2, parameters).
    """

    def __init__(self, soil, forms=()):
        self.names = [*CALIBRATED, *(form.key for form in forms)]
        true = np.array([soil[name] for name in CALIBRATED])
        shares = np.array([BOUNDS[name] for name in CALIBRATED]).T / true - 1.0
        ends = [(-form.bound if form.signed else 0.0, form.bound) for form in forms]
        self._unit = np.concatenate([true, [form.typical for form in forms]])
        self._neutral = np.concatenate([true, np.zeros(len(forms))])
        self._probes = np.array([form.probe / form.typical for form in forms])
        self.bounds = np.concatenate([shares, np.reshape(ends, (-1, 2)).T / self._unit[len(true) :]], axis=1)

    def changes(self, shift):
        """The parameters at a shift, {name: value}; of an effect that is off there is none."""
        values = self._neutral + self._unit * shift
        return {name: value for name, value, soil in zip(self.names, values, self._neutral) if soil or value}

    def steps(self, shift):
        """Differences for slopes there."""
        soil = len(shift) - len(self._probes)
        return np.concatenate([STEP * (1.0 + shift[:soil]), self._probes])

    def within(self, shift):
        """The shift as far as the bounds allow it."""
        return np.clip(shift, *self.bounds)


@dataclass
class Fit:
    """`left`: the whitened difference at the fitted parameters, an unstated delay freed; `shift`: by how much they differ from the true soil
    without effects; `signals`: the clean signals there; `slopes`: whitened, a column for each parameter, there."""

    left: np.ndarray
    shift: np.ndarray
    signals: np.ndarray
    slopes: np.ndarray | None = None


def finding_fit(detector, signals, start=None, ratio=1.0):
    """The :class:`Fit` of the soil to `signals`, as a search for `detect.side_by_side`; NaN is left where the rig does not run. `start`: the
    fit of a similar effect, the shift of which times `ratio` is tried first."""
    fit = Fit(detector.told(signals - detector.clean), np.zeros(len(detector.free.names)), detector.clean, detector.slopes)
    if not np.all(np.isfinite(fit.left)):
        return fit
    if start is not None and np.any(start.shift) and ratio == 1.0:
        near = Fit(detector.told(signals - start.signals), start.shift, start.signals, start.slopes)
        fit = near if leaves_less(near, fit) else fit
    elif start is not None and np.any(start.shift):
        (near,) = yield from finding_there(detector, signals, [detector.free.within(ratio * start.shift)])
        if leaves_less(near, fit):
            near.slopes = yield from finding_slopes(detector, near)
            fit = near if np.all(np.isfinite(near.slopes)) else fit
    return (yield from finding_least(detector, signals, fit))


def finding_in_place(detector, signals, fit):
    """The fit of all that `detector` leaves free, from one in which the last of them were off; as :func:`finding_fit`."""
    shift = np.concatenate([fit.shift, np.zeros(len(detector.free.names) - len(fit.shift))])
    start = Fit(fit.left, shift, fit.signals)
    start.slopes = yield from finding_slopes(detector, start)
    if not np.all(np.isfinite(start.slopes)):
        return Fit(np.full_like(fit.left, np.nan), shift, fit.signals)
    return (yield from finding_least(detector, signals, start))


def finding_least(detector, signals, fit):
    """Goes from a fit with slopes to the one that leaves least."""
    damping, least = DAMPING, np.linalg.norm(promised(detector, fit))
    for _ in range(STEPS):
        if np.max(np.abs(step_of(detector, fit, 0.0)[0])) < SMALL_SHIFT:
            break
        moved, damping = yield from finding_step(detector, signals, fit, damping)
        if moved is None:
            break
        moved.slopes = yield from finding_slopes(detector, moved)
        if not np.all(np.isfinite(moved.slopes)):
            break  # at the edge of where the rig runs
        fit, before, least = moved, least, np.linalg.norm(promised(detector, moved))
        if abs(least - before) < SAME * before and np.linalg.norm(fit.left) < NEAR * least:
            break
    return fit


def finding_step(detector, signals, fit, damping):
    """The fit after the best of three steps, still without slopes, and the damping of the next one; None where none leaves less."""
    while damping <= MOST_DAMPING:
        tried = [damping / FACTOR, damping, damping * FACTOR]
        there = yield from finding_there(detector, signals, [detector.free.within(fit.shift + step_of(detector, fit, one)[0]) for one in tried])
        better = [(np.linalg.norm(one.left), k) for k, one in enumerate(there) if leaves_less(one, fit)]
        if better:
            _, k = min(better)
            return there[k], tried[k]
        damping *= FACTOR**3
    return None, damping


def finding_there(detector, signals, shifts):
    """Fits at these shifts, without slopes."""
    there = yield [detector.free.changes(shift) for shift in shifts], True
    return [Fit(detector.told(signals - y), shift, y) for y, shift in zip(there, shifts)]


def leaves_less(one, other):
    return bool(np.all(np.isfinite(one.left)) and np.linalg.norm(one.left) < np.linalg.norm(other.left))


def step_of(detector, fit, damping):
    """By how much the parameters are to change within their bounds, and which of them no bound then holds."""
    low, high = detector.free.bounds - fit.shift
    step, free = np.zeros(len(low)), np.ones(len(low), bool)
    while True:
        step[free] = damped(fit.slopes[:, free], fit.left - fit.slopes[:, ~free] @ step[~free], damping)
        beyond = free & ((step < low) | (step > high))
        if not np.any(beyond):
            return step, free
        step[beyond] = np.clip(step, low, high)[beyond]
        free &= ~beyond


def damped(slopes, left, damping):
    size = np.sqrt(damping) * np.linalg.norm(slopes, axis=0)
    return np.linalg.lstsq(np.vstack([slopes, np.diag(size)]), np.concatenate([left, np.zeros(len(size))]), rcond=1e-7)[0]


def promised(detector, fit):
    """What is left where the parameters go on along the slopes as far as their bounds allow it; NaN where the rig does not run."""
    if not np.all(np.isfinite(fit.left)):
        return fit.left
    step, _ = step_of(detector, fit, 0.0)
    return fit.left - fit.slopes @ step


def finding_slopes(detector, fit):
    """Whitened slopes of the parameters at a fit; backwards at an upper bound."""
    sizes = detector.free.steps(fit.shift)
    room = detector.free.within(fit.shift + sizes) - fit.shift
    steps = np.where(room > 0.5 * sizes, sizes, -sizes)
    there = yield [detector.free.changes(fit.shift + step * unit) for step, unit in zip(steps, np.eye(len(steps)))], True
    return np.stack([detector.told(y - fit.signals) / step for y, step in zip(there, steps)], axis=1)
