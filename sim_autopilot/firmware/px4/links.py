"""PX4's MAVLink links: where its simulation opens them, and at which rates it streams to a ground station.

Source: PX4's ROMFS/px4fmu_common/init.d-posix/px4-rc.mavlink and mavlink_main.cpp, and as seen on its simulation.
"""

from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.core.firmware import DefaultLink, LinkRules

_REMOTE_PORT_LAST = 14549  # companions of more than ten instances share it
_GROUND_RATES_HZ = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: 1.0,
        mavlink.MAVLINK_MSG_ID_ALTITUDE: 1.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: 50.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 50.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: 50.0,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
        mavlink.MAVLINK_MSG_ID_CURRENT_MODE: 0.5,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.5,
        mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 0.5,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 1.0,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 50.0,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 5.0,
        mavlink.MAVLINK_MSG_ID_HOME_POSITION: 0.5,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 50.0,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 1.0,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: 1.0,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: 50.0,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS: 20.0,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: 1.0,
        mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 50.0,
        mavlink.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: 4.0,
        mavlink.MAVLINK_MSG_ID_VIBRATION: 0.1,
    }
)
"""Of the link to a ground station, as its simulation sets it up; messages that are not simulated are left out."""


def _default_links(instance: int) -> tuple[DefaultLink, ...]:
    companion_port = min(14540 + instance, _REMOTE_PORT_LAST)
    return (
        DefaultLink(device=f"udpout:127.0.0.1:{companion_port}:{14580 + instance}"),
        DefaultLink(device=f"udpout:127.0.0.1:14550:{18570 + instance}", is_ground=True),
    )


LINKS = LinkRules(defaults=_default_links, answers_ping=True, takes_signing=False, ground_rates_hz=_GROUND_RATES_HZ)
