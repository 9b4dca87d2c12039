"""The pad on ground stations' maps: a target to follow, or a vehicle in the traffic.

FOLLOW_TARGET reaches whoever reads it, and an autopilot in its follow mode. ADSB_VEHICLE is what ground stations draw;
it has no heading and no velocity, since with these PX4 would take the pad for traffic and warn of it, or give way.
Source: MAVLink common, messages 144 and 246; PX4 1.17, navigator_main.cpp, check_traffic.
"""

import math

from companion.autopilots.state import AutopilotState
from companion.vehicle.pad import PadPath
from link.frames.geodesy import geodetic_from_local
from link.frames.rotations import ned_from_enu
from link.mavlink.dialect import Message, mavlink

_HAS_PLACE, _HAS_VELOCITY, _HAS_ACCELERATION = 1, 2, 4
_CALLSIGN = b"PAD"
_ADDRESS = 0xDEC0  # of the 24 bits that aircraft have; the block from 0 on belongs to no state
_SEEN_FLAGS = mavlink.ADSB_FLAGS_VALID_COORDS | mavlink.ADSB_FLAGS_VALID_ALTITUDE | mavlink.ADSB_FLAGS_VALID_CALLSIGN


def follow_target(pad: PadPath, state: AutopilotState, boot_ms: int) -> Message | None:
    """Return the FOLLOW_TARGET of the pad's centre, None while its place on the earth is not known."""
    place = _above_sea(pad, state)
    if place is None:
        return None
    latitude_1e7, longitude_1e7, altitude_m = place
    x_std, y_std, z_std = pad.position_std_m[0].tolist()
    return mavlink.MAVLink_follow_target_message(
        timestamp=boot_ms,
        est_capabilities=_HAS_PLACE | _HAS_VELOCITY | _HAS_ACCELERATION,
        lat=latitude_1e7,
        lon=longitude_1e7,
        alt=altitude_m,
        vel=list(ned_from_enu(tuple(pad.velocity_enu_m_s[0].tolist()))),
        acc=list(ned_from_enu(tuple(pad.acceleration_enu_m_s2[0].tolist()))),
        attitude_q=[1.0, 0.0, 0.0, 0.0],
        rates=[0.0, 0.0, 0.0],
        position_cov=[x_std**2, y_std**2, z_std**2],
        custom_state=0,
    )


def adsb_vehicle(pad: PadPath, state: AutopilotState) -> Message | None:
    """Return the ADSB_VEHICLE of the pad's centre, None while its place on the earth is not known."""
    place = _above_sea(pad, state)
    if place is None:
        return None
    latitude_1e7, longitude_1e7, altitude_m = place
    return mavlink.MAVLink_adsb_vehicle_message(
        ICAO_address=_ADDRESS,
        lat=latitude_1e7,
        lon=longitude_1e7,
        altitude_type=mavlink.ADSB_ALTITUDE_TYPE_GEOMETRIC,
        altitude=round(altitude_m * 1e3),
        heading=0,
        hor_velocity=0,
        ver_velocity=0,
        callsign=_CALLSIGN,
        emitter_type=mavlink.ADSB_EMITTER_TYPE_SERVICE_SURFACE,
        tslc=0,
        flags=_SEEN_FLAGS,
        squawk=0,
    )


def _above_sea(pad: PadPath, state: AutopilotState) -> tuple[int, int, float] | None:
    """Return latitude and longitude in 1e-7 degrees and the height above the sea in m."""
    frame = state.view.frame
    if frame is None:
        return None
    x, y, z = pad.position_enu_m[0].tolist()
    latitude_rad, longitude_rad, altitude_m = geodetic_from_local(frame, (x, y, z))
    above_sea_m = altitude_m - (state.geoid.height_m or 0.0)
    return round(math.degrees(latitude_rad) * 1e7), round(math.degrees(longitude_rad) * 1e7), above_sea_m
