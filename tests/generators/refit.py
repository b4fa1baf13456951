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
SMALL_SHIFT = 0.01  # of a soil parameter, relative, for which the projection is exact enough
# Further steps tell nothing new where what the slopes promise changes relatively by less than SAME and what is left is near it.
SAME, NEAR = 0.03, 1.2
DAMPING, FACTOR = 1e-3, 10.0  # of the first step, and from one that is tried to the next
MOST_DAMPING = 10.0


@dataclass
class Fit:
    """`left`: the whitened difference at the fitted soil, an unstated delay freed; `shift`: by which shares the soil differs from the
    true one; `signals`: the clean signals of that soil; `slopes`: whitened, a column for each soil parameter, at that soil."""

    left: np.ndarray
    shift: np.ndarray
    signals: np.ndarray
    slopes: np.ndarray | None = None


def finding_fit(detector, signals, start=None, ratio=1.0):
    """The :class:`Fit` of the soil to `signals`, as a search for `detect.side_by_side`; NaN is left where the rig does not run. `start`: the
    fit of a similar effect, the shift of which times `ratio` is tried first."""
    fit = Fit(detector.told(signals - detector.clean), np.zeros(len(CALIBRATED)), detector.clean, detector.slopes)
    if not np.all(np.isfinite(fit.left)):
        return fit
    if start is not None and np.any(start.shift) and ratio == 1.0:
        near = Fit(detector.told(signals - start.signals), start.shift, start.signals, start.slopes)
        fit = near if leaves_less(near, fit) else fit
    elif start is not None and np.any(start.shift):
        (near,) = yield from finding_there(detector, signals, [within(detector, ratio * start.shift)])
        if leaves_less(near, fit):
            near.slopes = yield from finding_slopes(detector, near)
            fit = near if np.all(np.isfinite(near.slopes)) else fit
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
        there = yield from finding_there(detector, signals, [within(detector, fit.shift + step_of(detector, fit, one)[0]) for one in tried])
        better = [(np.linalg.norm(one.left), k) for k, one in enumerate(there) if leaves_less(one, fit)]
        if better:
            _, k = min(better)
            return there[k], tried[k]
        damping *= FACTOR**3
    return None, damping


def finding_there(detector, signals, shifts):
    """Fits at these soils, without slopes."""
    there = yield [soil_at(detector, shift) for shift in shifts], True
    return [Fit(detector.told(signals - y), shift, y) for y, shift in zip(there, shifts)]


def leaves_less(one, other):
    return bool(np.all(np.isfinite(one.left)) and np.linalg.norm(one.left) < np.linalg.norm(other.left))


def step_of(detector, fit, damping):
    """Shares by which the soil is to change within its bounds, and which parameters no bound then holds."""
    low, high = bounds(detector) - fit.shift
    step, free = np.zeros(len(CALIBRATED)), np.ones(len(CALIBRATED), bool)
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
    """What is left where the soil goes on along the slopes as far as its bounds allow it; NaN where the rig does not run."""
    if not np.all(np.isfinite(fit.left)):
        return fit.left
    step, _ = step_of(detector, fit, 0.0)
    return fit.left - fit.slopes @ step


def free_slopes(detector, fit):
    """Slopes of the parameters that no bound holds."""
    _, free = step_of(detector, fit, 0.0)
    return fit.slopes[:, free]


def finding_slopes(detector, fit):
    """Whitened slopes of the soil parameters at the soil of a fit; backwards at an upper bound."""
    ends = within(detector, fit.shift + STEP * (1.0 + fit.shift))
    steps = np.where(ends - fit.shift > 0.5 * STEP * (1.0 + fit.shift), STEP, -STEP) * (1.0 + fit.shift)
    there = yield [soil_at(detector, fit.shift + step * unit) for step, unit in zip(steps, np.eye(len(steps)))], True
    return np.stack([detector.told(y - fit.signals) / step for y, step in zip(there, steps)], axis=1)


def soil_at(detector, shift):
    return {name: detector.bench.soil[name] * (1.0 + s) for name, s in zip(CALIBRATED, shift)}


def within(detector, shift):
    """The shift as far as the bounds allow it."""
    return np.clip(shift, *bounds(detector))


def bounds(detector):
    """Least and largest shift of each parameter."""
    true = np.array([detector.bench.soil[name] for name in CALIBRATED])
    return np.array([BOUNDS[name] for name in CALIBRATED]).T / true - 1.0
