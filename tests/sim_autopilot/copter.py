"""ArduCopter for tests: the stand-in's configuration, its mode numbers, and a pilot that takes off in GUIDED."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.ground_station.ardupilot import ARDUPILOT_STATION
from sim_autopilot.interfaces import AutopilotConfig
from tests.sim_autopilot.pilot import DATUM, Pilot, arm, command

STABILIZE, ALT_HOLD, AUTO, GUIDED, LOITER, RTL, LAND = 0, 2, 3, 4, 5, 6, 9
POSHOLD, BRAKE, SMART_RTL = 16, 17, 21
DRIFT, THROW, AVOID, NO_GPS, ZIGZAG = 11, 18, 19, 20, 24


PLUGGED_IN = {"firmware": ARDUPILOT, "services": ARDUPILOT_STATION, "datum": DATUM, "instant": True}


def ardupilot(**changes: object) -> AutopilotConfig:
    """The autopilot, ready at once."""
    return AutopilotConfig(**(PLUGGED_IN | changes))  # type: ignore[arg-type]  # of any field


def mode(number: int) -> Message:
    """A DO_SET_MODE."""
    return command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, float(number))


def every(message_id: int, hz: float) -> Message:
    """A SET_MESSAGE_INTERVAL."""
    return command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, float(message_id), 1e6 / hz)


def heartbeat(pilot: Pilot) -> tuple[int, int, int]:
    """Base mode, custom mode and status of the next heartbeat."""
    pilot.run(1.01)
    beat = pilot.last("HEARTBEAT")
    return beat.base_mode, beat.custom_mode, beat.system_status


def copter_in_the_air(config: AutopilotConfig | None = None, height_m: float = 10.0) -> Pilot:
    """A pilot whose drone hovers in GUIDED, taken off by command."""
    pilot = Pilot(config or ardupilot())
    pilot.step(mode(GUIDED), arm())
    take_off(pilot, height_m)
    pilot.run_until(lambda: pilot.position[2] > height_m - 0.1, 40.0)
    pilot.run(3.0)
    return pilot


def take_off(pilot: Pilot, height_m: float) -> list[int]:
    """Command the take-off, and return how it is acknowledged."""
    return pilot.acknowledged(command(mavlink.MAV_CMD_NAV_TAKEOFF, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height_m))
