"""Every listed parameter is read: another allowed value changes the signals or the way a drive ends."""

from functools import cache

import pytest

import bekker

DURATION = 3.0
INPUTS = {"torque": 0.13, "speed": 2.5, "speed_loop": 2.5}  # torque: N m a kilogram of rover; rad/s

# Where a change by a tenth cannot be seen: values at which a limit bites or another effect needs it.
BITING = {
    "rover.belly_z": -0.12,
    "motor.inverse_torque_limit": 10.0,
    "motor.inverse_current_limit": 50.0,
    "voltage_limit.inverse_voltage": 5.0,
    "motor.inverse_voltage": 5.0,
    "rtc.switch_angle": 0.02,
    "rim_adhesion.loss": 0.8,
    "flexible_wheel.compliance": 1e-4,
    # Within what the joint turns on these waves.
    "link[1].stop": 0.01,
    # Whole numbers of inner steps.
    "velocity_control.period": 0.02,
    "rtc.period": 0.02,
    # Longer than the control period.
    "sensor.pitch_period": 0.05,
    "sensor.velocity_period": 0.05,
    "sensor.contact_angle_period": 0.05,
    "sensor.wheel_speed_period": 0.05,
}
# A parameter that acts through another needs that one to be on.
TOGETHER = {
    "velocity_control.derivative_filter": ("velocity_control.kd", 0.001),
    "rtc.speed_band": ("rtc.speed_kp", 0.5),
    "sensor.wheel_speed_noise": ("rtc.speed_kp", 0.5),
    "sensor.wheel_speed_bias": ("rtc.speed_kp", 0.5),
    "sensor.wheel_speed_resolution": ("rtc.speed_kp", 0.5),
    "sensor.wheel_speed_period": ("rtc.speed_kp", 0.5),
    "winding_heat.time_constant": ("winding_heat.thermal_resistance", 5.0),
    "slip_sinkage.length": ("slip_sinkage.n1", 0.4),
    "grousers.share": ("grousers.height", 0.01),
    "bulldozing.unit_weight": ("bulldozing.share", 1.0),
    "rim_adhesion.rounding": ("rim_adhesion.loss", 0.8),
    "flexible_wheel.arm_share": ("flexible_wheel.compliance", 1e-4),
    "flexible_wheel.arc_by_sinkage": ("flexible_wheel.compliance", 1e-4),
    "flexible_wheel.arc_by_load": ("flexible_wheel.compliance", 1e-4),
    "rate.reference_speed": ("rate.exponent", 0.1),
    "rate.slowest_speed": ("rate.exponent", 0.1),
    "moisture.content": ("moisture.cohesion_slope", 5000.0),
    "moisture.cohesion_slope": ("moisture.content", 0.1),
    "soft_patch.centre": ("soft_patch.softening", 0.5),
    "soft_patch.half_width": ("soft_patch.softening", 0.5),
    "link[1].stop_stiffness": ("link[1].stop", 0.01),
}
# The rear wheel has to reach where the front wheel started.
LONGER = {"multi_pass.growth": 9.0}

PRESETS = ("two_wheeled", "two_wheeled_speed", "gentle_velocity", "gentle_rtc", "rocker_bogie_velocity", "two_wheeled speed_loop")


def on_waves(preset: str) -> bekker.Model:
    """A preset, where a second word follows with that kind of control, on waves."""
    preset, *kind = preset.split()
    control = f"[control]\nkind = '{kind[0]}'\n" if kind else ""
    terrain = "preset = 'waves'\namplitude = 0.03\nwavelength = 1.5\nstart = 0.0"
    return bekker.Model.from_toml(f"preset = '{preset}'\n{control}[terrain]\n{terrain}")


def driven(model: bekker.Model, duration: float) -> list[object]:
    command = INPUTS.get(model.control)
    if command is not None and model.control == "torque":
        command *= model.total_mass
    inputs = None if command is None else {variable["name"]: command for variable in model.inputs()}
    result = bekker.simulate(model, duration, inputs, period=0.02)
    return [result.status, *(column.tobytes() for column in result.values())]


@cache
def undisturbed(preset: str, companion: tuple[str, float] | None, duration: float) -> list[object]:
    model = on_waves(preset)
    if companion is not None:
        model.set(*companion)
    return driven(model, duration)


def other(variable: dict[str, float]) -> float:
    """Another allowed value, a tenth (or a hundredth of a unit) away."""
    value, low, high = variable["value"], variable["min"], variable["max"]
    candidates = (value * 1.1 if value else 0.01, value * 0.9)
    return next(candidate for candidate in candidates if low <= candidate <= high)


def cases() -> list[tuple[str, str]]:
    return [(preset, variable["name"]) for preset in PRESETS for variable in on_waves(preset).parameters()]


@pytest.mark.parametrize(("preset", "name"), cases())
def test_property_a_parameter_changes_the_result(preset: str, name: str) -> None:
    model = on_waves(preset)
    companion = TOGETHER.get(name)
    if companion is not None and companion[0] not in {variable["name"] for variable in model.parameters()}:
        companion = None
    if companion is not None:
        model.set(*companion)
    variable = next(variable for variable in model.parameters() if variable["name"] == name)
    value = BITING.get(name, None)
    model.set(name, other(variable) if value is None else value)
    assert model.get(name) != variable["value"]
    duration = LONGER.get(name, DURATION)
    assert driven(model, duration) != undisturbed(preset, companion, duration)
