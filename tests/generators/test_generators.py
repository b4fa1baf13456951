"""Checks of the generators against facts in closed form and against themselves. `python3 -m pytest tests/generators`."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import bench_rover  # noqa: E402
import bench_wheel  # noqa: E402
import carriage  # noqa: E402
import cases  # noqa: E402
import conditions  # noqa: E402
import contact  # noqa: E402
import detect  # noqa: E402
import ground  # noqa: E402
import hidden  # noqa: E402
import noise  # noqa: E402
import refit  # noqa: E402
import rover  # noqa: E402
import single_wheel  # noqa: E402
import soils  # noqa: E402
import terrain  # noqa: E402
import traverse  # noqa: E402
import vehicles  # noqa: E402
from linkage import Linkage  # noqa: E402

# A hundredth of the smallest noise that is ever added (2 % of a signal).
QUADRATURE = 2e-4
RIG = {"radius": 0.1, "width": 0.12}
FLAT = terrain.Profile([0.0], [0.0], [1.0])
# A share of an effect's strength, and what may still show of it then: an exit angle grows with the square root, 0.01.
WEAK, HARDLY = 1e-4, 0.02
DIFFERENCES = 1e-8  # between central differences of the waves and their derivatives, see there


def parameters(**changes):
    return {**vehicles.TWO_WHEELED.parameters, **soils.thesis(), **changes}


def forces(sinkage, velocity, spin, **changes):
    p = parameters(**changes)
    arrays = [np.array([v], float) for v in (sinkage, velocity, spin)]
    place = ground.place_at(contact.slip_of(arrays[1], p["radius"] * arrays[2]), arrays[1], arrays[0], 50.0)
    return [float(f[0]) for f in contact.forces(ground.local_soil(p, place), *arrays)]


def test_analytic_frictionless_soil_pushes_towards_the_axle():
    # Without shear the stress is radial: no torque, and N, DP are integrals of the pressure alone. With n = 1 and the
    # peak near the bottom the front zone gives them in closed form.
    entry = 0.5
    sinkage = 0.1 * (1.0 - np.cos(entry))
    normal, pull, torque, _ = forces(sinkage, 0.1, 2.0, cohesion=0.0, friction_angle=0.0, c1=0.05, c2=0.0)
    peak = 0.05 * entry
    k, r, b = 850e3, 0.1, 0.15
    wedge = lambda a: 0.5 * a + 0.25 * np.sin(2 * a) - np.cos(entry) * np.sin(a)  # of (cos - cos entry) cos
    shove = lambda a: -0.25 * np.cos(2 * a) + np.cos(entry) * np.cos(a)  # of (cos - cos entry) sin
    front_normal = r * b * k * r * (wedge(entry) - wedge(peak))
    front_pull = -r * b * k * r * (shove(entry) - shove(peak))
    # The rear zone, a twentieth of the contact, carries at its mean stress: sigma runs through the same values.
    mean = np.mean(np.cos(np.linspace(peak, entry, 20001)) - np.cos(entry))
    rear_normal = r * b * k * r * mean * peak
    assert torque == 0.0
    assert normal == pytest.approx(front_normal + rear_normal, rel=1e-3)
    assert pull == pytest.approx(front_pull, rel=1e-2)


def test_analytic_full_slip_on_purely_cohesive_soil():
    # Spinning on the spot with K -> 0 mobilises c everywhere: T = r^2 b c (theta_1 - theta_2).
    entry = 0.6
    _, _, torque, _ = forces(0.1 * (1 - np.cos(entry)), 0.0, 2.0, friction_angle=0.0, shear_modulus=1e-7)
    assert torque == pytest.approx(0.1**2 * 0.15 * 1000.0 * entry, rel=1e-3)


def test_agreement_with_the_slow_wheel():
    # single_wheel.py sums 2000 midpoints a zone and bisects point by point.
    sand = single_wheel.SAND
    p = {**RIG, "cohesion": sand["c"], "friction_angle": sand["phi"], "k_phi": sand["k_c"] / 0.12 + sand["k_phi"]}
    p |= {"exponent": sand["n"], "shear_modulus": sand["K"], "c1": 0.4, "c2": 0.2, "slip_sinkage.ding": np.array(0.35)}
    slow = np.array([single_wheel.steady_point(40.0, i) for i in single_wheel.SLIPS])
    fast = carriage.steady_points(p, 40.0, np.array(single_wheel.SLIPS), 0.2)
    assert np.max(np.abs(fast - slow) / np.max(np.abs(slow), axis=0)) < 1e-5


def test_agreement_of_the_nodes_over_the_soils():
    rng = np.random.default_rng(3)
    for _ in range(20):
        _, soil = soils.draw(rng, 0.12)
        p = {**RIG, **soil}
        sinkage, velocity = np.full(9, 0.015), 0.2 * (1.0 - np.array([-0.3, -0.1, -0.02, 0.0, 0.02, 0.1, 0.3, 0.6, 0.9]))
        place = ground.place_at(1.0 - velocity / 0.2, velocity, sinkage, 40.0)
        local = ground.local_soil(p, place)
        few, many = (np.array(contact.forces(local, sinkage, velocity, np.full(9, 2.0), nodes=n)) for n in (contact.NODES, 400))
        assert np.max(np.abs(few[:2] - many[:2])) < QUADRATURE * many[0].max()
        assert np.max(np.abs(few[2] - many[2])) < QUADRATURE * many[0].max() * 0.1


def test_property_mirrored_motion():
    for velocity, spin in ((0.1, 2.0), (0.3, 2.0), (0.1, -1.0), (0.0, 1.0)):
        n, d, t, _ = forces(0.01, velocity, spin)
        mirrored = forces(0.01, -velocity, -spin)
        assert mirrored[:3] == pytest.approx([n, -d, -t], rel=1e-12)


@pytest.mark.parametrize("form", cases.FORMS, ids=lambda f: f.key)
def test_property_each_form_is_neutral_at_zero_and_shows(form):
    if cases.WHEEL in form.kinds:
        bench = bench_wheel.WheelBench(3)
        plain, zero, weak, some = bench.simulate([{}] + [{form.key: size * form.probe} for size in (0.0, WEAK, 1.0)])
        assert np.array_equal(plain, zero)
        assert not np.allclose(plain, some, rtol=1e-9, atol=0.0)
        # It grows from nothing: an effect that is hardly there hardly shows.
        assert np.max(np.abs(weak - plain) / bench.size(plain)) < HARDLY * np.max(np.abs(some - plain) / bench.size(plain))


def short_rover(seed=3, rows=25, under=()):
    bench = bench_rover.RoverBench(seed, "reduced", under=under)
    bench.rows, bench.commands = rows, bench.commands[:rows]
    return bench


def test_analytic_rest_carries_the_weight():
    profile = terrain.Profile([0.0, 0.1], [0.0, 0.0], [1.0, 1.0])
    vehicle = rover.Rover(parameters(), profile)
    q, u, hold = vehicle.settle(0.0)
    normal, pull, _, (_, _, cos, sin), _ = vehicle.touch(q, u, hold, np.zeros((2, 2)), 0.0)
    weight = 10.0 * 9.81
    assert (normal * cos + pull * sin).sum(-1) == pytest.approx([weight] * 2, rel=1e-6)
    assert (pull * cos - normal * sin).sum(-1) == pytest.approx([0.0] * 2, abs=1e-5)
    # Parked for a second it stays.
    start, slopes = q.copy(), {}
    for _ in range(25):
        q, u, _, hold = vehicle.step(q, u, hold, np.zeros((2, 2)), 0.04, slopes)
    assert np.max(np.abs(q - start)) < 1e-5


def test_analytic_a_linkage_at_rest_shares_its_weight():
    # Statics of chassis and bogie on level ground: the rear wheel 40 %, the wheels of the bogie 30 % each.
    vehicle = rover.Rover({**parameters(), **vehicles.ROCKER_BOGIE.parameters}, FLAT, vehicle=vehicles.ROCKER_BOGIE)
    assert vehicles.shares(vehicle.linkage) == pytest.approx([0.4, 0.3, 0.3], abs=1e-12)
    q, u, hold = vehicle.settle(0.0)
    normal, pull, _, (_, _, cos, sin), _ = vehicle.touch(q, u, hold, np.zeros((1, 3)), 0.0)
    # The pitches that different sinkages leave, about 1 mm on 0.35 m, shift the shares by less than a thousandth.
    assert (normal * cos + pull * sin)[0] == pytest.approx(98.1 * np.array([0.4, 0.3, 0.3]), rel=5e-3)


def test_property_a_linkage_loses_energy_to_its_joint_only():
    # In the air, without damping of the joint, the sum of kinetic energy (weight acts on the centre of mass alone) stays.
    loose = replace(vehicles.ROCKER_BOGIE, links=(replace(vehicles.ROCKER_BOGIE.links[0], damping=0.0),))
    linkage = Linkage({**parameters(), **loose.parameters}, loose)
    pitch, rate, dt = np.array([0.1, -0.3]), np.array([0.7, -1.9]), 1e-3
    energy = lambda: linkage.kinetic_energy(np.array([0.0, 0.0, *rate]), pitch)

    def bend(pitch, rate):
        return np.linalg.solve(linkage.inertia(pitch), linkage.moments(pitch, rate))

    before = energy()
    for _ in range(1000):  # the classical method of fourth order: an error of (rate dt)^4, some 1e-11
        a = (rate, bend(pitch, rate))
        b = (rate + 0.5 * dt * a[1], bend(pitch + 0.5 * dt * a[0], rate + 0.5 * dt * a[1]))
        c = (rate + 0.5 * dt * b[1], bend(pitch + 0.5 * dt * b[0], rate + 0.5 * dt * b[1]))
        d = (rate + dt * c[1], bend(pitch + dt * c[0], rate + dt * c[1]))
        pitch, rate = (v + dt / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) for k, v in enumerate((pitch, rate)))
    assert energy() == pytest.approx(before, rel=1e-9)
    assert np.ptp(pitch) > 1.0  # it did move


def test_analytic_steady_climb_balances_the_slope():
    # After a second at constant speed the pulls carry the slope's share of the weight (to what the speed still changes).
    profile = terrain.Profile([0.1], [0.0], [1.0])
    vehicle = rover.Rover(parameters(shear_modulus=0.01), profile)
    q, u, hold = vehicle.settle(0.0)
    slopes, command = {}, np.full((1, 2), 1.5)
    for _ in range(100):
        q, u, a, hold = vehicle.step(q, u, hold, command, 0.02, slopes)
    normal, pull, *_ = vehicle.touch(q, u, hold, command, 0.0)
    angle = np.arctan(0.1)
    assert pull.sum() == pytest.approx(98.1 * np.sin(angle), rel=1e-3)
    assert normal.sum() == pytest.approx(98.1 * np.cos(angle), rel=1e-3)


# Lugs on the stiff soil of seed 1009 ask for the shortest steps.
@pytest.mark.parametrize("seed, rows, change", [(3, 25, {}), (1009, 60, {"grousers.lugs": 0.0039})])
def test_property_steps_have_converged(seed, rows, change):
    bench = short_rover(seed, rows)
    usual = bench.simulate([change])[0]
    fine = bench.simulate([change], parts=(0.01, 0.025, 0.04) + (0.0425,) * 10 + (0.05,) * 10)[0]
    size = bench.size(fine)
    # A twentieth of the noise, apart from the first rows, where the rover starts to move.
    assert np.max(np.abs(usual - fine)[:, 3:] / size) < 0.02
    assert np.all(np.sqrt(np.mean((usual - fine) ** 2, axis=(0, 1))) < 0.002 * size)


@pytest.mark.parametrize("form", [f for f in cases.FORMS if cases.WHEEL not in f.kinds], ids=lambda f: f.key)
def test_property_each_form_of_the_rover_is_neutral_at_zero_and_shows(form):
    bench = short_rover(rows=60, under=("rocker_bogie",) if form.jointed else ())
    plain, zero, some = bench.simulate([{}, {form.key: 0.0}, {form.key: form.probe}], coarse=True)
    assert np.array_equal(plain, zero)
    assert np.max(np.abs(plain - some) / bench.size(plain)) > 1e-6


# Runs that are stepped together end each step together, far within its tolerance: a thousandth of what an effect of one probe changes, and
# ten times the tolerance of a step besides, in RMS values of the signal.
TOGETHER, ROUNDED = 1e-3, 1e-7


@pytest.mark.parametrize("kind", [cases.WHEEL, cases.ROVER])
def test_property_forms_side_by_side_do_not_depend_on_what_is_beside_them(kind):
    bench = bench_wheel.WheelBench(3) if kind == cases.WHEEL else short_rover(rows=12)
    changes = [{f.key: f.probe} for f in cases.FORMS if kind in f.kinds and not f.jointed]
    plain, *together = bench.simulate([{}, *changes], coarse=True)
    # Four at a time take little longer than one; the last one is alone.
    most, last = changes[:-1], changes[-1:]
    parts = [most[k : k + 4] for k in range(0, len(most), 4)] + [last]
    apart = [signals for part in parts for signals in bench.simulate(part, coarse=True)]
    for change, signals, own in zip(changes, together, apart):
        # A run that gets stuck with a form does so beside others too.
        assert np.array_equal(np.isnan(signals), np.isnan(own)), change
        size = np.nanmax(np.abs(own - plain) / bench.size(plain))
        assert np.nanmax(np.abs(signals - own) / bench.size(plain)) <= TOGETHER * size + ROUNDED, change


# A fit that ends within a hundredth of its length leaves 1e-4 of its square.
SAME_EFFECT = 0.9999


def test_property_an_effect_fitted_in_its_own_place_is_itself():
    detector = detect.Detector(bench_wheel.WheelBench(5), 0.02, 3, cases.library(cases.WHEEL))
    drag, friction, sinkage = (cases.find(cases.WHEEL, name) for name in ("drag", "coulomb_friction", "slip_sinkage"))
    both = {drag: 6.0, sinkage: 0.3}
    assert detector.cosine_in_place({sinkage: 0.3}, sinkage, "slip_sinkage") > SAME_EFFECT
    # Also where the other form of an effect, or another effect, is free beside it.
    assert detector.cosine_in_place(both, drag, "drag") > SAME_EFFECT
    assert detector.cosine_in_place(both, sinkage, "slip_sinkage") > SAME_EFFECT
    # A drag lowers the pull, friction raises the torque.
    assert detector.cosine_in_place({drag: 6.0}, drag, "coulomb_friction") < 0.5
    assert detector.cosine_in_place({friction: 0.2}, friction, "drag") < 0.5


def test_property_the_nearest_rival_is_the_one_that_scipy_finds():
    optimize = pytest.importorskip("scipy.optimize")
    detector = detect.Detector(bench_wheel.WheelBench(5), 0.02, 3, cases.library(cases.WHEEL))
    own, rival = cases.find(cases.WHEEL, "coulomb_friction"), cases.find(cases.WHEEL, "gear_efficiency")
    signals = detector.effect(own, 0.2)
    free = detector.with_free([rival]).free

    def left(shift):
        there = detector.bench.simulate([free.changes(shift)], coarse=True)[0]
        return np.nan_to_num(detector.told(signals - there), nan=1e2)

    starts = [np.append(np.zeros(len(soils.CALIBRATED)), size) for size in (0.01, 0.3)]
    found = [optimize.least_squares(left, start, bounds=tuple(free.bounds), x_scale="jac", diff_step=1e-4, max_nfev=60) for start in starts]
    least = np.sqrt(2.0 * min(one.cost for one in found)) / np.linalg.norm(detector.signature(signals))
    cosine = detector.cosine_in_place({own: 0.2}, own, rival.case)
    assert np.sqrt(1.0 - cosine**2) == pytest.approx(least, rel=AS_SCIPY)


def test_property_strengths_found_side_by_side_are_those_found_alone():
    bench = bench_wheel.WheelBench(5)
    detector = detect.Detector(bench, 0.02, 3, cases.library(cases.WHEEL))
    jobs = [(cases.WHEEL, case, None, 5) for case in ("coulomb_friction", "slip_sinkage", "drag+rate")]
    for (kind, case, form, seed), (found, rng) in zip(jobs, hidden.chosen_side_by_side(detector, jobs)):
        own = hidden.random_of(seed, case, form, 0.02)
        alone = detect.alone(bench, hidden.choosing(detector, hidden.hidden_forms(kind, case, form), own))
        assert [(f.key, strength) for f, strength, *_ in found] == [(f.key, strength) for f, strength, *_ in alone]
        assert rng.uniform() == own.uniform()


def test_property_conditions_come_in_a_fifth_of_the_seeds():
    drawn = [conditions.drawn(seed) for seed in range(2000)]
    for name in conditions.CONDITIONS:
        # Four standard deviations of a share of 0.2 in 2000 draws.
        assert np.mean([name in names for names in drawn]) == pytest.approx(conditions.SHARE, abs=0.036)


def test_analytic_waves_and_their_derivatives():
    profile = terrain.Profile([0.05], [0.08], [2.0], conditions.waves(3, ("random_ground",)))
    x, step = np.linspace(-3.0, 5.0, 4001), 1e-5
    (low, *_), (_, rise, bend), (high, *_) = (profile.at(x + d) for d in (-step, 0.0, step))
    # Central differences over 2e-5 m: the waves' third and fourth derivatives (below 10) leave under 1e-9, rounding of heights
    # and slopes (below 1, to 1e-16) leaves 1e-11.
    assert np.max(np.abs((high - low) / (2 * step) - rise)) < DIFFERENCES
    assert np.max(np.abs((profile.at(x + step)[1] - profile.at(x - step)[1]) / (2 * step) - bend)) < DIFFERENCES
    at, z = profile.rows(0, -1.0, 1.0)
    assert z == pytest.approx(profile.at(at)[0], abs=1e-12)  # the same sum in another order


def test_property_backwards_is_the_mirror_image():
    # On level ground with the centre of mass in the middle a rover drives backwards as it drives forwards.
    level = [(0.0, 0.0, 1.0, 0.0, 2.0, 1.0)] * 2
    bench = bench_rover.RoverBench(3, "reduced", under=("backwards",))
    bench.set_points, bench.mass = level, bench.mass[:2]
    bench.slope, bench.height, bench.length = np.zeros(2), np.zeros(2), np.ones(2)
    bench.commands = bench.commands[:, [0, 0]] * np.array([1.0, -1.0])[None, :, None]
    runs = bench.simulate([{"multi_pass.holm": 0.5}])[0].transpose(0, 2, 1)
    forwards, back = (dict(zip(bench.signals, run)) for run in runs)
    # Newton's method ends a step at 1e-8 m/s; over 9 s that is below 1e-7 m, and the soil (about 1e2 N m per m/s) makes of it
    # less than 1e-5 N m.
    for name in ("x", "velocity", "pitch"):
        assert back[name] == pytest.approx(-forwards[name], abs=1e-7)
    assert back["wheel[1].torque"] == pytest.approx(-forwards["wheel[2].torque"], abs=1e-5)
    assert back["wheel[2].sinkage"] == pytest.approx(forwards["wheel[1].sinkage"], abs=1e-7)


def test_property_a_delay_shifts_the_body_only():
    plain, late = (short_rover(rows=40, under=under) for under in ((), ("delay",)))
    before, after = plain.simulate([{}])[0], late.simulate([{}])[0]
    rows = round(conditions.DELAY / plain.row_time)
    body = [plain.signals.index(name) for name in conditions.BODY]
    rest = [k for k in range(len(plain.signals)) if k not in body]
    assert np.array_equal(before[..., rest], after[..., rest])
    assert after[:, rows:, body] == pytest.approx(before[:, :-rows, body], abs=1e-9)


def test_property_signals_that_are_not_recorded_are_missing():
    bare = short_rover(under=("current_only", "no_sinkage"))
    assert bare.signals == ("x", "pitch", "velocity", "wheel[1].current", "wheel[2].current")
    assert bare.simulate([{}]).shape[-1] == 5


def test_property_conditions_of_the_record_are_in_the_files(tmp_path):
    under = ("gaps", "jitter", "gps", "soil_scatter")
    truth = hidden.make(tmp_path, cases.ROVER, "clean", None, 0.02, 3, size="reduced", under=under)
    assert truth["conditions"] == list(under) and truth["deviation"]["x"] > conditions.GPS_NOISE
    cells = [row.split(",")[3:] for path in (tmp_path / "runs").iterdir() for row in path.read_text().splitlines()[1:]]
    empty = np.mean([cell == "" for row in cells for cell in row])
    assert empty == pytest.approx(conditions.GAPS, abs=0.01)  # of 7280 cells: four standard deviations
    times = [[float(row.split(",")[0]) for row in path.read_text().splitlines()[1:]] for path in (tmp_path / "runs").iterdir()]
    assert all(np.ptp(np.diff(time)) > 0.5 * conditions.JITTER * 0.1 for time in times)  # rows are 0.1 s apart on average


def test_analytic_scatter_of_the_soil_is_whitened_away():
    # One signal direction with a standard deviation of 3 beside white noise of 1: its length shrinks by sqrt(10).
    direction = np.array([[0.6], [0.8], [0.0]])
    u, shrink = detect.run_scatter(3.0 * direction)
    white = lambda run: run - u @ (shrink * (u.T @ run))
    assert white(direction[:, 0]) == pytest.approx(direction[:, 0] / np.sqrt(10.0))
    assert white(np.array([0.8, -0.6, 2.0])) == pytest.approx([0.8, -0.6, 2.0])


def test_property_foot_is_the_nearest_point():
    profile = terrain.Profile([0.05], [0.08], [2.0])
    centre = np.array([[0.7, 1.3]]), np.array([[0.2, 0.25]])
    at, distance, *_ = profile.foot(*centre)
    x = np.linspace(0.0, 2.0, 200001)
    z = profile.rows(0, 0.0, 2.0)
    heights = 0.05 * x + 0.04 * (1.0 - np.cos(np.pi * x))
    for k in range(2):
        all_distances = np.hypot(x - centre[0][0, k], heights - centre[1][0, k])
        assert distance[0, k] == pytest.approx(all_distances.min(), abs=1e-8)
        assert at[0, k] == pytest.approx(x[all_distances.argmin()], abs=2e-5)
    assert np.all(np.diff(z[0]) > 0)


def test_property_noise_has_its_covariance():
    drawn = noise.draw(np.random.default_rng(1), 40000, 4, 1)[..., 0]
    assert np.cov(drawn.T) == pytest.approx(noise.covariance(4), abs=0.03)
    white = drawn @ noise.whitener(4).T
    assert np.cov(white.T) == pytest.approx(np.eye(4), abs=0.03)


def test_property_noise_does_not_depend_on_what_is_hidden(tmp_path):
    # Friction makes torques larger.
    made = [hidden.make(tmp_path / name, cases.WHEEL, name, None, 0.02, 5, multiple=2.0) for name in ("clean", "coulomb_friction")]
    assert made[0]["deviation"] == made[1]["deviation"]


def test_property_strength_is_as_asked(tmp_path):
    for name in ("coulomb_friction", "slip_sinkage"):
        truth = hidden.make(tmp_path, cases.WHEEL, name, None, 0.02, 5, multiple=2.0)
        effect = truth["effects"][0]
        assert effect["deviations"] == pytest.approx(10.2, rel=0.03)
        assert json.loads((tmp_path / "truth.json").read_text())["effects"] == truth["effects"]


# Share of what another soil changes that may be left once the soil is fitted: a fifth of what slopes at the true soil alone leave.
FITTED = 0.01


@pytest.mark.parametrize("kind", [cases.WHEEL, cases.ROVER])
def test_property_another_soil_leaves_nothing(kind):
    # Far off, along the valley in which friction, cohesion and shear modulus stand for each other: slopes at the true soil alone leave 5
    # and 7 % of it.
    bench = bench_wheel.WheelBench(5) if kind == cases.WHEEL else short_rover(rows=40)
    detector = detect.Detector(bench, 0.02, 3, [])
    other = {name: share * bench.soil[name] for name, share in (("friction_angle", 0.85), ("cohesion", 1.2), ("shear_modulus", 0.6))}
    signals = bench.simulate([other], coarse=True)[0]
    whole = np.linalg.norm(detector.told(signals - detector.clean))
    assert np.linalg.norm(detector.signature(signals)) < FITTED * whole


def test_property_a_strength_is_found_where_stronger_ones_do_not_run():
    # The rig sinks in from some strength on: what the search tries beyond is NaN, and it comes back.
    bench = bench_wheel.WheelBench(5)
    simulate, form = bench.simulate, cases.find(cases.WHEEL, "coulomb_friction")
    bench.simulate = lambda changes, coarse=False: np.stack(
        [np.full_like(y, np.nan) if change.get(form.key, 0.0) > 0.3 else y for change, y in zip(changes, simulate(changes, coarse=coarse))]
    )
    strength, reached = detect.Detector(bench, 0.02, 3, []).strength_at(form, 1.0, 1e9)
    assert 0.2 < strength <= 0.3 and np.isfinite(reached)


# The search stops where a further step promises less than 3 %, and what it leaves is that promise: a valley's floor may bend by some times
# as much.
AS_SCIPY = 0.15
HARD = [(50002, "grousers.lugs"), (50000, "bulldozing.passive"), (50003, "exit_angle.ishigami")]


@pytest.mark.parametrize(("seed", "key"), HARD)
def test_agreement_a_fit_leaves_what_bounded_least_squares_leave(seed, key):
    # Cases whose soil ends far off or on bounds: slopes at the true soil alone, without bounds, say 0.4 to 0.8 of it.
    optimize = pytest.importorskip("scipy.optimize")
    bench = bench_wheel.WheelBench(seed)
    detector = detect.Detector(bench, 0.02, 3, [])
    form = next(form for form in cases.FORMS if form.key == key)
    signals = detector.effect(form, 0.3 * form.typical)
    fit = detect.alone(bench, refit.finding_fit(detector, signals))
    low, high = detector.free.bounds

    def left(shift):
        return np.nan_to_num(detector.told(signals - bench.simulate([detector.free.changes(shift)], coarse=True)[0]), nan=1e2)

    starts = (np.zeros(len(low)), np.clip(fit.shift, low + 1e-6, high - 1e-6))
    found = [optimize.least_squares(left, start, bounds=(low, high), x_scale="jac", diff_step=1e-4, max_nfev=60) for start in starts]
    least = np.sqrt(2.0 * min(one.cost for one in found))
    assert np.linalg.norm(refit.promised(detector, fit)) == pytest.approx(least, rel=AS_SCIPY)


def test_property_a_flexible_wheel_deflects_by_the_force_that_it_carries():
    # Two runs flex, in two forms, the third does not.
    p = parameters(**{"flexible_wheel.arc": np.array([1e-4, 0.0, 0.0]), "flexible_wheel.load": np.array([0.0, 2e-4, 0.0])})
    vehicle = rover.Rover(p, terrain.Profile([0.0] * 3, [0.0] * 3, [1.0] * 3))
    some = lambda value: np.full((3, 2), value)
    slip, velocity, sinkage = some(0.2), some(0.08), np.array([[0.004, 0.012]] * 3)
    place = ground.place_at(slip, velocity, sinkage, vehicle.load)
    motion = velocity, some(0.1), some(1.0)
    carried = vehicle.carried(place, *motion)
    _, there, _, (normal, *_) = vehicle.contact(vehicle.per_wheel, {**place, "load": carried}, *motion)
    # The search ends where the sinkage moves by less than 1e-9 of itself.
    assert carried[:2] == pytest.approx(normal[:2], rel=1e-6)
    assert there["sinkage"][:2] == pytest.approx(sinkage[:2] - [[1e-4], [2e-4]] * normal[:2], rel=1e-6)
    assert np.array_equal(carried[2], np.broadcast_to(vehicle.load, (3, 2))[2])


def test_property_the_signature_is_what_a_fit_leaves():
    # The soil refitted by Gauss-Newton steps leaves as many deviations as the linear projection says.
    bench = bench_wheel.WheelBench(5)
    detector = detect.Detector(bench, 0.02, 3, cases.library(cases.WHEEL))
    form = cases.find(cases.WHEEL, "coulomb_friction")
    strength, reached = detector.strength_at(form, 1.0, 10.0)
    measured = bench.simulate([{form.key: strength}])[0]
    soil = dict(bench.soil)
    for _ in range(4):
        changes = [soil] + [{**soil, name: soil[name] * 1.001} for name in soils.CALIBRATED]
        y = [detector.white(measured - s) for s in bench.simulate(changes)]
        slopes = np.stack([(y[0] - one) / 0.001 for one in y[1:]], axis=1)
        step = np.linalg.lstsq(slopes, y[0], rcond=None)[0]
        soil = {name: soil[name] * (1.0 + s) for name, s in zip(soils.CALIBRATED, step)}
    assert np.linalg.norm(y[0]) == pytest.approx(reached, rel=0.05)


def test_regress_same_seed_same_bytes(tmp_path):
    for folder in ("a", "b"):
        hidden.make(tmp_path / folder, cases.WHEEL, "slip_sinkage", "lyasko", 0.05, 9)
    files = sorted(p.relative_to(tmp_path / "a") for p in (tmp_path / "a").rglob("*") if p.is_file())
    assert len(files) == 20
    assert all((tmp_path / "a" / f).read_bytes() == (tmp_path / "b" / f).read_bytes() for f in files)


def test_regress_the_shipped_experiment_keeps_its_bytes(tmp_path):
    single_wheel.write_experiment(tmp_path)
    shipped = single_wheel.FOLDER
    for path in [shipped / "experiment.toml", *(shipped / "runs").iterdir()]:
        assert (tmp_path / path.relative_to(shipped)).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("under", [(), ("rocker_bogie",)], ids=["rigid", "linkage"])
def test_property_signals_have_decimals_enough(under):
    # What is cut off stays below a hundredth of the smallest noise that is ever added (2 % of a signal).
    bench = short_rover(under=under)
    cut_off = 0.5 * 10.0**-traverse.DECIMALS
    assert np.all(cut_off < QUADRATURE * bench.size(bench.simulate([{}], coarse=True)[0]))
