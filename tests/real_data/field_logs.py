"""Field logs of rovers as experiment folders: one side of the vehicle as a half rover on the ground under its path.

What the files do not say, and what is assumed for it, stands beside each assumption and in the folder's `experiment.toml`.
"""

import csv
import math

# Cuadriga. Wheel speeds are recorded in units of 0.0216 m/s at the rim; the radius follows from rpm (README of the data).
RIM = 0.0216
CUADRIGA_RADIUS = 0.207
TURN = 0.35  # rad, largest change of heading over a straight stretch
SHORT = 15.0  # s, of a stretch
SLOW = 0.1  # m/s, under which a rover stands
AHEAD = 1.5  # m of ground known before and behind the path

CUADRIGA = """name = "Cuadriga, straight stretches of 14 drives"
kind = "traverse"
model = "two_wheeled_speed"
[columns]
"current_side" = { signal = "current", wheels = [1, 2] }
[parameters]
"wheel.radius" = 0.207
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

HUSKY = """name = "Husky on {ground}"
kind = "traverse"
model = "two_wheeled_speed"
ignore = ["rim_speed_right", "current_right", "ax", "ay", "az", "gyro_yaw", "gyro_pitch"]
[columns]
"run" = {{ run = true }}
"time" = "time"
"rim_speed_left" = {{ signal = "rim_speed_command", wheels = [1, 2] }}
"current_left" = {{ signal = "current", wheels = [1, 2] }}
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
[[run]]
file = "{file}"
"""


def number(text):
    return float(text) if text not in ("", "nan") else math.nan


def cuadriga(files, folder):
    """Writes the straight stretches of the drives; gives their number."""
    runs, count = [], 0
    for file in files:
        rows = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(file.open())]
        for stretch in straight(rows):
            count += 1
            runs.append(write(stretch, folder, f"{file.stem}_{count}"))
    (folder / "experiment.toml").write_text(CUADRIGA + "".join(runs), encoding="ascii")
    return count


def straight(rows):
    """Stretches in which the rover drives on without turning; ways are those of the positions, smoothed over a second."""
    found, at = [], 0
    heading = [math.radians(r["imu_yaw_deg"]) for r in rows]
    moving = [abs(r["wheel_left"]) * RIM > SLOW and abs(r["wheel_right"]) * RIM > SLOW for r in rows]
    while at < len(rows):
        if not moving[at]:
            at += 1
            continue
        end = at + 1
        turned = lambda k: abs(math.remainder(heading[k] - heading[at], math.tau))
        while end < len(rows) and moving[end] and turned(end) < TURN:
            end += 1
        if rows[end - 1]["time"] - rows[at]["time"] >= SHORT:
            found.append(rows[at:end])
        at = end
    return found


def smoothed(values, half=5):
    return [sum(values[max(0, k - half) : k + half + 1]) / len(values[max(0, k - half) : k + half + 1]) for k in range(len(values))]


def write(rows, folder, name):
    """CSV files of a stretch; its entry in experiment.toml."""
    east, north = smoothed([r["easting"] for r in rows]), smoothed([r["northing"] for r in rows])
    way = [0.0]
    for k in range(1, len(rows)):
        way.append(way[-1] + math.hypot(east[k] - east[k - 1], north[k] - north[k - 1]))
    height = smoothed([r["dem_z"] for r in rows])
    ground, last = [], -math.inf
    for x, z in zip(way, height):
        if x - last >= 0.25:
            ground.append((x, z))
            last = x
    first, final = slope(ground[:4]), slope(ground[-4:])
    ends = [(-AHEAD, ground[0][1] - first * AHEAD)], [(ground[-1][0] + AHEAD, ground[-1][1] + final * AHEAD)]
    lines = ["x,z"] + [f"{x:.3f},{z:.4f}" for x, z in ends[0] + ground + ends[1]]
    (folder / f"{name}_ground.csv").write_text("\n".join(lines) + "\n", encoding="ascii")
    # Wheels that drive forward count negative. The mean of both sides is the planar rover.
    speed = lambda r: -0.5 * (r["wheel_left"] + r["wheel_right"]) * RIM / CUADRIGA_RADIUS
    current = lambda r: 0.5 * (r["current_left"] + r["current_right"])
    start = rows[0]["time"]
    # The IMU is tilted by about -13 degrees, and its pitch falls uphill (correlation with the slope of the map -0.7).
    cell = lambda v: "" if math.isnan(v) else f"{v:.5f}"
    lines = ["time,wheel[1].speed_command,wheel[2].speed_command,x,velocity,pitch,current_side"]
    for k, r in enumerate(rows):
        pitch = -math.radians(r["imu_pitch_deg"] + 13.0)
        values = [r["time"] - start, speed(r), speed(r), way[k], r["velocity"], pitch, current(r)]
        lines.append(",".join(cell(v) for v in values))
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="ascii")
    return f'[[run]]\nfile = "{name}.csv"\nterrain = "{name}_ground.csv"\nx0 = 0.0\n'


def slope(points):
    (x0, z0), (x1, z1) = points[0], points[-1]
    return (z1 - z0) / (x1 - x0) if x1 > x0 else 0.0
