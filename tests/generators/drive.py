"""Effects between the rim and the recorded signals: friction, gear, motor, resistances, sensors."""

import numpy as np

from ground import on

REVERSAL = 0.01  # rad/s, over which dry friction changes its sign
STRIBECK = 0.6  # rad/s
COPPER = 0.0039  # 1/K
MAGNET = 0.0011  # 1/K, share that K_t loses


def motor_torque(p, rim_torque, speed):
    """Torque of the motor on the wheel's side of the gear."""
    torque = rim_torque
    sign = speed / np.sqrt(speed * speed + REVERSAL * REVERSAL)
    if (s := on(p, "gear_efficiency.constant")) is not None:  # s = 1 - eta
        torque = np.where(torque * speed >= 0.0, torque / (1.0 - s), torque * (1.0 - s))
    if (s := on(p, "gear_efficiency.load")) is not None:  # a worm: the loss shrinks with load to s from 1.5 s
        loss = s * (1.0 + 0.5 * np.exp(-np.abs(torque) / 2.0))
        torque = np.where(torque * speed >= 0.0, torque / (1.0 - loss), torque * (1.0 - loss))
    if (s := on(p, "coulomb_friction.constant")) is not None:
        torque = torque + s * sign
    if (s := on(p, "coulomb_friction.stribeck")) is not None:
        torque = torque + s * sign * (1.0 + 0.3 * np.exp(-((speed / STRIBECK) ** 2)))
    if (s := on(p, "viscous_friction.linear")) is not None:
        torque = torque + s * speed
    if (s := on(p, "viscous_friction.power")) is not None:  # grease: B omega |omega|^0.2
        torque = torque + s * speed * np.abs(speed) ** 0.2
    return torque


def recorded_torque(p, torque):
    """What a torque channel (or the current times a nominal constant) shows."""
    if (s := on(p, "torque_scale.gain")) is not None:
        torque = torque * (1.0 + s)
    if (s := on(p, "torque_scale.saturating")) is not None:  # the gain of an amplifier that sags a little
        torque = torque * (1.0 + s * (1.0 - 0.02 * np.abs(torque)))
    return torque


def resistance(p, velocity, travelled):
    """Horizontal force on the body or carriage, N."""
    force = 0.0 * velocity
    sign = velocity / np.sqrt(velocity * velocity + 1e-6)
    if (s := on(p, "drag.constant")) is not None:
        force = force - s * sign
    if (s := on(p, "drag.speed")) is not None:  # grows a little with speed
        force = force - s * sign * (1.0 + 0.3 * np.abs(velocity) / 0.1)
    if (s := on(p, "drag.growth")) is not None:  # s in N s/m
        force = force - s * velocity
    if (s := on(p, "tether.linear")) is not None:
        force = force - s * np.maximum(travelled, 0.0)
    if (s := on(p, "tether.slack")) is not None:  # a cable that drags after its first half metre
        far = travelled - 0.5
        force = force - s * 0.5 * (far + np.sqrt(far * far + 0.01))
    return force


def windings(p, time, loss):
    """Factors on resistance and torque constant as the windings warm up; `loss` is R I^2 of each cold winding, W."""
    rise = 0.0 * loss
    if (s := on(p, "winding_heat.loss")) is not None:  # dT' = (R_th R I^2 - dT)/tau, s = R_th in K/W
        rise = rise + warmed(time, s * loss, 100.0)
    if (s := on(p, "winding_heat.ramp")) is not None:  # heated from outside as well (the sun): steadily, s K in 24 s
        rise = rise + s * np.reshape(time, (-1,) + (1,) * (loss.ndim - 1)) / 24.0
    return 1.0 + COPPER * rise, 1.0 - MAGNET * rise


def warmed(time, final, constant):
    """First-order warming towards `final` (samples along axis 0)."""
    rise = np.zeros_like(final)
    for k in range(1, len(final)):
        rise[k] = final[k] + (rise[k - 1] - final[k]) * np.exp(-(time[k] - time[k - 1]) / constant)
    return rise


def ripple(p, turned):
    """Outside the library: a torque ripple once a wheel turn, N m."""
    s = on(p, "ripple.turn")
    return 0.0 if s is None else s * np.sin(turned)


def sensor_lag(p, time, signal):
    """Signal (sample, run, channel) at these times after the lag of its sensor, s."""
    if (s := on(p, "sensor_lag.first_order")) is not None:
        signal = first_order(signal, np.maximum(np.asarray(s), 1e-9), time)
    if (s := on(p, "sensor_lag.dead_time")) is not None:
        signal = delayed(signal, np.broadcast_to(np.asarray(s).ravel(), signal.shape[1:2]), time)
    return signal


def first_order(signal, lag, time):
    """y' = (u - y)/lag, exact for an input that is straight from sample to sample."""
    lagged = np.array(signal, float)
    for k in range(1, len(lagged)):
        step = time[k] - time[k - 1]
        slope = (signal[k] - signal[k - 1]) / step
        start = signal[k - 1] - lag * slope
        lagged[k] = signal[k] - lag * slope + (lagged[k - 1] - start) * np.exp(-step / lag)
    return lagged


def delayed(signal, lag, time):
    """The signal `lag` seconds earlier (one a run), straight between samples."""
    shifted = np.empty_like(signal)
    for run, channel in np.ndindex(signal.shape[1:]):
        shifted[:, run, channel] = np.interp(time - lag[run], time, signal[:, run, channel])
    return shifted
