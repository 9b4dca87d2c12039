"""Stations in the vehicle's own way are kept clear of its roof: there every outage would end under it; pure.

A drone ahead of the vehicle that hears nothing for a moment stops, and the vehicle does not. One behind it runs into a
vehicle that brakes: with the deceleration mu g against its own a, and data that are as old as T, it comes nearer by
`v^2 / 2 (1/a - 1/(mu g)) + v T`.
"""

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import GRAVITY_M_S2, Array, FlightLimits
from companion.landing.sortie.over_vehicle import keep_out_now
from companion.sortie.station import ahead_rad, keep_outside, turned
from companion.vehicle.pad import PadPath
from link.messages import Station, StationFrame

_FRICTION = 0.8  # of tyres on a dry road, which bounds how a vehicle brakes


def kept_station_m(
    station: Station, before_rad: float, pad: PadPath, limits: FlightLimits, config: CompanionConfig
) -> Array:
    """Return where a station (3,) is kept in its frame: outside of the vehicle, and high where it is in its way.

    Args:
        station: as it was ordered.
        before_rad: where ahead was when it could be told.
        pad: its path.
        limits: of the drone.
        config: with the vehicle's size, and how old its data may be before a station is broken off.
    """
    keep_out = keep_out_now(pad, config)
    kept_m = keep_outside(np.array(station.offset_m), keep_out)
    ahead = ahead_rad(station.frame, pad, before_rad)
    ahead_m, left_m, up_m = turned(kept_m, ahead - ahead_rad(StationFrame.VEHICLE, pad, before_rad)).tolist()
    # A vehicle is longer than it is wide: half of its length to each side leaves the rotors their margin, too.
    swept_m = keep_out.radius_m - config.sortie.keep_out_margin_m
    if abs(left_m) >= swept_m or up_m >= keep_out.over_m:
        return kept_m
    room_m = keep_out.radius_m + nears_m(pad.ground_speed_m_s, limits, config.abort.fix_age_max_s)
    return kept_m if ahead_m <= -room_m else np.array([*kept_m[:2].tolist(), keep_out.over_m])


def nears_m(speed_m_s: float, limits: FlightLimits, late_s: float) -> float:
    """Return how much nearer a drone comes to a vehicle ahead of it that brakes as hard as tyres can."""
    longer_s2_m = max(1.0 / limits.acceleration_max_m_s2 - 1.0 / (_FRICTION * GRAVITY_M_S2), 0.0)
    return 0.5 * speed_m_s**2 * longer_s2_m + speed_m_s * late_s
