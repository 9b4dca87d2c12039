"""ArduCopter's parameters, as far as the simulated flight obeys them, and the flight settings that they amount to.

Names, types and defaults: ArduCopter 4.6 parameter reference; ANGLE_MAX, FRAME_TYPE and the like as its own simulation
sets them. Speeds are in cm/s, heights in cm and angles in hundredths of a degree where the firmware has them so.
"""

from math import cos, inf, radians, sin

from link.mavlink.dialect import mavlink
from link.messages import Vector3
from sim_autopilot.core.land_settings import DisarmSettings, LandDetectorSettings, LandSettings, PrecisionSettings
from sim_autopilot.core.limits import Envelope
from sim_autopilot.core.parameters import Parameter, Values
from sim_autopilot.core.pilot_settings import StickFeel
from sim_autopilot.core.settings import (
    FlightSettings,
    ReturnSettings,
    SetpointSettings,
    SimulationSettings,
    TakeoffSettings,
    TravelSettings,
)
from sim_autopilot.firmware.ardupilot.failsafes import PARAMETERS as FAILSAFE_PARAMETERS
from sim_autopilot.firmware.ardupilot.failsafes import battery_v, failsafe_settings
from sim_autopilot.firmware.ardupilot.path_control import in_si, path_limits, position_gains

_INT8, _INT16, _INT32 = mavlink.MAV_PARAM_TYPE_INT8, mavlink.MAV_PARAM_TYPE_INT16, mavlink.MAV_PARAM_TYPE_INT32
_UNLIMITED_M_S = 100.0
"""The feed-forward of setpoints knows no speed limit; this is more than the drone can fly."""
_BY_MAVLINK = 1
"""Of PLND_TYPE."""
_THRUST_AS_THRUST = 8
"""Of GUID_OPTIONS."""
_SLOPE_MIN = 0.5
"""A flatter cone about home counts as none."""
_WIND_MAX_M_S = 60.0
_NO_PILOT = -1.0
"""The throttle stick of the simulated receiver, right down: 1000 us."""


def _real(name: str, default: float, lowest: float = -1e9, highest: float = 1e9) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest)


def _whole(name: str, default: int, kind: int, lowest: float, highest: float) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest, integer_type=kind)


