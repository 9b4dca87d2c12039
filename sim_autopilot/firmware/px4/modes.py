"""PX4's modes: their numbers on the wire, and those that clients without custom modes ask for."""

from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.core.firmware import ModeCode, ModeRules
from sim_autopilot.core.modes import Mode

_AUTO_FLAGS = (
    mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    | mavlink.MAV_MODE_FLAG_AUTO_ENABLED
    | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
    | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
)
_OFFBOARD_FLAGS = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
_ACRO_FLAGS = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
_MANUAL_FLAGS = _OFFBOARD_FLAGS | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED


def _code(name: str, flags: int, main: int, sub: int = 0) -> ModeCode:
    return ModeCode(base_mode=flags, custom_mode=main << 16 | sub << 24, request=(main, sub), name=name)


_MODES = MappingProxyType(
    {
        Mode.OFFBOARD: _code("offboard", _OFFBOARD_FLAGS, 6),
        Mode.HOLD: _code("hold", _AUTO_FLAGS, 4, 3),
        Mode.LAND: _code("land", _AUTO_FLAGS, 4, 6),
        Mode.TAKEOFF: _code("takeoff", _AUTO_FLAGS, 4, 2),
        Mode.RTL: _code("rtl", _AUTO_FLAGS, 4, 5),
        Mode.MISSION: _code("mission", _AUTO_FLAGS, 4, 4),
        Mode.POSITION: _code("position", _MANUAL_FLAGS, 3),
        Mode.ORBIT: _code("orbit", _AUTO_FLAGS, 3, 1),
        Mode.FOLLOW: _code("follow", _AUTO_FLAGS, 4, 8),
        Mode.PRECISION_LAND: _code("precland", _AUTO_FLAGS, 4, 9),
        Mode.ALTITUDE: _code("altitude", _MANUAL_FLAGS, 2),
        Mode.STABILIZED: _code("stabilized", _MANUAL_FLAGS, 7),
        Mode.MANUAL: _code("manual", _MANUAL_FLAGS, 1),
        Mode.ACRO: _code("acro", _ACRO_FLAGS, 5),
    }
)


def _mode_of_flags(base: int) -> Mode | None:
    """Return the mode that the MAV_MODE_FLAGs of a client without custom modes ask PX4 for."""
    if base & mavlink.MAV_MODE_FLAG_AUTO_ENABLED:
        return Mode.MISSION
    if not base & mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED:
        return None
    if base & mavlink.MAV_MODE_FLAG_GUIDED_ENABLED:
        return Mode.POSITION
    return Mode.STABILIZED if base & mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED else Mode.MANUAL


MODES = ModeRules(
    codes=_MODES,
    boot=Mode.HOLD,
    unarmable=frozenset({Mode.LAND, Mode.PRECISION_LAND, Mode.RTL, Mode.ORBIT, Mode.FOLLOW}),
    loiter=Mode.HOLD,
    of_flags=_mode_of_flags,
    leaves_landing=True,
    tells_changes=False,
    answered_twice=True,
    set_mode_answered_as=mavlink.MAV_CMD_DO_SET_MODE,
)
