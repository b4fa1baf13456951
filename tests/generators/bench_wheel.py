"""The single-wheel bench: a rig, a soil, and the set-points at which steady points are taken."""

import numpy as np

import carriage
import soils

SLIPS = (0.02, 0.06, 0.12, 0.20, 0.30, 0.40, 0.50, 0.60, 0.70)


class WheelBench:
    kind = "single_wheel"
    conditions = ()  # only a traverse has them (conditions.py)
    signals = carriage.SIGNALS
    own_noise = np.zeros(len(signals))
    model, jointed = "", False
    skip = 0  # rows of a run that do not count for what can be detected

    def __init__(self, seed, poor=False):
        rng = np.random.default_rng([seed, 1])
        for _ in range(100):
            self.draw(rng, poor)
            if np.all(np.isfinite(self.simulate([{}, {"slip_sinkage.ding": 0.3}]))):
                return  # else a soil too soft for these loads
        raise RuntimeError("no soil carries the loads")

    def draw(self, rng, poor):
        self.rig = {"radius": float(rng.choice([0.09, 0.10, 0.12])), "width": float(rng.choice([0.10, 0.12, 0.14]))}
        self.soil_name, self.soil = soils.draw(rng, self.rig["width"])
        scale = float(rng.uniform(0.85, 1.15))
        loads = [round(scale * load, 1) for load in (20.0, 40.0, 70.0)]
        speeds, slips = (0.2, 0.8), SLIPS
        if poor:
            loads, speeds, slips = loads[1:2], speeds[:1], SLIPS[1:8:2]
        self.set_points = [(load, speed) for load in loads for speed in speeds]
        self.slips = np.array(slips)
        groups, rows = len(self.set_points), len(slips)
        order = rng.permutation(groups) if groups > 1 else np.zeros(1)
        self.extra = {
            "hump_at": 0.35,
            "hump_width": 0.06,
            # A group's repeats follow one another; the groups come in any order.
            "order": (order / max(groups - 1, 1) - 0.5)[:, None],
            # The rows of a run are taken at places along the bed, each time the same ones.
            "turned": rng.uniform(0.0, 2.0 * np.pi, groups)[:, None] + 2.2 * np.arange(rows)[None, :],
        }

    def simulate(self, changes, coarse=False):
        """Clean signals for each dict of changed parameters: (change, group, row, signal); it is as exact when `coarse`."""
        names = {name for change in changes for name in change}
        p = {**self.rig, **self.soil, **self.extra}
        for name in names:
            p[name] = np.array([change.get(name, p.get(name, 0.0)) for change in changes])[:, None, None]
        load = np.array([load for load, _ in self.set_points])[:, None]
        speed = np.array([speed for _, speed in self.set_points])[:, None]
        shape = (len(changes), len(load), len(self.slips))
        grids = (np.broadcast_to(v, shape) for v in (load, self.slips[None, :], speed))
        return carriage.steady_points(p, *grids)

    def size(self, clean):
        """RMS of each signal over the experiment."""
        return np.sqrt(np.mean(clean**2, axis=(0, 1)))

    def parameters(self):
        return {"wheel.radius": self.rig["radius"], "wheel.width": self.rig["width"]}

    def write(self, folder, runs):
        """Writes the CSV files; `runs` is (group, replicate, signals). Gives the lines of experiment.toml."""
        lines = []
        (folder / "runs").mkdir(parents=True, exist_ok=True)
        for group, replicate, measured in runs:
            load, speed = self.set_points[group]
            label = f"load{load:g}_speed{speed:g}"
            rows = [",".join(("load", "slip", "wheel_speed") + self.signals)]
            for slip, values in zip(self.slips, measured):
                cells = [f"{v:.{carriage.DECIMALS[name]}f}" for name, v in zip(self.signals, values)]
                rows.append(",".join([f"{load:g}", f"{slip:g}", f"{speed:g}"] + cells))
            name = f"runs/{label}_{'abcdef'[replicate]}.csv"
            (folder / name).write_text("\n".join(rows) + "\n", encoding="ascii", newline="\n")
            lines += ["", "[[run]]", f'file = "{name}"', f'group = "{label}"']
        return lines
