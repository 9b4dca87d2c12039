"""The parameters that PX4's flight obeys, and the settings that their values amount to.

Source: PX4 parameter reference, with the defaults of its own simulation.
"""

from math import radians

from sim_autopilot.core.land_settings import DisarmSettings, LandDetectorSettings, LandSettings, TargetSettings
from sim_autopilot.core.limits import AxisGains, Envelope, PositionGains
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.core.parameters import Values, make_parameter, within_ranges
from sim_autopilot.core.pilot_settings import FollowSettings, StickFeel, TakeoverSettings
from sim_autopilot.core.settings import (
    FlightSettings,
    ReturnSettings,
    SetpointSettings,
    SimulationSettings,
    TakeoffSettings,
    TravelSettings,
)
from sim_autopilot.firmware.px4.failsafes import ACTIONS, PARAMETERS, failsafe_settings

_LOSS_EVENTS = {
    0: Event.LOST_TO_POSITION,
    1: Event.LOST_TO_POSITION,  # altitude mode needs a stick that nobody holds
    2: Event.LOST_TO_POSITION,  # so does stabilised
    3: Event.LOST_TO_RTL,
    4: Event.LOST_TO_LAND,
    5: Event.LOST_TO_HOLD,
}
"""By COM_OBL_RC_ACT; the other values stop the motors."""


_AUTO_MODES = frozenset({Mode.HOLD, Mode.LAND, Mode.PRECISION_LAND, Mode.TAKEOFF, Mode.RTL, Mode.MISSION})
_WITH_TARGET = 2
"""FLW_TGT_ALT_M: the height above the target; the others are above home, since the ground is flat."""
_OVERRIDDEN = ((1, _AUTO_MODES), (2, frozenset({Mode.OFFBOARD})))
"""By the bits of COM_RC_OVERRIDE."""


def _modes_to_override(bits: int) -> frozenset[Mode]:
    return frozenset(mode for bit, modes in _OVERRIDDEN if bits & bit for mode in modes)


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
            lost_event=ACTIONS.get(int(values["NAV_RCL_ACT"])),
            overridden_modes=_modes_to_override(int(values["COM_RC_OVERRIDE"])),
            moved_per_s=values["COM_RC_STICK_OV"] / 100.0,
        ),
        gains=_gains(values),
        follow=_follow(values),
        failsafes=failsafe_settings(values),
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


# NAV_ACC_RAD and RTL_RETURN_ALT as PX4 sets them for every multirotor, COM_LOW_BAT_ACT and SYS_FAILURE_EN for its
# own simulation.
_OWN = (
    make_parameter("COM_DISARM_LAND", 2.0, -1.0, 1e4),
    make_parameter("COM_DISARM_PRFLT", 10.0, -1.0, 1e4),
    make_parameter("COM_OBL_RC_ACT", 0, 0, 7),
    make_parameter("COM_OF_LOSS_T", 1.0, 0.0, 60.0),
    make_parameter("COM_RC_LOSS_T", 0.5, 0.0, 35.0),
    make_parameter("COM_RC_OVERRIDE", 1, 0, 3),
    make_parameter("COM_RC_STICK_OV", 30.0, 5.0, 80.0),
    make_parameter("COM_SPOOLUP_TIME", 1.0, 0.0, 30.0),
    make_parameter("FLW_TGT_ALT_M", 0, 0, 2),
    make_parameter("FLW_TGT_DST", 8.0, 1.0, 1000.0),
    make_parameter("FLW_TGT_FA", 180.0, -180.0, 180.0),
    make_parameter("FLW_TGT_HT", 8.0, 8.0, 1000.0),
    make_parameter("FLW_TGT_MAX_VEL", 5.0, 0.0, 20.0),
    make_parameter("FLW_TGT_RS", 0.1, 0.0, 1.0),
    make_parameter("LNDMC_XY_VEL_MAX", 1.5, 0.0, 30.0),
    make_parameter("LNDMC_Z_VEL_MAX", 0.25, 0.0, 5.0),
    make_parameter("MC_ROLL_P", 4.0, 0.5, 12.0),
    make_parameter("MIS_TAKEOFF_ALT", 2.5, 0.0, 1000.0),
    make_parameter("MPC_ACC_HOR", 3.0, 2.0, 15.0),
    make_parameter("MPC_HOLD_DZ", 0.1, 0.0, 1.0),
    make_parameter("MPC_LAND_SPEED", 0.7, 0.6, 10.0),
    make_parameter("MPC_MAN_TILT_MAX", 35.0, 1.0, 70.0),
    make_parameter("MPC_MAN_Y_MAX", 150.0, 0.0, 400.0),
    make_parameter("MPC_TILTMAX_AIR", 45.0, 20.0, 89.0),
    make_parameter("MPC_THR_HOVER", 0.5, 0.1, 0.8),
    make_parameter("MPC_TKO_RAMP_T", 3.0, 0.0, 30.0),
    make_parameter("MPC_TKO_SPEED", 1.5, 1.0, 5.0),
    make_parameter("MPC_VELD_LP", 5.0, 0.0, 50.0),
    make_parameter("MPC_VEL_MANUAL", 10.0, 3.0, 20.0),
    make_parameter("MPC_XY_CRUISE", 5.0, 3.0, 20.0),
    make_parameter("MPC_XY_P", 0.95, 0.1, 2.0),
    make_parameter("MPC_XY_VEL_D_ACC", 0.2, 0.0, 2.0),
    make_parameter("MPC_XY_VEL_I_ACC", 0.4, 0.0, 60.0),
    make_parameter("MPC_XY_VEL_MAX", 12.0, 0.1, 40.0),
    make_parameter("MPC_XY_VEL_P_ACC", 1.8, 0.5, 5.0),
    make_parameter("MPC_YAWRAUTO_MAX", 60.0, 5.0, 360.0),
    make_parameter("MPC_Z_P", 1.0, 0.1, 1.5),
    make_parameter("MPC_Z_VEL_D_ACC", 0.0, 0.0, 2.0),
    make_parameter("MPC_Z_VEL_I_ACC", 2.0, 0.0, 3.0),
    make_parameter("MPC_Z_VEL_MAX_DN", 1.5, 0.5, 10.0),
    make_parameter("MPC_Z_VEL_MAX_UP", 3.0, 0.5, 15.0),
    make_parameter("MPC_Z_VEL_P_ACC", 4.0, 2.0, 15.0),
    make_parameter("NAV_ACC_RAD", 2.0, 0.05, 200.0),
    make_parameter("NAV_MC_ALT_RAD", 0.8, 0.05, 200.0),
    make_parameter("NAV_RCL_ACT", 2, 1, 6),
    make_parameter("PLD_BTOUT", 5.0, 0.0, 50.0),
    make_parameter("PLD_FAPPR_ALT", 0.1, 0.0, 10.0),
    make_parameter("PLD_HACC_RAD", 0.2, 0.0, 10.0),
    make_parameter("PLD_MAX_SRCH", 3, 0, 100),
    make_parameter("PLD_SRCH_ALT", 10.0, 0.0, 100.0),
    make_parameter("PLD_SRCH_TOUT", 10.0, 0.0, 100.0),
    make_parameter("RTL_MIN_DIST", 10.0, 0.5, 100.0),
    make_parameter("RTL_RETURN_ALT", 30.0, 0.0, 1000.0),
    make_parameter("SYS_FAILURE_EN", 1, 0, 1),
)
OBEYED = tuple(sorted((*_OWN, *PARAMETERS), key=lambda parameter: parameter.name))
