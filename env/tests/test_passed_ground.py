"""The windows of a drive know the ground that its wheels have passed."""

import numpy as np

import bekker

PERIOD = 0.1
TIME = PERIOD * np.arange(101)
SPEED = 2.5
# On this slope a wheel's foot is 12 mm ahead of its centre; ground turns from fresh to passed over 50 mm.
SLOPE = 0.14
NOISE = {"x": 0.0002, "pitch": 0.002, "velocity": 0.003, "wheel[1].torque": 0.02, "wheel[2].torque": 0.02}
# Largest error, as a share of the noise. A window begins as the drive was there, except for how its contacts have slipped until then. With tracks
# under the wheels' centres that begin where the measured path seems to begin, the torque of the rear wheel is off by 1.45 times its noise.
LEFT = 0.1


def test_agreement_windows_of_a_drive_give_what_the_whole_drive_gave() -> None:
    model = bekker.Model.from_toml(f"preset = 'two_wheeled_speed'\n[terrain]\npreset = 'slope'\nslope = {SLOPE}")
    for name, value in {"multi_pass.growth": 0.5, "soil.shear_modulus": 0.01}.items():
        model.set(name, value)
    run, rows = model.start(), []
    places = [run.signal_names.index(name) for name in NOISE]
    for _ in TIME:
        rows.append(run.signals()[places])
        run.step([SPEED, SPEED], round(PERIOD / run.step_size))
    data = {"time": TIME, **{f"wheel[{k}].speed_command": np.full(len(TIME), SPEED) for k in (1, 2)}}
    data |= dict(zip(NOISE, np.array(rows).T, strict=True))
    x = np.linspace(-3.0, 5.0, 81)
    known = ("cohesion", "friction_angle", "k_c", "k_phi", "exponent", "shear_modulus", "c1")
    stated = {f"soil.{name}": model.get(f"soil.{name}") for name in known} | {"multi_pass.growth": 0.5}
    measured = bekker.MeasuredRun(data, "up", terrain=(x, np.tan(SLOPE) * x))
    experiment = bekker.Experiment("traverse", [measured], "slope", noise=NOISE, parameters=stated)
    fit = bekker.calibrate(experiment, model).fit
    for name, noise in NOISE.items():
        assert fit.rmse[name] < LEFT * noise, (name, fit.rmse)
