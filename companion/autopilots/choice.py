"""Which driver goes with which autopilot, and what to say where none was heard."""

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.px4 import Px4Driver
from companion.config.autopilot import AutopilotKind
from link.errors import UserError
from link.mavlink.dialect import mavlink
from link.mavlink.session import MavlinkSession

_DRIVERS: tuple[Driver, ...] = (Px4Driver(), ArduPilotDriver())
MULTIROTORS = frozenset(
    {
        mavlink.MAV_TYPE_QUADROTOR,
        mavlink.MAV_TYPE_HEXAROTOR,
        mavlink.MAV_TYPE_OCTOROTOR,
        mavlink.MAV_TYPE_TRICOPTER,
        mavlink.MAV_TYPE_COAXIAL,
        mavlink.MAV_TYPE_DODECAROTOR,
        mavlink.MAV_TYPE_DECAROTOR,
    }
)
"""MAV_TYPE of what can be flown."""


WHY_REFUSED = (
    "not signed with this --signing-key, or the autopilot's time is more than a minute behind or has gone back; "
    "give both the same key and the right time"
)
"""What MAVLink messages are not taken for where a key is given, and what to change."""


def driver_for(autopilot_id: int, vehicle_type: int, kind: AutopilotKind = AutopilotKind.AUTO) -> Driver:
    """Return the driver for a heartbeat's MAV_AUTOPILOT.

    Raises:
        UserError: no driver flies this autopilot, it is not of the kind asked for, or the vehicle is no multirotor.
    """
    known = ", ".join(driver.name for driver in _DRIVERS)
    if vehicle_type not in MULTIROTORS:
        raise UserError(f"the vehicle is of MAV_TYPE {vehicle_type}, which is no multirotor: connect to one")
    for driver in _DRIVERS:
        if driver.autopilot_id == autopilot_id:
            if kind.value not in (AutopilotKind.AUTO.value, driver.name):
                raise UserError(f"the autopilot is {driver.name}, not {kind.value}: use --firmware auto")
            return driver
    raise UserError(f"the autopilot is of MAV_AUTOPILOT {autopilot_id}, which is not supported: use one of {known}")


def check_autopilot(session: MavlinkSession, device: str, timeout_s: float) -> None:
    """See to it that an autopilot was heard.

    Args:
        session: to it.
        device: that it was listened to on, for messages.
        timeout_s: for how long.

    Raises:
        UserError: none was.
    """
    if session.autopilot is None:
        raise UserError(f"no heartbeat of an autopilot within {timeout_s:g} s on {device}: {_describe_heard(session)}")


def _describe_heard(session: MavlinkSession) -> str:
    """Return what came instead, with what to change."""
    causes, codec = [], session.statistics.codec
    if session.other_system_ids:
        others = ", ".join(map(str, sorted(session.other_system_ids)))
        causes.append(f"autopilots of system {others} were heard, see --system-id")
    if codec.refused_messages:
        causes.append(f"{codec.refused_messages} messages were refused: {WHY_REFUSED}")
    if causes:
        return "; ".join(causes)
    if codec.bytes_received and not codec.messages_received:
        look = "check the baud rate, and that this port of the autopilot sends MAVLink"
        return f"{codec.bytes_received} bytes received, and no message in them: {look}"
    came = f"{codec.bytes_received} bytes received, {codec.messages_received} messages, none of them its heartbeat"
    return f"{came if codec.bytes_received else 'nothing was received'}; check --mavlink and the autopilot's port"
