"""How diagnoses of several experiments are scored, and what the generator makes. `python3 -m pytest tests/study`."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import together  # noqa: E402

import joint  # noqa: E402  (together puts the generators on the path)


def truth(case, where, ties=(), visible=True):
    return {"case": case, "where": list(where), "effects": [{"allowed_ties": list(ties), "visible": visible}]}


def said(verdict, *effects, where=(), tied=()):
    places = {effect: list(where) for effect in effects}
    return {"verdict": verdict, "effects": list(effects), "where": places, "candidates": [{"effect": name, "tied": True} for name in tied]}


CASES = [
    (truth("clean", []), said("explained"), "right"),
    (truth("clean", []), said("effect_missing", "drag", where=["wheel"]), "false_alarm"),
    (truth("drag", ["wheel"]), said("effect_missing", "drag", where=["wheel"]), "right"),
    (truth("drag", ["wheel"]), said("effect_missing", "drag", where=["wheel", "other_wheel"]), "wrong_place"),
    (truth("drag", ["wheel"]), said("effect_missing", "drag", "rate", where=["wheel"]), "extra"),
    (truth("drag", ["wheel"]), said("effect_missing", "rate", where=["wheel"]), "wrong"),
    (truth("drag", ["wheel"], ["rate"]), said("undetermined", tied=["drag in wheel", "rate in wheel"]), "right_tie"),
    (truth("drag", ["wheel"]), said("undetermined", tied=["drag in wheel", "rate"]), "broad_tie"),
    (truth("drag", ["wheel"]), said("undetermined", tied=["drag", "drag in wheel"]), "right_tie"),
    (truth("drag", ["wheel"], visible=False), said("explained"), "cautious"),
    (truth("softening", ["shear"]), said("effect_missing", "shear_softening", where=["shear"]), "right"),
    (truth("other_soil", []), said("unexplained", "drag"), "cautious"),
    (truth("other_soil", []), said("effect_missing", "drag", where=["wheel"]), "wrong"),
    (truth("drag", ["wheel"]), {"error": "interrupted"}, "error"),
]


@pytest.mark.parametrize(("hidden", "result", "expected"), CASES)
def test_analytic_outcomes(hidden, result, expected):
    assert together.outcome(hidden, result) == expected


def test_property_beds_differ_by_what_is_stated_and_not_at_all_without_it():
    soil = {"k_c": 1e3, "k_phi": 1e6, "cohesion": 800.0, "friction_angle": 0.5, "shear_modulus": 0.02, "exponent": 1.0, "c1": 0.4, "c2": 0.2}
    assert all(bed == soil for bed in joint.prepared(soil, 3, 0.0).values())
    beds = joint.prepared(soil, 3, 0.05)
    assert beds["wheel"]["exponent"] == 1.0 and beds["wheel"]["k_phi"] != beds["plates"]["k_phi"]
    # k_c and k_phi scatter together.
    assert beds["wheel"]["k_c"] / 1e3 == pytest.approx(beds["wheel"]["k_phi"] / 1e6, rel=1e-12)


def test_property_a_set_is_the_same_for_the_same_seed(tmp_path):
    made = [joint.make(tmp_path / name, ("plates", "wheel"), "drag", "wheel", 3100) for name in ("one", "two")]
    assert made[0] == made[1] and made[0]["where"] == ["wheel"] and made[0]["effects"][0]["part"] == "wheel"
    files = [sorted((tmp_path / name).rglob("*.csv")) for name in ("one", "two")]
    assert len(files[0]) > 10 and all(a.read_bytes() == b.read_bytes() for a, b in zip(*files))


def test_property_an_effect_that_a_part_does_not_have_is_refused(tmp_path):
    with pytest.raises(SystemExit, match="seating: no effect of shear"):
        joint.make(tmp_path, ("plates", "shear"), "seating", "shear", 3100)


def test_analytic_a_drive_stands_on_the_soil_of_the_wheel():
    _, soil, beds, benches = joint.shared_soil(3100, 0.0, drives=True)
    wheel, drive = benches["wheel"], benches["drive"]
    widths = [wheel.rig["width"], drive.vehicle.parameters["width"]]
    # k = k_c/b + k_phi at the width b of each contact.
    stiffness = [soil["k_c"] / width + soil["k_phi"] for width in widths]
    assert [wheel.soil["k_phi"], drive.soil["k_phi"]] == pytest.approx(stiffness, rel=1e-12)
    assert {name: drive.soil[name] for name in drive.soil if name != "k_phi"} == {
        name: soil[name] for name in soil if name not in ("k_phi", "k_c")
    }


def test_property_sets_with_drives_have_different_names_and_places_that_show_the_effect():
    jobs = list(together.jobs("development", 1, 3100, False, True))
    assert len({together.name_of("development", job) for job in jobs}) == len(jobs)
    assert all(place in (*parts, "all") for parts, _, place, _, _ in jobs)
    # A tether pulls a rover only.
    assert {place for _, case, place, _, _ in jobs if case == "tether"} == {"drive"}


def test_property_sets_of_one_seed_have_noise_of_their_own(tmp_path):
    def plates_of(case, place):
        joint.make(tmp_path / case, ("plates", "shear"), case, place, 3100)
        return "".join(path.read_text() for path in sorted((tmp_path / case / "plates").rglob("*.csv")))

    first, again, other = plates_of("clean", "all"), plates_of("clean", "all"), plates_of("shear_play", "shear")
    assert first == again
    # Nothing is hidden in the plates of either set, and the soil is the same.
    assert first != other and first.count("\n") == other.count("\n")


def test_property_a_rival_is_like_an_effect_where_its_own_part_says_so(tmp_path):
    # On a single wheel an efficiency of the gear scales the torque, as a gain of the sensor does; a drag lowers the pull.
    made = joint.make(tmp_path, ("plates", "wheel"), "gear_efficiency", "wheel", 3100)
    together.look_alikes(made, said("undetermined", tied=["gear_efficiency in wheel", "torque_scale in wheel", "drag"]))
    (effect,) = made["effects"]
    assert set(effect["cosines"]) == {"torque_scale", "drag"}
    assert effect["allowed_ties"] == ["torque_scale"]
    # Nothing is asked for where only the truth was said.
    together.look_alikes(made, said("effect_missing", "gear_efficiency", where=["wheel"]))
    assert effect["cosines"] == {} and effect["allowed_ties"] == []
