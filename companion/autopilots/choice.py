"""Which driver goes with which autopilot."""

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.px4 import Px4Driver
from companion.config.autopilot_kind import AutopilotKind
from link.errors import UserError
from link.mavlink.dialect import mavlink

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
                raise UserError(f"the autopilot is {driver.name}, not {kind.value}: use --autopilot auto")
            return driver
    raise UserError(f"the autopilot is of MAV_AUTOPILOT {autopilot_id}, which is not supported: use one of {known}")
