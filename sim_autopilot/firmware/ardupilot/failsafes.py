"""ArduCopter's failsafes of battery, ground station and fence, as its parameters have them.

Names, types, defaults and what each action leads to: ArduCopter 4.6 parameter reference. The battery is a simulated
one of three cells whose voltage falls evenly.
"""

from link.mavlink.dialect import mavlink
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.core.parameters import Parameter, Values
from sim_autopilot.core.settings import FailsafeSettings

_EMPTY_PART = 9.9 / 12.6
"""Of the full voltage, three cells' usual."""
PILOT_MODES = frozenset({Mode.STABILIZED, Mode.ALTITUDE, Mode.POSITION, Mode.POSHOLD, Mode.DRIFT, Mode.ZIGZAG})
_INT8, _INT16, _INT32 = mavlink.MAV_PARAM_TYPE_INT8, mavlink.MAV_PARAM_TYPE_INT16, mavlink.MAV_PARAM_TYPE_INT32
_NEVER = -1.0
_FENCE_HEIGHT, _FENCE_CIRCLE, _FENCE_AREAS = 1, 2, 4
_SPARES_AUTO, _SPARES_PILOT = 2, 16
_RETURN, _LAND, _SMART = Event.FAILSAFE_RTL, Event.FAILSAFE_LAND, Event.FAILSAFE_SMART_RTL

_BATTERY_ACTIONS = {
    1: _LAND,
    2: _RETURN,
    3: _SMART,
    4: _SMART,
    5: Event.FAILSAFE_TERMINATE,
    6: _RETURN,
    7: Event.FAILSAFE_BRAKE,
}
"""By BATT_FS_LOW_ACT and BATT_FS_CRT_ACT; what is tried first always works here."""
_STATION_ACTIONS = {1: _RETURN, 2: _RETURN, 3: _SMART, 4: _SMART, 5: _LAND, 6: _RETURN, 7: Event.FAILSAFE_BRAKE}
"""By FS_GCS_ENABLE."""
_FENCE_ACTIONS = {1: _RETURN, 2: _LAND, 3: _SMART, 4: Event.FAILSAFE_BRAKE, 5: _SMART}
"""By FENCE_ACTION; 0 only reports."""


def _real(name: str, default: float, lowest: float = 0.0, highest: float = 1e9) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest)


def _whole(name: str, default: int, kind: int, lowest: float, highest: float) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest, integer_type=kind)


PARAMETERS = (
    _whole("BATT_CAPACITY", 3300, _INT32, 0, 2**31 - 1),
    _real("BATT_CRT_MAH", 0.0),
    _real("BATT_CRT_VOLT", 0.0),
    _whole("BATT_FS_CRT_ACT", 0, _INT8, 0, 7),
    _whole("BATT_FS_LOW_ACT", 0, _INT8, 0, 7),
    _real("BATT_LOW_MAH", 0.0),
    _real("BATT_LOW_VOLT", 10.5),
    _whole("BATT_MONITOR", 4, _INT8, 0, 30),
    _whole("FENCE_ACTION", 1, _INT8, 0, 5),
    _real("FENCE_ALT_MAX", 100.0, 10.0, 1000.0),
    _whole("FENCE_ENABLE", 0, _INT8, 0, 1),
    _real("FENCE_RADIUS", 300.0, 30.0, 10000.0),
    _whole("FENCE_TYPE", 7, _INT8, 0, 15),
    _whole("FS_GCS_ENABLE", 0, _INT8, 0, 7),
    _real("FS_GCS_TIMEOUT", 5.0, 2.0, 120.0),
    _whole("FS_OPTIONS", 16, _INT32, 0, 63),
    _real("SIM_BATT_VOLTAGE", 12.6),
    _whole("SYSID_MYGCS", 255, _INT16, 1, 255),
)


def failsafe_settings(values: Values) -> FailsafeSettings:
    """Return what the parameters amount to."""
    kinds = int(values["FENCE_TYPE"]) if values["FENCE_ENABLE"] > 0.0 else 0
    return FailsafeSettings(
        battery_levels=(_share(values, "BATT_LOW"), _share(values, "BATT_CRT"), _NEVER),
        battery_events=(
            _BATTERY_ACTIONS.get(int(values["BATT_FS_LOW_ACT"])),
            _BATTERY_ACTIONS.get(int(values["BATT_FS_CRT_ACT"])),
            None,
        ),
        station_lost_s=values["FS_GCS_TIMEOUT"],
        station_event=_STATION_ACTIONS.get(int(values["FS_GCS_ENABLE"])),
        station_system=int(values["SYSID_MYGCS"]),
        station_spares=_modes_to_spare(int(values["FS_OPTIONS"])),
        hold_s=None,
        fence_event=_FENCE_ACTIONS.get(int(values["FENCE_ACTION"])) if kinds else None,
        reach_m=values["FENCE_RADIUS"] if kinds & _FENCE_CIRCLE else 0.0,
        height_m=values["FENCE_ALT_MAX"] if kinds & _FENCE_HEIGHT else 0.0,
        areas_count=bool(kinds & _FENCE_AREAS),
    )


def battery_v(values: Values) -> tuple[float, float]:
    """Return the voltages of an empty and of a full battery."""
    full_v = max(0.1, values["SIM_BATT_VOLTAGE"])
    return _EMPTY_PART * full_v, full_v


def _share(values: Values, name: str) -> float:
    """The remaining share of the battery at which voltage or charge falls to a limit; 0 is none."""
    empty_v, full_v = battery_v(values)
    limit_v, limit_mah, capacity_mah = values[f"{name}_VOLT"], values[f"{name}_MAH"], values["BATT_CAPACITY"]
    if values["BATT_MONITOR"] <= 0.0:
        return _NEVER
    by_voltage = (limit_v - empty_v) / (full_v - empty_v) if limit_v > 0.0 else _NEVER
    return max(by_voltage, limit_mah / capacity_mah if limit_mah > 0.0 and capacity_mah > 0.0 else _NEVER)


def _modes_to_spare(options: int) -> frozenset[Mode]:
    auto = frozenset({Mode.MISSION}) if options & _SPARES_AUTO else frozenset()
    return auto | (PILOT_MODES if options & _SPARES_PILOT else frozenset())
