"""SET_ATTITUDE_TARGET: an attitude or turn rates, with a thrust."""

from math import isfinite

import numpy as np

from link.frames.rotations import flu_from_frd, normalized, quaternion_enu_flu_from_ned_frd
from link.mavlink.dialect import Message
from sim_autopilot.core.data import AttitudeTarget, Reference
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.plant.snapshot import Snapshot

_RATES = 0b0000_0111
_NO_THRUST = 0b0100_0000
_NO_ATTITUDE = 0b1000_0000
_NORM_MIN = 0.5
_LEVEL_MIN = 0.2
_HEIGHT_GAIN_PER_S2, _CLIMB_GAIN_PER_S = 4.0, 4.0


def attitude_from_message(message: Message, hover_share: float) -> Reference | None:
    """Return what a SET_ATTITUDE_TARGET asks for, None where that cannot be flown.

    Args:
        message: the setpoint.
        hover_share: of the full thrust, that carries the drone.
    """
    mask, rates = message.type_mask, (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
    if mask & _NO_THRUST or not isfinite(message.thrust):
        return None
    asked = tuple(0.0 if mask & bit else rate for bit, rate in zip((1, 2, 4), rates, strict=True))
    q = None if mask & _NO_ATTITUDE else tuple(message.q)
    if not all(map(isfinite, asked)) or (q is None and mask & _RATES == _RATES):
        return None
    if q is not None and not (all(map(isfinite, q)) and sum(part * part for part in q) > _NORM_MIN):
        return None
    share = max(0.0, min(1.0, message.thrust))
    return attitude_reference(
        None if q is None else np.array(quaternion_enu_flu_from_ned_frd(normalized(q))),
        np.array(flu_from_frd(asked)),
        GRAVITY_M_S2 * share / hover_share,
    )


def holding_thrust_m_s2(height_m: float, climb_m_s: float, now: Snapshot, level: float) -> float:
    """Return the specific thrust that follows a height in W and its rate, with `level` the cosine of the tilt."""
    up = GRAVITY_M_S2 + _HEIGHT_GAIN_PER_S2 * (height_m - now.position_enu_m[2])
    up += _CLIMB_GAIN_PER_S * (climb_m_s - now.velocity_enu_m_s[2])
    return max(0.0, up) / max(_LEVEL_MIN, level)


def attitude_reference(
    orientation_wxyz: np.ndarray | None, rates_flu_rad_s: np.ndarray, thrust_m_s2: float
) -> Reference:
    """Return a reference that bypasses the outer loop."""
    return Reference(
        position_enu_m=None,
        velocity_enu_m_s=None,
        acceleration_enu_m_s2=None,
        yaw_rad=None,
        attitude=AttitudeTarget(
            orientation_wxyz=orientation_wxyz, rates_flu_rad_s=rates_flu_rad_s, thrust_m_s2=thrust_m_s2
        ),
    )
