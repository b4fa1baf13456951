"""Poses and plans from Python: the numbers of the crate `bekker-planning`, from arrays and names, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest

import bekker
from bekker.errors import InputError, ModelError, PlanningError, UnknownNameError

# Poses on planes are found to the search's tolerance of a micrometre.
EXACT = 1e-5
# A path on a grid of eight directions is at most this much longer than the straight line.
DETOUR = 1.09


def slope(rise: float, nodes: int = 61, cell: float = 0.1) -> np.ndarray:
    """Heights of a plane that rises along x."""
    return np.tile(rise * cell * np.arange(nodes), (nodes, 1))


def test_analytic_a_robot_on_a_plane_stands_as_the_plane() -> None:
    stand = bekker.pose(slope(0.1), (3.0, 3.0), cell=0.1)
    assert stand.safe and stand.failure is None
    assert stand.pitch == pytest.approx(math.atan(0.1), abs=EXACT) and stand.roll == pytest.approx(0.0, abs=EXACT)
    assert [wheel.contact_angle for wheel in stand.wheels] == pytest.approx([math.atan(0.1)] * 6, abs=EXACT)
    across = bekker.pose(slope(0.1), (3.0, 3.0), cell=0.1, heading=math.pi / 2)
    # Northward the ground is lower on the left.
    assert across.roll == pytest.approx(-math.atan(0.1), abs=EXACT)


def test_property_a_path_over_a_slope_is_safe_at_every_point(tmp_path: Path) -> None:
    plan = bekker.plan(slope(0.1), (1.0, 1.0), (4.0, 3.0), cell=0.1)
    assert plan.path.shape == (len(plan.travelled), 2) and plan.travelled[-1] == pytest.approx(plan.length)
    assert np.allclose(plan.path[0], (1.0, 1.0)) and np.allclose(plan.path[-1], (4.0, 3.0))
    assert math.hypot(3.0, 2.0) <= plan.length <= DETOUR * math.hypot(3.0, 2.0)
    assert (plan.stability > 0.1).all() and (plan.thrust > 0.0).all() and (plan.clearance > 0.0).all()
    page = plan.save_page(tmp_path / "plan.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>") and f"{plan.length:.2f} m" in page


def test_analytic_by_energy_a_path_on_level_ground_is_straight() -> None:
    plan = bekker.plan(slope(0.0), (1.0, 1.0), (4.0, 3.0), cell=0.1, soil="fsrl_ditch", by_energy=True)
    # A path at any angle, where the index knows eight headings; 1 % is the bound of the field's paths.
    assert plan.length == pytest.approx(math.hypot(3.0, 2.0), rel=0.01)
    assert plan.cost > 0.0 and " J" in plan.page
    with pytest.raises(ModelError, match="soil"):
        bekker.plan(slope(0.0), (1.0, 1.0), (4.0, 3.0), cell=0.1, by_energy=True)


def test_property_a_plan_on_soil_has_slip_with_a_band_and_alternatives() -> None:
    ground = slope(0.05)
    ground[25:36, 25:36] += 0.3
    plan = bekker.plan(ground, (1.0, 3.0), (5.0, 3.0), cell=0.1, soil="fsrl_ditch", alternatives=True)
    assert plan.slip.shape == plan.travelled.shape and (plan.slip_low < plan.slip).all()
    assert plan.energy > 0.0 and plan.slip_told is not None and "nearest to it" in plan.slip_told
    assert len(plan.alternatives) + len(plan.alternatives_missing) == 5
    for other in plan.alternatives:
        assert other.safe == (not other.failures) and other.points.shape[1] == 2 and other.name in plan.page
        assert other.verdict.startswith("safe" if other.safe else "not safe")
    parameter = 'name = "soil.friction_angle"\nvalue = 0.5\nunit = "rad"\nscale = "linear"\nsd = 0.01\nat_bound = false\n'
    soil = bekker.Soil(f'name = "shear box"\n[[parameter]]\n{parameter}covariance = [1e-4]\n')
    known = bekker.plan(ground, (1.0, 3.0), (5.0, 3.0), cell=0.1, soil="fsrl_ditch", soil_from=soil)
    assert known.alternatives == [] and "shear box" in (known.slip_told or "")
    # On some soils of the class no slip climbs this slope: the band is open above.
    assert np.isnan(plan.slip_high).any() and plan.slip_none.max() > 0.05 and (known.slip_none == 0.0).all()
    assert (known.slip_high - known.slip_low).max() < (plan.slip - plan.slip_low).max()
    firm = bekker.plan(slope(0.0), (1.0, 1.0), (2.0, 2.0), cell=0.1)
    assert np.isnan(firm.slip).all() and math.isnan(firm.energy) and firm.slip_told is None
    with pytest.raises(UnknownNameError, match="custard"):
        bekker.plan(ground, (1.0, 3.0), (5.0, 3.0), cell=0.1, soil="fsrl_ditch", soil_class="custard")
    with pytest.raises(InputError, match="soil"):
        bekker.plan(ground, (1.0, 3.0), (5.0, 3.0), cell=0.1, soil_class="clay")


def test_agreement_arrays_and_files_give_the_same_plan(tmp_path: Path) -> None:
    heights = slope(0.1)
    np.save(tmp_path / "map.npy", heights)
    [array, file] = [
        bekker.plan(ground, (1.0, 1.0), (3.0, 2.0), cell=0.1) for ground in (heights, tmp_path / "map.npy")
    ]
    assert np.array_equal(array.path, file.path) and np.array_equal(array.thrust, file.thrust)
    turned = bekker.plan(heights[::-1], (1.0, 1.0), (3.0, 2.0), cell=0.1, from_north=True)
    assert np.array_equal(array.path, turned.path)


def test_agreement_a_robot_is_the_same_from_a_file_as_text_and_as_a_dictionary() -> None:
    file = Path(__file__).parents[2] / "examples" / "planning_robot.toml"

    def rocker(name: str, y: float) -> dict[str, object]:
        joint = {"name": f"{name} rocker", "kind": "revolute", "axis": [0.0, -1.0, 0.0], "at": [0.0, y, 0.0]}
        joint |= {"passive": [0, math.copysign(1.0, y)], "least": -0.5, "most": 0.5}
        return {"mass": 3.0, "centre_of_mass": [0.0, y, -0.1], "joint": joint, "parent": None}

    def wheel(name: str, link: int, x: float, y: float) -> dict[str, object]:
        return {"name": name, "link": link, "centre": [x, y, -0.15]}

    robot = {
        "mass": 24.0,
        "centre_of_mass": [0.0, 0.0, -0.05],
        "wheel_radius": 0.12,
        "wheel_width": 0.1,
        "wheel_torque": 6.0,
        "belly": {"rear": -0.3, "front": 0.3, "half_width": 0.18, "z": -0.1},
        "links": [rocker("left", 0.3), rocker("right", -0.3)],
        "wheels": [
            wheel("left rear", 0, -0.35, 0.32),
            wheel("left front", 0, 0.35, 0.32),
            wheel("right rear", 1, -0.35, -0.32),
            wheel("right front", 1, 0.35, -0.32),
        ],
    }
    given = (file, file.read_text(encoding="utf-8"), robot)
    poses = [bekker.pose("moderate:7", (4.0, 4.0), one, heading=0.3) for one in given]
    assert poses[0] == poses[1] == poses[2] and len(poses[0].wheels) == 4


def test_property_settings_and_soil_change_what_is_safe() -> None:
    steep = slope(0.4)
    assert bekker.pose(steep, (3.0, 3.0), cell=0.1).safe
    slippery = bekker.pose(steep, (3.0, 3.0), cell=0.1, settings={"traction.friction": 0.2})
    assert not slippery.safe and slippery.failure is not None and "thrust" in slippery.failure
    sandy = bekker.pose(steep, (3.0, 3.0), cell=0.1, soil="fsrl_incline")
    assert not sandy.safe
    names = {setting["name"] for setting in bekker.planning_settings()}
    assert names > {"traction.friction", "limits.stability"}
    assert list(bekker.robots()) == ["fsrl", "sample_return"]


def test_property_a_goal_out_of_reach_tells_how_far_one_gets() -> None:
    wall = slope(0.0, nodes=41)[:16]
    wall[:, 20:23] = 1.0
    with pytest.raises(PlanningError, match="no safe path reaches the goal") as caught:
        bekker.plan(wall, (1.0, 0.8), (3.2, 0.8), cell=0.1)
    assert caught.value.nearest is not None and 1.0 <= caught.value.nearest[0] < 2.0
    with pytest.raises(PlanningError, match="off the map") as caught:
        bekker.plan(wall, (1.0, 0.8), (50.0, 0.8), cell=0.1)
    assert caught.value.nearest is None


def test_property_what_is_wrong_is_named() -> None:
    flat = slope(0.0)
    with pytest.raises(InputError, match=r"shape \(5,\)"):
        bekker.plan(np.zeros(5), (1.0, 1.0), (2.0, 2.0))
    with pytest.raises(InputError, match=r"start: expected two numbers"):
        bekker.plan(flat, (1.0,), (2.0, 2.0))
    with pytest.raises(InputError, match="start: expected finite"):
        bekker.plan(flat, (math.nan, 1.0), (2.0, 2.0))
    with pytest.raises(UnknownNameError, match="unknown robot `rover9`"):
        bekker.pose(flat, (1.0, 1.0), "rover9")
    with pytest.raises(UnknownNameError, match="friktion"):
        bekker.pose(flat, (3.0, 3.0), cell=0.1, settings={"traction.friktion": 0.5})
    with pytest.raises(ModelError, match=r"(?s)robot: .*centre_of_mass"):
        bekker.pose(flat, (3.0, 3.0), {"mass": 5.0}, cell=0.1)
    with pytest.raises(FileNotFoundError, match=r"nowhere\.asc"):
        bekker.pose("nowhere.asc", (1.0, 1.0))
    with pytest.raises(InputError, match="whole number"):
        bekker.pose("moderate:many", (1.0, 1.0))
    hole = slope(0.0)
    hole[25:35, 25:35] = np.nan
    with pytest.raises(PlanningError, match="hole"):
        bekker.pose(hole, (3.0, 3.0), cell=0.1)
