"""ArduCopter's GUIDED by SET_ATTITUDE_TARGET: an attitude or turn rates, and a climb rate in place of the thrust.

A thrust of 0.5 holds the height, 1 climbs with WPNAV_SPEED_UP and 0 sinks with WPNAV_SPEED_DN; with its bit of
GUID_OPTIONS the thrust is one. A message that does not give its thrust, some of three rates, or no unit quaternion,
stops.
"""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from link.frames.rotations import flu_from_frd, quaternion_enu_flu_from_ned_frd, quaternion_from_roll_pitch_yaw, rotate
from link.mavlink.dialect import Message
from link.messages import Quaternion, Vector3
from sim_autopilot.core.data import Reference
from sim_autopilot.core.limits import PathLimits
from sim_autopilot.core.settings import FlightSettings
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.setpoints.attitude import attitude_reference, holding_thrust_m_s2

_RATES = 0b0000_0111
_NO_THRUST = 0b0100_0000
_NO_ATTITUDE = 0b1000_0000
_UNIT_WITHIN = 1e-3
_HOLDS = 0.5
_UP = (0.0, 0.0, 1.0)
_STILL = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class AttitudeWish:
    """What a SET_ATTITUDE_TARGET asks for.

    Attributes:
        orientation_wxyz: q_WB; None follows the rates alone.
        rates_flu_rad_s: w_WB in B.
        climb_m_s: upwards.
        thrust_m_s2: along z of B, over the mass, in place of the climb rate; None without.
    """

    orientation_wxyz: Quaternion | None
    rates_flu_rad_s: Vector3
    climb_m_s: float = 0.0
    thrust_m_s2: float | None = None

    @property
    def rises(self) -> bool:
        """Whether it takes a drone off the ground."""
        return self.climb_m_s > 0.0 if self.thrust_m_s2 is None else self.thrust_m_s2 > 0.0


def attitude_wish(message: Message, settings: FlightSettings, limits: PathLimits) -> AttitudeWish | None:
    """Return what a SET_ATTITUDE_TARGET asks for, None where it stops the drone."""
    mask, rates = message.type_mask, (message.body_roll_rate, message.body_pitch_rate, message.body_yaw_rate)
    ignored = mask & _RATES
    if mask & _NO_THRUST or ignored not in {0, _RATES} or not isfinite(message.thrust):
        return None
    rates = _STILL if ignored else rates
    q = None if mask & _NO_ATTITUDE else tuple(message.q)
    if not all(map(isfinite, rates)):
        return None
    if q is not None and not (all(map(isfinite, q)) and abs(sum(part * part for part in q) - 1.0) < _UNIT_WITHIN):
        return None
    share = max(0.0, min(1.0, message.thrust))
    speed_m_s = limits.climb_m_s if share > _HOLDS else limits.descent_m_s
    by_thrust = settings.setpoints.thrust_as_thrust
    return AttitudeWish(
        orientation_wxyz=None if q is None else quaternion_enu_flu_from_ned_frd(q),
        rates_flu_rad_s=flu_from_frd(rates),
        climb_m_s=0.0 if by_thrust else (share - _HOLDS) / _HOLDS * speed_m_s,
        thrust_m_s2=GRAVITY_M_S2 * share / settings.setpoints.hover_share if by_thrust else None,
    )


def level_out(now: Snapshot) -> AttitudeWish:
    """Return what is flown when nothing has come for too long: level, at this height."""
    level = quaternion_from_roll_pitch_yaw(0.0, 0.0, now.yaw_rad)
    return AttitudeWish(orientation_wxyz=level, rates_flu_rad_s=_STILL)


def attitude_flown(wish: AttitudeWish, height_m: float, now: Snapshot) -> Reference:
    """Return what to follow; `height_m` in W is where the climb rate has led to."""
    thrust_m_s2 = wish.thrust_m_s2
    if thrust_m_s2 is None:
        level = rotate(now.orientation_wxyz, _UP)[2]
        thrust_m_s2 = holding_thrust_m_s2(height_m, wish.climb_m_s, now, level)
    q = None if wish.orientation_wxyz is None else np.array(wish.orientation_wxyz)
    return attitude_reference(q, np.array(wish.rates_flu_rad_s), thrust_m_s2)
