"""How much of a left-out error could be removed at all: the generator's own model, fitted to its own experiment."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import plan  # noqa: E402, F401  (puts the generators on the path)

import attainable  # noqa: E402
import cases  # noqa: E402
import hidden  # noqa: E402

LEVEL = 0.02
# The scatter of one run's mean over 162 values that share noise by runs, and what eight fitted parameters add at the ends.
WITHIN = (0.7, 1.5)


def test_property_the_true_model_predicts_left_out_groups_to_the_noise(tmp_path):
    truth = hidden.make(tmp_path, cases.WHEEL, "slip_sinkage", "lyasko", LEVEL, 17)
    bench = hidden.make_bench(cases.WHEEL, 17, "full", False)
    form = cases.find(cases.WHEEL, "slip_sinkage", "lyasko")
    deviation = [truth["deviation"][name] for name in bench.signals]
    strength = {form.key: truth["effects"][0]["strength"]}
    left = attainable.heldout_rmse(tmp_path, bench, [form], strength, deviation, hidden.REPLICATES)
    assert all(WITHIN[0] < left[name] / truth["deviation"][name] < WITHIN[1] for name in bench.signals)
    # A model without the effect does worse: the measure can fail.
    without = attainable.heldout_rmse(tmp_path, bench, [], {}, deviation, hidden.REPLICATES)
    assert max(without[name] / truth["deviation"][name] for name in bench.signals) > 1.1 * WITHIN[0]
    assert sum((without[n] / left[n]) ** 2 for n in bench.signals) > 1.05 * len(bench.signals)
