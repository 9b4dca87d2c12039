"""ArduCopter's modes and their numbers on the wire."""

from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.core.firmware import ModeCode, ModeRules
from sim_autopilot.core.modes import Mode

_STICK_FLAGS = (
    mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
    | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
)
_POSITION_FLAGS = _STICK_FLAGS | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
"""Of every mode that controls the position."""


def _code(name: str, number: int, flags: int = _POSITION_FLAGS) -> ModeCode:
    return ModeCode(base_mode=flags, custom_mode=number, request=(number,), name=name)


_MODES = {
    Mode.STABILIZED: _code("STABILIZE", 0, _STICK_FLAGS),
    Mode.ACRO: _code("ACRO", 1, _STICK_FLAGS),
    Mode.ALTITUDE: _code("ALT_HOLD", 2, _STICK_FLAGS),
    Mode.MISSION: _code("AUTO", 3),
    Mode.OFFBOARD: _code("GUIDED", 4),
    Mode.POSITION: _code("LOITER", 5),
    Mode.RTL: _code("RTL", 6),
    Mode.ORBIT: _code("CIRCLE", 7),
    Mode.LAND: _code("LAND", 9),
    Mode.DRIFT: _code("DRIFT", 11, _STICK_FLAGS),
    Mode.POSHOLD: _code("POSHOLD", 16),
    Mode.BRAKE: _code("BRAKE", 17),
    Mode.THROW: _code("THROW", 18, _STICK_FLAGS),
    Mode.AVOID: _code("AVOID_ADSB", 19),
    Mode.GUIDED_NOGPS: _code("GUIDED_NOGPS", 20, _STICK_FLAGS),
    Mode.SMART_RTL: _code("SMART_RTL", 21),
    Mode.ZIGZAG: _code("ZIGZAG", 24, _STICK_FLAGS),
}

MODES = ModeRules(
    codes=MappingProxyType(_MODES),
    boot=Mode.STABILIZED,
    unarmable=frozenset({Mode.LAND, Mode.RTL, Mode.SMART_RTL, Mode.BRAKE, Mode.MISSION}),
    loiter=Mode.POSITION,
    of_flags=None,
    leaves_landing=False,
    tells_changes=True,
    answered_twice=False,
    set_mode_answered_as=None,
)