_OWN = (
    _whole("ANGLE_MAX", 3000, _INT16, 1000, 8000),
    _whole("ARMING_CHECK", 1, _INT32, 0, 2**31 - 1),
    _real("ATC_ACCEL_P_MAX", 110000.0, 0.0, 180000.0),
    _real("ATC_ACCEL_R_MAX", 110000.0, 0.0, 180000.0),
    _real("ATC_INPUT_TC", 0.15, 0.0, 1.0),
    _real("ATC_RATE_P_MAX", 0.0, 0.0, 1080.0),
    _real("ATC_RATE_R_MAX", 0.0, 0.0, 1080.0),
    _real("ATC_SLEW_YAW", 6000.0, 500.0, 18000.0),
    _whole("DISARM_DELAY", 10, _INT8, 0, 127),
    _whole("FRAME_CLASS", 1, _INT8, 0, 17),
    _whole("FRAME_TYPE", 0, _INT8, 0, 19),
    _whole("FS_THR_ENABLE", 1, _INT8, 0, 7),
    _whole("GUID_OPTIONS", 0, _INT32, 0, 2**31 - 1),
    _real("GUID_TIMEOUT", 3.0, 0.1, 5.0),
    _whole("LAND_ALT_LOW", 1000, _INT16, 100, 10000),
    _whole("LAND_SPEED", 50, _INT16, 30, 200),
    _whole("LAND_SPEED_HIGH", 0, _INT16, 0, 500),
    _real("LOIT_ACC_MAX", 500.0, 100.0, 981.0),
    _real("LOIT_SPEED", 1250.0, 20.0, 3500.0),
    _real("MOT_THST_HOVER", 0.35, 0.125, 0.6875),
    _whole("PILOT_ACCEL_Z", 250, _INT16, 50, 500),
    _whole("PILOT_SPEED_DN", 0, _INT16, 0, 500),
    _whole("PILOT_SPEED_UP", 250, _INT16, 50, 500),
    _real("PILOT_Y_RATE", 202.5, 1.0, 360.0),
    _whole("PLND_ENABLED", 0, _INT8, 0, 1),
    _whole("PLND_OPTIONS", 0, _INT16, 0, 7),
    _whole("PLND_TYPE", 0, _INT8, 0, 4),
    _real("PLND_XY_DIST_MAX", 2.5, 0.0, 10.0),
    _real("PSC_JERK_XY", 5.0, 1.0, 20.0),
    _real("PSC_JERK_Z", 5.0, 5.0, 50.0),
    _real("PSC_POSXY_P", 1.0, 0.5, 2.0),
    _real("PSC_POSZ_P", 1.0, 1.0, 3.0),
    _real("PSC_VELXY_D", 0.5, 0.0, 1.0),
    _real("PSC_VELXY_FLTD", 5.0, 0.0, 100.0),
    _real("PSC_VELXY_FLTE", 5.0, 0.0, 100.0),
    _real("PSC_VELXY_I", 1.0, 0.02, 1.0),
    _real("PSC_VELXY_P", 2.0, 0.1, 6.0),
    _real("PSC_VELZ_P", 5.0, 1.0, 10.0),
    _real("RC_OVERRIDE_TIME", 3.0, 0.0, 120.0),
    _whole("RTL_ALT", 1500, _INT32, 30, 300000),
    _whole("RTL_CLIMB_MIN", 0, _INT16, 0, 3000),
    _real("RTL_CONE_SLOPE", 3.0, 0.0, 10.0),
    _whole("RTL_LOIT_TIME", 5000, _INT32, 0, 60000),
    _whole("RTL_SPEED", 0, _INT16, 0, 2000),
    _real("SIM_WIND_DIR", 180.0, -360.0, 360.0),
    _real("SIM_WIND_DIR_Z", 0.0, -90.0, 90.0),
    _real("SIM_WIND_SPD", 0.0, 0.0, 60.0),
    _whole("THR_DZ", 100, _INT16, 0, 300),
    _whole("SYSID_THISMAV", 1, _INT16, 1, 255),
    _real("TKOFF_SLEW_TIME", 2.0, 0.25, 5.0),
    _real("WPNAV_ACCEL", 250.0, 50.0, 500.0),
    _real("WPNAV_ACCEL_Z", 100.0, 50.0, 500.0),
    _real("WPNAV_SPEED", 1000.0, 10.0, 100.0 * _UNLIMITED_M_S),  # documented to 2000, which the firmware does not check
    _real("WPNAV_SPEED_DN", 150.0, 10.0, 500.0),
    _real("WPNAV_SPEED_UP", 250.0, 10.0, 1000.0),
    _whole("WP_YAW_BEHAVIOR", 2, _INT8, 0, 3),
)

OBEYED = tuple(sorted((*_OWN, *FAILSAFE_PARAMETERS), key=lambda parameter: parameter.name))


