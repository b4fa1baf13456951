"""Draws the learning curves that ``train_sb3.py`` has written: ``python examples/train_figure.py runs/curves.csv curves.svg``."""

import sys

import matplotlib
import numpy as np
import pandas as pd

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"PPO": "#2468c4", "SAC": "#d0702c"}


def main(table: str, figure: str) -> None:
    data = pd.read_csv(table).drop_duplicates(["task", "algorithm", "seed", "steps"])
    tasks = list(dict.fromkeys(data["task"]))
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "bekker", "axes.spines.top": False, "axes.spines.right": False})
    drawing, axes = plt.subplots(1, len(tasks), figsize=(2.6 * len(tasks), 2.6), layout="constrained", squeeze=False)
    for axis, task in zip(axes[0], tasks):
        for algorithm, runs in data[data["task"] == task].groupby("algorithm"):
            for _, run in runs.groupby("seed"):
                axis.plot(run["steps"] / 1e3, run["return"], color=COLOURS[algorithm], alpha=0.45, lw=1)
            # The mean over the seeds, where all of them have come.
            last = runs.groupby("seed")["steps"].max().min()
            grid = np.linspace(runs["steps"].min(), last, 50)
            lines = [np.interp(grid, run["steps"], run["return"]) for _, run in runs.groupby("seed")]
            label = f"{algorithm}, {len(lines)} seed{'s' if len(lines) > 1 else ''}"
            axis.plot(grid / 1e3, np.mean(lines, axis=0), color=COLOURS[algorithm], lw=2, label=label)
        axis.set(title=task, xlabel="thousand steps")
        axis.legend(frameon=False, fontsize=7)
    axes[0][0].set_ylabel("mean return, 20 unseen episodes")
    drawing.savefig(figure, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
