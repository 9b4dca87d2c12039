"""Position and velocity control as the firmwares have it: a proportional loop around a velocity controller (PID).

    v_w = v_ref + Kp (p_ref - p), inside the envelope;  e = v_w - v
    a = a_ref + Kv e + i + Kd s,   i' = Ki e

e passes a low-pass filter where the firmware has one. s is the slope of e (ArduPilot), or of -v (PX4), behind one. The
integral stands still on a surface. While the force is bounded it is drawn back by 2 / Kv of what is missing (PX4), or
grows no longer than it is in that direction (ArduPilot).
A place that is asked for without a velocity is approached with a bounded braking besides: the stand-in's own modes ask
for places so, where the firmwares make a way to them first.
Source: PX4 PositionControl::_positionControl, _velocityControl; ArduPilot AC_PosControl, AC_PID_2D.
"""

import math

from link.compiled import kernel
from sim_autopilot.control.outer_loop import VERTICAL_BRAKING_M_S2, fill_velocity_command
from sim_autopilot.control.parameters import (
    DISTURBANCE,
    HAS_ACCELERATION,
    HAS_POSITION,
    HAS_VELOCITY,
    MISSED,
    SLOPE,
    VELOCITY,
)
from sim_autopilot.core.data import Array
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.physics.parameters import Record


@kernel
def fill_pid_acceleration(y: Array, memory: Array, reference: Array, control: Record, error: Array, out: Array) -> None:
    """Write the acceleration (3,) in W that follows `reference`, and the velocity's error (3,) that it comes from."""
    period = control["period_s"]
    is_followed = reference[HAS_POSITION] + reference[HAS_VELOCITY] > 0.0
    is_bare = reference[HAS_VELOCITY] == 0.0
    braking = control["braking_m_s2"] if is_bare else math.inf
    vertical_braking = VERTICAL_BRAKING_M_S2 if is_bare else math.inf
    fill_velocity_command(y, reference, control, braking, vertical_braking, error)
    for i in range(3):
        off = error[i] - y[7 + i]
        out[i] = reference[6 + i] if reference[HAS_ACCELERATION] > 0.0 else 0.0
        if control["integral_gain"][i] >= 0.0:
            if control["derives_error"] == 1:
                off = memory[VELOCITY + i] + control["error_share"] * (off - memory[VELOCITY + i])
                slope, memory[VELOCITY + i] = (off - memory[VELOCITY + i]) / period, off
            else:
                slope, memory[VELOCITY + i] = (memory[VELOCITY + i] - y[7 + i]) / period, y[7 + i]
            memory[SLOPE + i] += control["slope_share"] * (slope - memory[SLOPE + i])
        else:
            memory[SLOPE + i] = 0.0
        error[i] = off
        if is_followed:
            correction = control["velocity_gain"][i] * off + control["derivative_gain"][i] * memory[SLOPE + i]
            out[i] += correction - memory[DISTURBANCE + i]


@kernel
def integrate(memory: Array, reference: Array, control: Record, asked: Array, force: Array, touching: bool) -> None:
    """Bring the integrals in `memory` on by a period.

    Args:
        memory: (17,) of the controller, changed.
        reference: (25,).
        control: the controller's record.
        asked: the velocity's error (3,), then the acceleration (3,) that was asked for.
        force: (3,) specific, what of it can be had.
        touching: whether the drone touches anything.
    """
    if touching or reference[HAS_POSITION] + reference[HAS_VELOCITY] == 0.0:
        return
    is_level_bound = memory[MISSED] != 0.0 or memory[MISSED + 1] != 0.0
    length = math.hypot(memory[DISTURBANCE], memory[DISTURBANCE + 1])
    for i in range(3):
        if control["integral_gain"][i] < 0.0:
            continue
        off = asked[i]
        missing = asked[3 + i] - (force[i] - (GRAVITY_M_S2 if i == 2 else 0.0))
        if i < 2 and is_level_bound and control["derives_error"] == 0:
            off -= 2.0 / control["velocity_gain"][0] * missing
        if i == 2 and missing * off > 0.0 and abs(missing) > 1e-9:
            off = 0.0
        integral = -memory[DISTURBANCE + i] + control["period_s"] * control["integral_gain"][i] * off
        memory[DISTURBANCE + i] = -min(GRAVITY_M_S2, max(-GRAVITY_M_S2, integral))
    if is_level_bound and control["derives_error"] == 1:
        grown = math.hypot(memory[DISTURBANCE], memory[DISTURBANCE + 1])
        towards = asked[0] * memory[MISSED] + asked[1] * memory[MISSED + 1] > 0.0
        if towards and grown > length:
            memory[DISTURBANCE] *= length / grown
            memory[DISTURBANCE + 1] *= length / grown