def flight_settings(values: Values) -> FlightSettings:
    """Return what the parameters amount to, in SI units."""
    descent_m_s, acceleration_m_s2 = in_si(values, "WPNAV_SPEED_DN"), in_si(values, "WPNAV_ACCEL")
    delay_s = values["DISARM_DELAY"]
    return FlightSettings(
        envelope=Envelope(
            speed_max_m_s=_UNLIMITED_M_S,
            climb_max_m_s=_UNLIMITED_M_S,
            descent_max_m_s=_UNLIMITED_M_S,
            braking_m_s2=acceleration_m_s2,
            tilt_max_rad=_tilt_rad(values),
            yaw_rate_max_rad_s=radians(max(1.0, values["ATC_SLEW_YAW"] / 100.0)),
        ),
        setpoints=SetpointSettings(
            loss_s=inf,
            loss_event=None,
            hover_share=min(0.8, max(0.1, values["MOT_THST_HOVER"])),
            thrust_as_thrust=bool(int(values["GUID_OPTIONS"]) & _THRUST_AS_THRUST),
        ),
        takeoff=TakeoffSettings(spool_up_s=0.0, ramp_s=1.0, climb_m_s=in_si(values, "WPNAV_SPEED_UP"), height_m=2.5),
        travel=TravelSettings(cruise_m_s=in_si(values, "WPNAV_SPEED"), reached_m=2.0),  # WPNAV_RADIUS
        returning=_return(values),
        land=LandSettings(
            approach_m_s=in_si(values, "LAND_SPEED_HIGH") if values["LAND_SPEED_HIGH"] > 0.0 else descent_m_s,
            descent_m_s=in_si(values, "LAND_SPEED"),
            slow_below_m=values["LAND_ALT_LOW"] / 100.0,
            precision=PrecisionSettings(
                enabled=values["PLND_ENABLED"] > 0.0 and int(values["PLND_TYPE"]) == _BY_MAVLINK,
                moving=bool(int(values["PLND_OPTIONS"]) & 1),
                sinks_within_m=values["PLND_XY_DIST_MAX"],
            ),
        ),
        land_detector=LandDetectorSettings(
            after_s=_LANDED_AFTER_S,
            speed_max_m_s=inf,
            sink_max_m_s=1.0,
            sink_asked_m_s=0.0,
            tilt_max_rad=radians(15.0),
            acceleration_max_m_s2=1.0,
        ),
        disarm=DisarmSettings(
            landed_s=delay_s if delay_s > 0.0 else None,
            after_landing_mode_s=0.1,
            idle_s=delay_s if delay_s > 0.0 else None,
        ),
        path=path_limits(values),
        gains=position_gains(values),
        sticks=_sticks(values),
        failsafes=failsafe_settings(values),
        simulation=SimulationSettings(battery_v=battery_v(values), wind_enu_m_s=_wind(values)),
    )


def _return(values: Values) -> ReturnSettings:
    return ReturnSettings(
        height_m=values["RTL_ALT"] / 100.0,
        distance_m=0.0,
        slope=values["RTL_CONE_SLOPE"] if values["RTL_CONE_SLOPE"] >= _SLOPE_MIN else 0.0,
        speed_m_s=in_si(values, "RTL_SPEED") if values["RTL_SPEED"] > 0.0 else None,
        climb_m=values["RTL_CLIMB_MIN"] / 100.0,
        stay_s=values["RTL_LOIT_TIME"] / 1000.0,
    )


def _sticks(values: Values) -> StickFeel:
    climb_m_s = in_si(values, "PILOT_SPEED_UP")
    return StickFeel(
        speed_m_s=in_si(values, "LOIT_SPEED"),
        climb_m_s=climb_m_s,
        descent_m_s=in_si(values, "PILOT_SPEED_DN") if values["PILOT_SPEED_DN"] > 0.0 else climb_m_s,
        acceleration_m_s2=in_si(values, "LOIT_ACC_MAX"),
        lift_m_s2=in_si(values, "PILOT_ACCEL_Z"),
        tilt_rad=_tilt_rad(values),
        yaw_rate_rad_s=radians(values["PILOT_Y_RATE"]),
        dead_zone=0.04,  # RC1_DZ, 20 us
        throttle_dead_zone=min(0.8, max(0.0, values["THR_DZ"] / 500.0)),
        lost_s=values["RC_OVERRIDE_TIME"],
        idle_throttle=_NO_PILOT,
    )


def _wind(values: Values) -> Vector3:
    """The simulated wind, towards, from the direction it comes from and the angle below the horizon."""
    speed_m_s = min(_WIND_MAX_M_S, max(0.0, values["SIM_WIND_SPD"]))
    from_rad, dive_rad = radians(values["SIM_WIND_DIR"]), radians(values["SIM_WIND_DIR_Z"])
    level_m_s = -speed_m_s * cos(dive_rad)
    return (level_m_s * sin(from_rad), level_m_s * cos(from_rad), speed_m_s * sin(dive_rad))


def _tilt_rad(values: Values) -> float:
    return radians(min(80.0, max(10.0, values["ANGLE_MAX"] / 100.0)))


_LANDED_AFTER_S = 1.4
"""From contact to ON_GROUND, as measured: a second of signs, after the filtered acceleration has died away."""
