"""How diagnoses of wheels on a known soil are scored. `python3 -m pytest tests/study`."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(Path(__file__).resolve().parent))

import known_soil  # noqa: E402
from test_together import said, truth  # noqa: E402

CASES = [
    (truth("clean", []), said("explained"), "right"),
    (truth("clean", []), said("undetermined"), "cautious"),
    (truth("clean", []), said("effect_missing", "drag"), "wrong"),
    (truth("drag", ["wheel"]), said("effect_missing", "drag"), "right"),
    (truth("drag", ["wheel"]), said("effect_missing", "drag", "rate"), "wrong"),
    (truth("drag", ["wheel"]), said("effect_missing", "rate"), "wrong"),
    (truth("drag", ["wheel"], ["rate"]), said("undetermined", tied=["drag", "rate"]), "right_tie"),
    (truth("drag", ["wheel"]), said("undetermined", tied=["rate"]), "cautious"),
    (truth("drag", ["wheel"]), said("unexplained", "drag"), "cautious"),
    (truth("drag", ["wheel"]), said("explained"), "missed"),
    (truth("drag", ["wheel"], visible=False), said("explained"), "cautious"),
    (truth("drag", ["wheel"]), {"error": "interrupted"}, "error"),
]


@pytest.mark.parametrize(("truth", "result", "outcome"), CASES)
def test_analytic_outcome_of_a_wheel_on_a_known_soil(truth, result, outcome):
    assert known_soil.outcome(truth, result) == outcome


def test_agreement_cautions_have_the_words_that_are_looked_for():
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "src" / "diagnosis").rglob("*.rs"))
    for words in known_soil.MOVED:
        assert words in sources
