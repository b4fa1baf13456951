"""Checks of what tests of a soil can see. `python3 -m pytest tests/generators`."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import soil_detect  # noqa: E402
import soil_tests  # noqa: E402

NOISE = 0.02
CASES = [("plate_sinkage", case) for case in soil_tests.PLATE_CASES[1:]] + [("shear", case) for case in soil_tests.SHEAR_CASES[1:]]
# Four standard errors of a variance of so many values, and squares of the noise itself (logarithms are taken for shares).
DRAWS, SPREAD = 200, 0.03


def detector(kind):
    return soil_detect.Detector(kind, soil_tests.LETE, NOISE, soil_tests.SCATTER)


@pytest.mark.parametrize("kind", ["plate_sinkage", "shear"])
def test_property_noise_of_the_generator_is_white(kind):
    at, rng = detector(kind), np.random.default_rng(5)

    def measured(setting, speed, x, value):
        return np.mean([soil_tests.noisy(rng, value, NOISE, soil_tests.SCATTER) for _ in range(3)], axis=0)

    white = np.concatenate([at.changed(measured, soil_tests.LETE) for _ in range(DRAWS)])
    assert np.mean(white**2) == pytest.approx(1.0, abs=SPREAD)


def test_analytic_another_soil_is_no_effect(monkeypatch):
    other = soil_tests.LETE | {"k_phi": 1.3 * soil_tests.LETE["k_phi"], "n": 0.9}
    monkeypatch.setattr(soil_detect, "hidden", lambda kind, case, strength, s, v, x, ground: soil_detect.clean(kind, s, x, other))
    left, _, ground = detector("plate_sinkage").signature("another soil", 0.0)
    # The last step of the fit is below a ten-thousandth, and noise is two hundredths.
    assert np.linalg.norm(left) < 0.1
    assert ground["k_phi"] == pytest.approx(other["k_phi"], rel=1e-3)


@pytest.mark.parametrize(("kind", "case"), CASES)
def test_property_what_is_hidden_shows(kind, case):
    truth = detector(kind).truth(case, np.random.default_rng(7))
    assert truth["visible"] and truth["deviations"] >= 0.999 * soil_detect.CLEAR
    assert truth["case"] not in truth["allowed_ties"]


def test_analytic_resistance_that_grows_with_the_plate_looks_like_walls():
    # Three plates tell three numbers. k that grows linearly with the plate needs a k_c below zero, which no soil has: k_c is zero, k_phi
    # takes one number, and two curves that grow differ in what is left by their curvature only.
    truth = detector("plate_sinkage").truth("plate_size", np.random.default_rng(7))
    assert truth["cosines"]["box_walls"] > 0.95
    assert "box_walls" in truth["allowed_ties"]
    assert detector("plate_sinkage").truth("box_walls", np.random.default_rng(7))["allowed_ties"] == []


@pytest.mark.parametrize(("kind", "case"), CASES)
def test_property_strengths_lie_between_the_least_that_shows_and_the_usual(kind, case):
    at = detector(kind)
    least, usual = at.least(case), soil_tests.STRENGTHS[case]
    drawn = [at.truth(case, np.random.default_rng(k))["strength"] for k in range(5)]
    assert all(min(least, usual) * (1.0 - 1e-12) <= strength <= max(least, usual) * (1.0 + 1e-12) for strength in drawn)
    shown = np.linalg.norm(at.signature(case, least)[0])
    # The search meets the length to a twentieth; a law that is not the clean one at no strength is taken as usual.
    assert least == usual or soil_detect.CLEAR <= shown <= 1.06 * soil_detect.CLEAR
