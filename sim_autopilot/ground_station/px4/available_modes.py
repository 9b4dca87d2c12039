"""AVAILABLE_MODES as PX4 tells them, all at once or one by one: standard modes by number, the others by name.

Source: PX4, its names and numbers in the order of its navigation states; modes that are not simulated are left out.
"""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.commands.requests import ACCEPTED, Answer, Request
from sim_autopilot.core.modes import Mode
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory

_NO_STANDARD = int(mavlink.MAV_STANDARD_MODE_NON_STANDARD)
_MODES: tuple[tuple[Mode, int, str], ...] = (
    (Mode.MANUAL, _NO_STANDARD, "Manual"),
    (Mode.ALTITUDE, int(mavlink.MAV_STANDARD_MODE_ALTITUDE_HOLD), ""),
    (Mode.POSITION, int(mavlink.MAV_STANDARD_MODE_POSITION_HOLD), ""),
    (Mode.MISSION, int(mavlink.MAV_STANDARD_MODE_MISSION), ""),
    (Mode.HOLD, _NO_STANDARD, "Hold"),
    (Mode.RTL, int(mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY), ""),
    (Mode.ACRO, _NO_STANDARD, "Acro"),
    (Mode.OFFBOARD, _NO_STANDARD, "Offboard"),
    (Mode.STABILIZED, _NO_STANDARD, "Stabilized"),
    (Mode.TAKEOFF, int(mavlink.MAV_STANDARD_MODE_TAKEOFF), ""),
    (Mode.LAND, int(mavlink.MAV_STANDARD_MODE_LAND), ""),
    (Mode.FOLLOW, _NO_STANDARD, "Follow Target"),
    (Mode.PRECISION_LAND, _NO_STANDARD, "Precision Landing"),
    (Mode.ORBIT, int(mavlink.MAV_STANDARD_MODE_ORBIT), ""),
)
_SIMPLE = frozenset({Mode.ALTITUDE, Mode.POSITION})


def request_modes(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer | None:
    """Send AVAILABLE_MODES now; requests of other messages are the flight's."""
    if request.number(1) != mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES:
        return None
    modes = _available_modes(request.number(2) or 0, config)
    result = ACCEPTED if modes else config.firmware.commands.results.no_such_message
    return Answer(memory=memory, result=result, messages=modes)


def _available_modes(index: int, config: AutopilotConfig) -> tuple[Message, ...]:
    """Return the AVAILABLE_MODES at `index`, from 1; 0 is all of them, and one that does not exist is none."""
    chosen = range(1, len(_MODES) + 1) if index == 0 else (index,) if 1 <= index <= len(_MODES) else ()
    return tuple(_available_mode(one, config) for one in chosen)


def _available_mode(index: int, config: AutopilotConfig) -> Message:
    mode, standard, name = _MODES[index - 1]
    properties = 0 if mode in _SIMPLE else mavlink.MAV_MODE_PROPERTY_ADVANCED
    return mavlink.MAVLink_available_modes_message(
        len(_MODES), index, standard, config.firmware.modes.codes[mode].custom_mode, properties, name.encode()
    )
