"""PX4's failsafes of battery, ground station and fence, as its parameters have them.

Source: PX4 parameter reference, with the defaults of its own simulation.
"""

from sim_autopilot.core.modes import Event
from sim_autopilot.core.parameters import Values, make_parameter
from sim_autopilot.core.settings import FailsafeSettings

ACTIONS = {
    1: Event.FAILSAFE_HOLD,
    2: Event.FAILSAFE_RTL,
    3: Event.FAILSAFE_LAND,
    5: Event.FAILSAFE_TERMINATE,
    6: Event.FAILSAFE_TERMINATE,  # disarms, which is the same here
}
"""By NAV_RCL_ACT and NAV_DLL_ACT."""
_BATTERY_ACTIONS: dict[int, tuple[Event | None, Event | None, Event | None]] = {
    2: (None, Event.FAILSAFE_LAND, Event.FAILSAFE_LAND),
    3: (None, Event.FAILSAFE_RTL, Event.FAILSAFE_LAND),
}
"""By COM_LOW_BAT_ACT; the other values only warn."""
_FENCE_ACTIONS = {
    2: Event.FAILSAFE_HOLD,
    3: Event.FAILSAFE_RTL,
    4: Event.FAILSAFE_TERMINATE,
    5: Event.FAILSAFE_LAND,
}
"""By GF_ACTION; 0 and 1 do nothing."""

PARAMETERS = (
    make_parameter("BAT_CRIT_THR", 0.07, 0.05, 0.5),
    make_parameter("BAT_EMERGEN_THR", 0.05, 0.03, 0.5),
    make_parameter("BAT_LOW_THR", 0.15, 0.12, 0.5),
    make_parameter("COM_DL_LOSS_T", 10, 5, 300),
    make_parameter("COM_FAIL_ACT_T", 5.0, 0.0, 25.0),
    make_parameter("COM_LOW_BAT_ACT", 3, 0, 3),
    make_parameter("GF_ACTION", 2, 0, 5),
    make_parameter("GF_MAX_HOR_DIST", 0.0, 0.0, 10000.0),
    make_parameter("GF_MAX_VER_DIST", 0.0, 0.0, 10000.0),
    make_parameter("NAV_DLL_ACT", 0, 0, 6),
)


def failsafe_settings(values: Values) -> FailsafeSettings:
    """Return what the failsafes of battery, ground station and fence do."""
    return FailsafeSettings(
        battery_levels=(values["BAT_LOW_THR"], values["BAT_CRIT_THR"], values["BAT_EMERGEN_THR"]),
        battery_events=_BATTERY_ACTIONS.get(int(values["COM_LOW_BAT_ACT"]), (None, None, None)),
        station_lost_s=values["COM_DL_LOSS_T"],
        station_event=ACTIONS.get(int(values["NAV_DLL_ACT"])),
        hold_s=values["COM_FAIL_ACT_T"],
        fence_event=_FENCE_ACTIONS.get(int(values["GF_ACTION"])),
        reach_m=values["GF_MAX_HOR_DIST"],
        height_m=values["GF_MAX_VER_DIST"],
    )
