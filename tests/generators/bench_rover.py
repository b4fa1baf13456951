"""The rover bench: a soil, and runs over planes up and down and over hills, with two masses and changing speeds."""

import numpy as np

import carriage
import conditions
import contact
import soils
import terrain
import traverse
import vehicles
from linkage import Linkage

# Slope of the plane (deg), height and length of the hills (m), added mass (kg), first and second wheel speed (rad/s).
FULL = (
    (0.0, 0.08, 2.0, 0.0, 1.5, 3.0),
    (0.0, 0.08, 2.0, 3.0, 3.0, 1.5),
    (8.0, 0.0, 1.0, 0.0, 3.0, 1.5),
    (8.0, 0.0, 1.0, 3.0, 1.5, 2.2),
    (-8.0, 0.0, 1.0, 0.0, 1.5, 2.2),
    (-8.0, 0.0, 1.0, 3.0, 3.0, 1.5),
)
REDUCED = (FULL[0], FULL[2], FULL[5], FULL[1])
POOR = ((0.0, 0.0, 1.0, 0.0, 2.0, 2.0),)
TIMES = {"full": (24.0, 0.2), "long": (30.0, 0.1), "reduced": (9.0, 0.1)}  # s a run, s a row
# Steps from row to row. With steps twice as long lugs on stiff soil (seed 1009) had torques that were off by 0.24 of the noise, 81 of
# chi-square over the experiment, and a diagnosis named a second effect for it; with these it is 0.6.
HALVES = (0.05, 0.05, 0.1, 0.1, 0.15, 0.15, 0.2, 0.2)
PARTS = {"full": (0.025, 0.025, 0.05, 0.05, 0.1, 0.1, 0.15, 0.15, 0.175, 0.175), "long": HALVES, "reduced": HALVES}
COARSE = (0.3, 0.7)  # while signatures are compared
REPLICATES = {"full": 3, "long": 3, "reduced": 2}
RISE = 2.0  # s, over which a speed is reached
ROLLED_IN = 1.0  # rad that a wheel turns until its contact is established; before that nothing counts as detectable
LEAST_WAY = 0.25  # of what the rims roll: a rover that slips more is stuck
DEEPEST = 0.05  # m, sinkage: beyond it the belly comes near the ground
NODES = 8  # a zone while signatures are compared


def commands(first, second, rows, row_time):
    """Wheel speed row by row: up from rest over two seconds, to the second speed at 45 % and back half way at 75 %."""
    time = row_time * np.arange(rows)
    rise = lambda start: np.clip((time - start) / RISE, 0.0, 1.0)
    end = time[-1]
    return first * rise(-row_time) + (second - first) * (rise(0.45 * end) - 0.5 * rise(0.75 * end))


