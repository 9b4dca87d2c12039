"""The parameters that PX4's flight obeys, and the settings that their values amount to.

Source: PX4 parameter reference, with the defaults of its own simulation.
"""

from math import radians

from sim_autopilot.core.limits import AxisGains, Envelope, PositionGains
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.core.parameters import Parameter, Values, within_ranges
from sim_autopilot.core.pilot_settings import FollowSettings, StickFeel, TakeoverSettings
from sim_autopilot.core.settings import (
    DisarmSettings,
    FailsafeSettings,
    FlightSettings,
    LandDetectorSettings,
    LandSettings,
    ReturnSettings,
    SetpointSettings,
    SimulationSettings,
    TakeoffSettings,
    TargetSettings,
    TravelSettings,
)

_LOSS_EVENTS = {
    0: Event.LOST_TO_POSITION,
    1: Event.LOST_TO_POSITION,  # altitude mode needs a stick that nobody holds
    2: Event.LOST_TO_POSITION,  # so does stabilised
    3: Event.LOST_TO_RTL,
    4: Event.LOST_TO_LAND,
    5: Event.LOST_TO_HOLD,
}
"""By COM_OBL_RC_ACT; the other values stop the motors."""


_ACTIONS = {
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
_AUTO_MODES = frozenset({Mode.HOLD, Mode.LAND, Mode.PRECISION_LAND, Mode.TAKEOFF, Mode.RTL, Mode.MISSION})
_WITH_TARGET = 2
"""FLW_TGT_ALT_M: the height above the target; the others are above home, since the ground is flat."""
_OVERRIDDEN = ((1, _AUTO_MODES), (2, frozenset({Mode.OFFBOARD})))
"""By the bits of COM_RC_OVERRIDE."""


def _modes_to_override(bits: int) -> frozenset[Mode]:
    return frozenset(mode for bit, modes in _OVERRIDDEN if bits & bit for mode in modes)


def _failsafes(values: Values) -> FailsafeSettings:
    return FailsafeSettings(
        battery_levels=(values["BAT_LOW_THR"], values["BAT_CRIT_THR"], values["BAT_EMERGEN_THR"]),
        battery_events=_BATTERY_ACTIONS.get(int(values["COM_LOW_BAT_ACT"]), (None, None, None)),
        station_lost_s=values["COM_DL_LOSS_T"],
        station_event=_ACTIONS.get(int(values["NAV_DLL_ACT"])),
        hold_s=values["COM_FAIL_ACT_T"],
        fence_event=_FENCE_ACTIONS.get(int(values["GF_ACTION"])),
        reach_m=values["GF_MAX_HOR_DIST"],
        height_m=values["GF_MAX_VER_DIST"],
    )


def _gains(values: Values) -> PositionGains:
    """Of PositionControl. The derivative is of the velocity; MC_PITCH_P counts for as much as MC_ROLL_P."""
    cutoff_hz = values["MPC_VELD_LP"]
    return PositionGains(
        level=AxisGains(
            position_per_s=values["MPC_XY_P"],
            velocity_per_s=values["MPC_XY_VEL_P_ACC"],
            integral_per_s2=values["MPC_XY_VEL_I_ACC"],
            derivative=values["MPC_XY_VEL_D_ACC"],
        ),
        vertical=AxisGains(
            position_per_s=values["MPC_Z_P"],
            velocity_per_s=values["MPC_Z_VEL_P_ACC"],
            integral_per_s2=values["MPC_Z_VEL_I_ACC"],
            derivative=values["MPC_Z_VEL_D_ACC"],
        ),
        observer_rad_s=0.0,  # integrals on all axes
        derives_error=False,
        error_cutoff_hz=None,  # MPC_VEL_LP is off by default
        slope_cutoff_hz=cutoff_hz if cutoff_hz > 0.0 else None,
        attitude_per_s=values["MC_ROLL_P"],
    )


def _follow(values: Values) -> FollowSettings:
    return FollowSettings(
        distance_m=values["FLW_TGT_DST"],
        height_m=values["FLW_TGT_HT"],
        angle_rad=radians(values["FLW_TGT_FA"]),
        along_m_s=values["FLW_TGT_MAX_VEL"],
        smoothing=min(1.0, max(0.1, values["FLW_TGT_RS"])),
        with_him=int(values["FLW_TGT_ALT_M"]) == _WITH_TARGET,
    )


def flight_settings(values: Values) -> FlightSettings:
    """Return what the parameters amount to; the flight keeps to their ranges, whatever was set."""
    values = within_ranges(OBEYED, values)
    return FlightSettings(
        envelope=Envelope(
            speed_max_m_s=values["MPC_XY_VEL_MAX"],
            climb_max_m_s=values["MPC_Z_VEL_MAX_UP"],
            descent_max_m_s=values["MPC_Z_VEL_MAX_DN"],
            braking_m_s2=values["MPC_ACC_HOR"],
            tilt_max_rad=radians(values["MPC_TILTMAX_AIR"]),
            yaw_rate_max_rad_s=radians(values["MPC_YAWRAUTO_MAX"]),
        ),
        setpoints=SetpointSettings(
            loss_s=values["COM_OF_LOSS_T"],
            loss_event=_LOSS_EVENTS.get(int(values["COM_OBL_RC_ACT"])),
            hover_share=values["MPC_THR_HOVER"],
        ),
        takeoff=TakeoffSettings(
            spool_up_s=values["COM_SPOOLUP_TIME"],
            ramp_s=values["MPC_TKO_RAMP_T"],
            climb_m_s=values["MPC_TKO_SPEED"],
            height_m=values["MIS_TAKEOFF_ALT"],
        ),
        travel=TravelSettings(
            cruise_m_s=values["MPC_XY_CRUISE"],
            reached_m=values["NAV_ACC_RAD"],
            reached_height_m=values["NAV_MC_ALT_RAD"],
        ),
        returning=ReturnSettings(height_m=values["RTL_RETURN_ALT"], distance_m=values["RTL_MIN_DIST"]),
        land=LandSettings(
            approach_m_s=values["MPC_Z_VEL_MAX_DN"],
            descent_m_s=values["MPC_LAND_SPEED"],
            slow_below_m=5.0,  # MPC_LAND_ALT2
            target=_target(values),
        ),
        land_detector=LandDetectorSettings(
            after_s=1.5,  # measured from contact to ON_GROUND
            speed_max_m_s=values["LNDMC_XY_VEL_MAX"],
            sink_max_m_s=values["LNDMC_Z_VEL_MAX"],
            sink_asked_m_s=1.1 * values["LNDMC_Z_VEL_MAX"],
        ),
        disarm=DisarmSettings(
            landed_s=_time_or_never(values["COM_DISARM_LAND"]),
            after_landing_mode_s=_time_or_never(values["COM_DISARM_LAND"]),
            idle_s=_time_or_never(values["COM_DISARM_PRFLT"]),
        ),
        sticks=StickFeel(
            speed_m_s=values["MPC_VEL_MANUAL"],
            tilt_rad=radians(values["MPC_MAN_TILT_MAX"]),
            yaw_rate_rad_s=radians(values["MPC_MAN_Y_MAX"]),
            dead_zone=values["MPC_HOLD_DZ"],
            lost_s=values["COM_RC_LOSS_T"],
        ),
        takeover=TakeoverSettings(
            lost_event=_ACTIONS.get(int(values["NAV_RCL_ACT"])),
            overridden_modes=_modes_to_override(int(values["COM_RC_OVERRIDE"])),
            moved_per_s=values["COM_RC_STICK_OV"] / 100.0,
        ),
        gains=_gains(values),
        follow=_follow(values),
        failsafes=_failsafes(values),
        simulation=SimulationSettings(takes_failures=values["SYS_FAILURE_EN"] > 0.0),
    )


def _target(values: Values) -> TargetSettings:
    return TargetSettings(
        lost_s=values["PLD_BTOUT"],
        within_m=values["PLD_HACC_RAD"],
        final_m=values["PLD_FAPPR_ALT"],
        search_m=values["PLD_SRCH_ALT"],
        search_s=values["PLD_SRCH_TOUT"],
        searches_max=int(values["PLD_MAX_SRCH"]),
    )


def _time_or_never(value_s: float) -> float | None:
    return value_s if value_s > 0.0 else None


def _parameter(name: str, default: float, lowest: float, highest: float) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest)


