"""Field logs of rovers as experiment folders: the files as they were recorded, and the settings with which they are read.

What the files do not say, and what is assumed for it, stands beside each assumption.
"""

import shutil

CUADRIGA = """name = "Cuadriga, 14 drives over hills"
kind = "traverse"
model = "two_wheeled_speed"
ignore = ["command", "imu_roll_deg", "gps_speed", "path_error"]
[columns]
# Wheel speeds are recorded in units of 0.0216 m/s at the rim. Wheels that drive forward count negative.
"wheel_left" = { signal = "rim_speed", wheels = [1, 2], side = "left", scale = -0.0216 }
"wheel_right" = { signal = "rim_speed", wheels = [1, 2], side = "right", scale = -0.0216 }
"current_left" = { signal = "current", wheels = [1, 2], side = "left" }
"current_right" = { signal = "current", wheels = [1, 2], side = "right" }
"imu_yaw_deg" = { signal = "heading", unit = "deg" }
# The IMU is tilted by about -13 degrees, and its pitch falls uphill (correlation with the slope of the map -0.7).
"imu_pitch_deg" = { signal = "pitch", unit = "deg", sign = -1, offset = -0.2269 }
"dem_z" = "ground_height"
[parameters]
"wheel.radius" = 0.207      # by its rpm
"wheel.width" = 0.15        # assumed
"wheel[1].x" = -0.35        # assumed: the wheelbase is not given
"wheel[2].x" = 0.35
"rover.pitch_inertia" = 4.0 # assumed
"rover.belly_z" = 0.05
"motor.gear_ratio" = 50.0   # assumed: only its product with the torque constant counts
[priors]
# Half of a vehicle whose mass is not given, and a torque constant that is not given.
"rover.mass" = { mean = 40.0, sd = 8.0 }
"motor.torque_constant" = { mean = 0.06, sd = 0.03 }
"""

HUSKY = """name = "Husky"
kind = "traverse"
model = "two_wheeled_speed"
ignore = ["ax", "ay", "az", "gyro_pitch"]
[columns]
"run" = { run = true }
"gyro_yaw" = "yaw_rate"
"rim_speed_left" = { signal = "rim_speed", wheels = [1, 2], side = "left" }
"rim_speed_right" = { signal = "rim_speed", wheels = [1, 2], side = "right" }
# Recorded without their sign.
"current_left" = { signal = "current", wheels = [1, 2], side = "left", magnitude = true }
"current_right" = { signal = "current", wheels = [1, 2], side = "right", magnitude = true }
[parameters]
"wheel.radius" = 0.13
"wheel.width" = 0.114
"wheel[1].x" = -0.256
"wheel[2].x" = 0.256
"rover.mass" = 35.0         # one side of 70 kg
"rover.pitch_inertia" = 1.8 # assumed
"motor.gear_ratio" = 78.71
"motor.torque_constant" = 0.044
"motor.resistance" = 0.46
"""


def folder_of(settings, files, folder):
    """Copies the files into the folder, beside settings with a run of each."""
    for file in files:
        shutil.copy(file, folder)
    runs = "".join(f'[[run]]\nfile = "{file.name}"\n' for file in files)
    (folder / "experiment.toml").write_text(settings + runs, encoding="ascii")


def cuadriga(file, folder):
    folder_of(CUADRIGA, sorted(file.parent.glob("*.csv")), folder)


def husky(file, folder):
    folder_of(HUSKY, [file], folder)
