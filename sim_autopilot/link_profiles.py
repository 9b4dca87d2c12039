"""What each firmware's simulator does with its MAVLink links: where it opens them, and how it treats them.

Sources: PX4's ROMFS/px4fmu_common/init.d-posix/px4-rc.mavlink and mavlink_main.cpp; ArduPilot's SITL and
GCS_MAVLink/GCS_Signing.cpp; both as seen on their simulations.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from link.mavlink.dialect import mavlink

_PX4_REMOTE_PORT_LAST = 14549  # PX4 has companions of more than ten instances share it
_PX4_GROUND_RATES_HZ = MappingProxyType(
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
"""PX4's link to a ground station, as its simulation sets it up; messages that are not simulated are left out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkProfile:
    """How a firmware treats its links.

    Attributes:
        answers_ping: whether it answers a PING to everybody.
        takes_signing: whether it obeys SETUP_SIGNING; if not, signed frames are taken unchecked.
        ground_rates_hz: by message id, on a link to a ground station; None for those of any link.
    """

    answers_ping: bool
    takes_signing: bool
    ground_rates_hz: Mapping[int, float] | None


PX4_LINKS = LinkProfile(answers_ping=True, takes_signing=False, ground_rates_hz=_PX4_GROUND_RATES_HZ)
ARDUPILOT_LINKS = LinkProfile(answers_ping=False, takes_signing=True, ground_rates_hz=None)


def link_profile(autopilot_id: int) -> LinkProfile:
    """Return how the firmware of a MAV_AUTOPILOT treats its links."""
    return ARDUPILOT_LINKS if autopilot_id == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA else PX4_LINKS


@dataclass(frozen=True, slots=True, kw_only=True)
class DefaultLink:
    """A link that is opened when none is named."""

    device: str
    is_ground: bool = False


def default_links(autopilot_id: int, instance: int) -> tuple[DefaultLink, ...]:
    """Return the links of the firmware's own simulator, with its ports shifted for the instance.

    Args:
        autopilot_id: MAV_AUTOPILOT.
        instance: number of the drone, from 0.
    """
    if autopilot_id == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA:
        return (
            DefaultLink(device=f"tcpin:127.0.0.1:{5760 + 10 * instance}"),
            DefaultLink(device=f"udpout:127.0.0.1:{14550 + 10 * instance}", is_ground=True),
        )
    companion_port = min(14540 + instance, _PX4_REMOTE_PORT_LAST)
    return (
        DefaultLink(device=f"udpout:127.0.0.1:{companion_port}:{14580 + instance}"),
        DefaultLink(device=f"udpout:127.0.0.1:14550:{18570 + instance}", is_ground=True),
    )