# NAV_ACC_RAD and RTL_RETURN_ALT as PX4 sets them for every multirotor, COM_LOW_BAT_ACT and SYS_FAILURE_EN for its
# own simulation.
OBEYED = (
    _parameter("BAT_CRIT_THR", 0.07, 0.05, 0.5),
    _parameter("BAT_EMERGEN_THR", 0.05, 0.03, 0.5),
    _parameter("BAT_LOW_THR", 0.15, 0.12, 0.5),
    _parameter("COM_DISARM_LAND", 2.0, -1.0, 1e4),
    _parameter("COM_DISARM_PRFLT", 10.0, -1.0, 1e4),
    _parameter("COM_DL_LOSS_T", 10, 5, 300),
    _parameter("COM_FAIL_ACT_T", 5.0, 0.0, 25.0),
    _parameter("COM_LOW_BAT_ACT", 3, 0, 3),
    _parameter("COM_OBL_RC_ACT", 0, 0, 7),
    _parameter("COM_OF_LOSS_T", 1.0, 0.0, 60.0),
    _parameter("COM_RC_LOSS_T", 0.5, 0.0, 35.0),
    _parameter("COM_RC_OVERRIDE", 1, 0, 3),
    _parameter("COM_RC_STICK_OV", 30.0, 5.0, 80.0),
    _parameter("COM_SPOOLUP_TIME", 1.0, 0.0, 30.0),
    _parameter("FLW_TGT_ALT_M", 0, 0, 2),
    _parameter("FLW_TGT_DST", 8.0, 1.0, 1000.0),
    _parameter("FLW_TGT_FA", 180.0, -180.0, 180.0),
    _parameter("FLW_TGT_HT", 8.0, 8.0, 1000.0),
    _parameter("FLW_TGT_MAX_VEL", 5.0, 0.0, 20.0),
    _parameter("FLW_TGT_RS", 0.1, 0.0, 1.0),
    _parameter("GF_ACTION", 2, 0, 5),
    _parameter("GF_MAX_HOR_DIST", 0.0, 0.0, 10000.0),
    _parameter("GF_MAX_VER_DIST", 0.0, 0.0, 10000.0),
    _parameter("LNDMC_XY_VEL_MAX", 1.5, 0.0, 30.0),
    _parameter("LNDMC_Z_VEL_MAX", 0.25, 0.0, 5.0),
    _parameter("MC_ROLL_P", 4.0, 0.5, 12.0),
    _parameter("MIS_TAKEOFF_ALT", 2.5, 0.0, 1000.0),
    _parameter("MPC_ACC_HOR", 3.0, 2.0, 15.0),
    _parameter("MPC_HOLD_DZ", 0.1, 0.0, 1.0),
    _parameter("MPC_LAND_SPEED", 0.7, 0.6, 10.0),
    _parameter("MPC_MAN_TILT_MAX", 35.0, 1.0, 70.0),
    _parameter("MPC_MAN_Y_MAX", 150.0, 0.0, 400.0),
    _parameter("MPC_TILTMAX_AIR", 45.0, 20.0, 89.0),
    _parameter("MPC_THR_HOVER", 0.5, 0.1, 0.8),
    _parameter("MPC_TKO_RAMP_T", 3.0, 0.0, 30.0),
    _parameter("MPC_TKO_SPEED", 1.5, 1.0, 5.0),
    _parameter("MPC_VELD_LP", 5.0, 0.0, 50.0),
    _parameter("MPC_VEL_MANUAL", 10.0, 3.0, 20.0),
    _parameter("MPC_XY_CRUISE", 5.0, 3.0, 20.0),
    _parameter("MPC_XY_P", 0.95, 0.1, 2.0),
    _parameter("MPC_XY_VEL_D_ACC", 0.2, 0.0, 2.0),
    _parameter("MPC_XY_VEL_I_ACC", 0.4, 0.0, 60.0),
    _parameter("MPC_XY_VEL_MAX", 12.0, 0.1, 40.0),
    _parameter("MPC_XY_VEL_P_ACC", 1.8, 0.5, 5.0),
    _parameter("MPC_YAWRAUTO_MAX", 60.0, 5.0, 360.0),
    _parameter("MPC_Z_P", 1.0, 0.1, 1.5),
    _parameter("MPC_Z_VEL_D_ACC", 0.0, 0.0, 2.0),
    _parameter("MPC_Z_VEL_I_ACC", 2.0, 0.0, 3.0),
    _parameter("MPC_Z_VEL_MAX_DN", 1.5, 0.5, 10.0),
    _parameter("MPC_Z_VEL_MAX_UP", 3.0, 0.5, 15.0),
    _parameter("MPC_Z_VEL_P_ACC", 4.0, 2.0, 15.0),
    _parameter("NAV_ACC_RAD", 2.0, 0.05, 200.0),
    _parameter("NAV_DLL_ACT", 0, 0, 6),
    _parameter("NAV_MC_ALT_RAD", 0.8, 0.05, 200.0),
    _parameter("NAV_RCL_ACT", 2, 1, 6),
    _parameter("PLD_BTOUT", 5.0, 0.0, 50.0),
    _parameter("PLD_FAPPR_ALT", 0.1, 0.0, 10.0),
    _parameter("PLD_HACC_RAD", 0.2, 0.0, 10.0),
    _parameter("PLD_MAX_SRCH", 3, 0, 100),
    _parameter("PLD_SRCH_ALT", 10.0, 0.0, 100.0),
    _parameter("PLD_SRCH_TOUT", 10.0, 0.0, 100.0),
    _parameter("RTL_MIN_DIST", 10.0, 0.5, 100.0),
    _parameter("RTL_RETURN_ALT", 30.0, 0.0, 1000.0),
    _parameter("SYS_FAILURE_EN", 1, 0, 1),
)