class RoverBench:
    kind = "traverse"

    def __init__(self, seed, size="full", poor=False, under=(), soil=None):
        """`soil` as name and parameters: the one to drive on; RuntimeError where it does not carry the rover up the slopes."""
        self.conditions = conditions.check(under)
        vehicle = self.vehicle = conditions.vehicle(under)
        self.model, self.jointed = vehicle.model, bool(vehicle.links)
        self.every_signal = traverse.signals(vehicle)
        self.signals = conditions.recorded(self.every_signal, under)
        self.columns = [self.every_signal.index(name) for name in self.signals]
        self.own_noise = conditions.own_noise(self.signals, under)
        self.size_name, self.replicates = size, REPLICATES[size]
        self.duration, self.row_time = TIMES[size]
        self.set_points = POOR if poor else REDUCED if size == "reduced" else FULL
        self.rows = round(self.duration / self.row_time) + 1
        self.between = conditions.between_rows(self.rows, self.row_time, seed, under)
        self.waves = conditions.waves(seed, under)
        slope, height, length, added, first, second = np.array(self.set_points).T
        self.slope, self.height, self.length = np.tan(np.radians(slope)), height, length
        self.mass = vehicle.parameters["mass"] + added
        one = np.stack([commands(a, b, self.rows, self.row_time) for a, b in zip(first, second)], axis=1)
        one *= conditions.directions(len(self.set_points), under)
        self.commands = np.repeat(one[..., None], len(vehicle.wheels), axis=-1)
        turned = np.abs(np.cumsum(one, axis=0)) * self.row_time
        self.skip = int(np.max(np.argmax(turned >= ROLLED_IN, axis=0))) + 1
        rng = np.random.default_rng([seed, 1])
        self.extra = {"patch_at": 1.2, "patch_half": 0.3, "hump_at": 0.12, "hump_width": 0.03}
        if "delay" in under:
            self.extra["body_delay"] = conditions.DELAY
        for _ in range(200 if soil is None else 1):
            self.soil_name, self.soil = soil or soils.draw(rng, vehicle.parameters["width"], firm=True)
            if self.climbs() and (not self.waves or np.all(np.isfinite(self.simulate([{}], coarse=True)))):
                return
        raise RuntimeError("no soil carries the rover over these slopes")

    def climbs(self):
        """Whether wheels under the heaviest rover climb the steepest slope with less than 45 % slip."""
        p = {**self.vehicle.parameters, "mass": self.mass.max()}
        linkage = Linkage(p, self.vehicle)
        loads = vehicles.shares(linkage) * linkage.total * p["gravity"]
        rise = max(np.max(self.slope), np.max(np.pi * self.height / self.length), 0.0)
        pull, *_ = np.moveaxis(carriage.steady_points({**p, **self.soil}, loads, 0.45, 2.0), -1, 0)
        return bool(pull.sum() > loads.sum() * rise)

    def way(self):
        """What the rims roll, m; negative backwards. Uneven rows count as even ones, which is close enough for a limit."""
        return self.vehicle.parameters["radius"] * self.row_time * self.commands[:, :, 0].sum(axis=0)

    def time(self):
        """Time of each row, s."""
        if "jitter" in self.conditions:
            return np.concatenate([[0.0], np.cumsum(self.between[: self.rows - 1])])
        return self.row_time * np.arange(self.rows)

    def simulate(self, changes, coarse=False, parts=None):
        """Clean signals for each dict of changed parameters: (change, run, row, signal); NaN in runs that get stuck.

        A parameter is a number, or one for each run. `coarse` takes larger steps and fewer nodes, for differences between simulations."""
        runs, tries = len(self.set_points), len(changes)
        nodes = NODES if coarse else contact.NODES
        parts = parts or (COARSE if coarse else PARTS[self.size_name])
        repeat = lambda value: np.tile(value, tries)
        p = {**self.vehicle.parameters, **self.soil, **self.extra, "mass": repeat(self.mass)}
        for name in {name for change in changes for name in change}:
            default = self.soil.get(name, self.extra.get(name, 0.0))
            p[name] = np.concatenate([np.broadcast_to(change.get(name, default), runs) for change in changes])
        profile = terrain.Profile(repeat(self.slope), repeat(self.height), repeat(self.length), self.waves)
        orders = np.tile(self.commands, (1, tries, 1))
        with np.errstate(all="ignore"):
            y = traverse.drive_runs(p, profile, orders, self.between[: self.rows - 1], parts, nodes, vehicle=self.vehicle)
        way = repeat(self.way())
        sinkages = [k for k, name in enumerate(self.every_signal) if name.endswith("sinkage")]
        sunk = np.any(y[..., sinkages] > DEEPEST, axis=(0, 2))
        stuck = ~(y[-1, :, 0] * np.sign(way) > LEAST_WAY * np.abs(way)) | sunk
        y[:, stuck] = np.nan
        return y[..., self.columns].reshape(self.rows, tries, runs, -1).transpose(1, 2, 0, 3)

    def size(self, clean):
        """RMS of each signal over the experiment."""
        return np.sqrt(np.mean(clean**2, axis=(0, 1)))

    def parameters(self):
        return self.vehicle.stated()

    def write(self, folder, runs):
        """Writes the CSV files; `runs` is (group, replicate, signals). Gives the lines of experiment.toml."""
        lines, grounds = [], {}
        (folder / "runs").mkdir(parents=True, exist_ok=True)
        time, way = self.time(), self.way()
        profile = terrain.Profile(self.slope, self.height, self.length, self.waves)
        level = not self.waves
        for group, replicate, measured in runs:
            slope, height, length, added, first, second = self.set_points[group]
            label = f"slope{slope:g}_hill{100 * height:g}_add{added:g}_speed{first:g}_{second:g}"
            ground = f"slope{slope:g}_hill{100 * height:g}.csv"
            flat = level and not slope and not height
            if ground not in grounds and not flat:
                x, z = profile.rows(group, min(way.min(), 0.0) - 2.0, way.max() + 2.0)
                rows = ["x,z"] + [f"{a:.4f},{b:.9f}" for a, b in zip(x, z)]
                (folder / ground).write_text("\n".join(rows) + "\n", encoding="ascii", newline="\n")
                grounds[ground] = True
            orders = tuple(f"wheel[{k + 1}].speed_command" for k in range(self.commands.shape[-1]))
            rows = [",".join(("time",) + orders + self.signals)]
            for t, speeds, values in zip(time, self.commands[:, group], measured):
                cells = ["" if np.isnan(v) else f"{v:.{traverse.DECIMALS}f}" for v in values]
                rows.append(",".join([f"{t:.3f}"] + [f"{speed:.6g}" for speed in speeds] + cells))
            name = f"runs/{label}_{'abcdef'[replicate]}.csv"
            (folder / name).write_text("\n".join(rows) + "\n", encoding="ascii", newline="\n")
            lines += ["", "[[run]]", f'file = "{name}"', f'group = "{label}"', "x0 = 0.0"]
            if not flat:
                lines.append(f'terrain = "{ground}"')
            if added:
                lines.append(f'parameters = {{ "rover.mass" = {self.mass[group]:g} }}')
        return lines
