"""ArduCopter: GUIDED follows setpoints, but only a take-off command leaves the ground.

A setpoint sent before the take-off is complete silently cancels it, so none may be sent until then.

Source: ArduPilot's copter documentation, guided mode; behaviour measured against its software-in-the-loop build.
"""

import math
from collections.abc import Mapping
from itertools import chain
from types import MappingProxyType

from companion.autopilots.driver import AutopilotView, Desire, DriverMemory
from companion.autopilots.limits import (
    INTEGRAL_FACTOR_MAX,
    TILT_LEAST_DEG,
    Limit,
    Named,
    acceleration_of_tilt_m_s2,
    attitude_lag_s,
    find_gain,
    names_of,
)
from companion.autopilots.messages import (
    ASK_AGAIN_S,
    Requested,
    ask,
    ask_for_control,
    ask_to_arm,
    ask_to_disarm,
    is_carried_on,
    local_ned_setpoint,
    set_mode,
    take_off,
    with_answer,
    without_past_orders,
)
from companion.autopilots.response import Cascade, Shaping
from companion.core.data import GRAVITY_M_S2, FlightLimits, Setpoint
from link.frames.geodesy import Projection
from link.mavlink.answers import ANSWER_GAP_S
from link.mavlink.dialect import Message, mavlink
from link.records import replace

_GUIDED = 4
_BRAKE = 17  # stops and holds without sticks; LOITER would take a transmitter that is switched off for "descend"
_TAKE_OFF_AGAIN_S = 5.0  # once it was accepted: it lifts off 3.5 to 4 s later
_CENTI = 0.01
_TILT_MAX_DEG = 45.0  # nothing is planned beyond
# The ends of their stated ranges, so that no parameter, nor one that somebody else tells, makes a path without an end.
# PSC_JERK_Z is stated from 5 on, and is landed with at less.
_JERK_LEAST_M_S3, _ACCELERATION_LEAST_M_S2 = 1.0, 0.5
# With the defaults of release 4.6. Each has its name up to that release, in centimetres or centidegrees, and its name
# from 4.7 on; the jerks' changed in it twice.
_TILT = Limit(30.0, (Named("ANGLE_MAX", _CENTI, TILT_LEAST_DEG), Named("ATC_ANGLE_MAX", least=TILT_LEAST_DEG)))
# The smaller one of the two counts; this one's default, 0, is none.
_TILT_BY_POSITION = Limit(math.inf, (Named("PSC_ANGLE_MAX", least=TILT_LEAST_DEG),))
_SPEED = Limit(10.0, (Named("WPNAV_SPEED", _CENTI), Named("WP_SPD")))
_CLIMB = Limit(2.5, (Named("WPNAV_SPEED_UP", _CENTI), Named("WP_SPD_UP")))
_DESCENT = Limit(1.5, (Named("WPNAV_SPEED_DN", _CENTI), Named("WP_SPD_DN")))
# It follows no acceleration that changes faster.
_JERK = Limit(5.0, tuple(Named(name, least=_JERK_LEAST_M_S3) for name in ("PSC_JERK_XY", "PSC_JERK_NE", "PSC_NE_JERK")))
# It bounds that jerk by what its attitude controller may do, too (AC_PosControl::set_max_speed_accel_xy). Degrees/s^2
# and degrees/s; autotune sets the former, to 200 degrees/s^2 for propellers of 30 inches. The latter's default is none.
_ATTITUDE_ACCELERATIONS = tuple(
    Limit(1100.0, (Named(f"ATC_ACCEL_{axis}_MAX", _CENTI), Named(f"ATC_ACC_{axis}_MAX"))) for axis in "RP"
)
_ATTITUDE_RATES = tuple(Limit(math.inf, (Named(f"ATC_RATE_{axis}_MAX"),)) for axis in "RP")
_ACCELERATION = Limit(
    2.5, (Named("WPNAV_ACCEL", _CENTI, _ACCELERATION_LEAST_M_S2), Named("WP_ACC", least=_ACCELERATION_LEAST_M_S2))
)
_VERTICAL_ACCELERATION = Limit(
    1.0, (Named("WPNAV_ACCEL_Z", _CENTI, _ACCELERATION_LEAST_M_S2), Named("WP_ACC_Z", least=_ACCELERATION_LEAST_M_S2))
)
_VERTICAL_JERK = Limit(
    5.0, tuple(Named(name, least=_JERK_LEAST_M_S3) for name in ("PSC_JERK_Z", "PSC_JERK_D", "PSC_D_JERK"))
)
_LIMITS = (
    _TILT,
    _TILT_BY_POSITION,
    _SPEED,
    _CLIMB,
    _DESCENT,
    _JERK,
    _ACCELERATION,
    _VERTICAL_ACCELERATION,
    _VERTICAL_JERK,
    *_ATTITUDE_ACCELERATIONS,
    *_ATTITUDE_RATES,
)
_CARRIED_MIN_S = 0.1  # ModeGuided::get_timeout_ms
_POSITION_GAIN = ("PSC_POSXY_P", "PSC_NE_POS_P")
_VELOCITY_GAIN = ("PSC_VELXY_P", "PSC_NE_VEL_P")
_INTEGRAL_GAIN = ("PSC_VELXY_I", "PSC_NE_VEL_I")
_DERIVATIVE_GAIN = ("PSC_VELXY_D", "PSC_NE_VEL_D")
_ATTITUDE_TIME = ("ATC_INPUT_TC",)


class ArduPilotDriver:
    """Drives ArduCopter."""

    name = "ardupilot"
    autopilot_id: int = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    projection = Projection.ARDUPILOT
    limit_names = names_of(_LIMITS)
    gain_names = (_POSITION_GAIN, _VELOCITY_GAIN, _INTEGRAL_GAIN, _DERIVATIVE_GAIN, _ATTITUDE_TIME)
    hover_mode = "BRAKE"
    timeout_parameter = "GUID_TIMEOUT"
    timeout_default_s = 3.0
    waits_in_mode = True
    follows_in_failsafe = True  # a low battery, or a radio lost, with "continue" as its action
    takes_target_in_body_axes = True
    speed_parameters = tuple(chain(*names_of((_TILT, _TILT_BY_POSITION, _SPEED))))
    mode_streams_hz: Mapping[int, float] = MappingProxyType({mavlink.MAVLINK_MSG_ID_HEARTBEAT: 10.0})
    unused_streams: tuple[int, ...] = ()  # it sends nothing unasked

    def is_in_control(self, base_mode: int, custom_mode: int) -> bool:
        """Return whether the mode is GUIDED."""
        return bool(base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) and custom_mode == _GUIDED

    def refusal(self, message: Message) -> str | None:
        """Return what stands against arming, from a STATUSTEXT."""
        if message.get_type() != "STATUSTEXT":
            return None
        kind, _, reason = f"{message.text}".partition(": ")
        return reason if kind in ("Arm", "PreArm") and reason else None

    def act(self, memory: DriverMemory, view: AutopilotView, desire: Desire, monotonic_ns: int) -> Requested:
        """Return the commands that bring ArduCopter nearer to `desire`."""
        climbs = desire.takeoff_height_m is not None and not _is_airborne(view, rises=desire.leaves_deck)
        memory = replace(memory, climbs_by_itself=climbs)
        if desire.armed is False and view.armed:
            return ask_to_disarm(memory, desire, monotonic_ns)
        memory = without_past_orders(memory, desire)
        if desire.release and view.in_control:
            return ask(memory, set_mode(_BRAKE), monotonic_ns)
        if desire.control and not view.in_control:
            return ask_for_control(memory, set_mode(_GUIDED), monotonic_ns)
        if desire.armed and not view.armed:
            return ask_to_arm(memory, monotonic_ns)
        if climbs and desire.takeoff_height_m is not None and view.armed and view.landed is not False:
            return _ask_to_take_off(memory, desire.takeoff_height_m, monotonic_ns)
        return memory, ()

    def acknowledged(self, memory: DriverMemory, command: int, result: int) -> DriverMemory:
        """Note what came of a mode, of arming and of disarming, and whether it takes off."""
        if command == mavlink.MAV_CMD_NAV_TAKEOFF:
            return replace(memory, takeoff_accepted=result == mavlink.MAV_RESULT_ACCEPTED)
        return with_answer(memory, command, result)

    def setpoint_message(self, setpoint: Setpoint, boot_ms: int, target_system: int) -> Message:
        """Return SET_POSITION_TARGET_LOCAL_NED; a group of it that is masked in part would mean "stop"."""
        return local_ned_setpoint(setpoint, boot_ms, target_system)

    def flies_to(self, sent: Message, told: Message) -> bool:
        """Return whether it is the setpoint as carried on since it came (AC_PosControl::input_pos_vel_accel_xy)."""
        return is_carried_on(sent, told, ANSWER_GAP_S)

    def limits(self, wanted: FlightLimits, parameters: Mapping[str, float]) -> FlightLimits:
        """Return `wanted` cut to ArduCopter's limits of speed, climb, descent, tilt and jerk.

        Its limits of acceleration bound its corrections alone: what a setpoint brings along is added to them
        (AC_PosControl's shape_vel_accel without `limit_total_accel`), and the jerk of the sum is bounded.
        """
        tilt_deg = min(_TILT.find(parameters), _TILT_BY_POSITION.find(parameters), _TILT_MAX_DEG)
        return replace(
            wanted,
            speed_max_m_s=min(wanted.speed_max_m_s, _SPEED.find(parameters)),
            climb_max_m_s=min(wanted.climb_max_m_s, _CLIMB.find(parameters)),
            descent_max_m_s=min(wanted.descent_max_m_s, _DESCENT.find(parameters)),
            tilt_acceleration_m_s2=acceleration_of_tilt_m_s2(tilt_deg),
            jerk_max_m_s3=min(wanted.jerk_max_m_s3, _shaping_jerk_m_s3(parameters)),
            vertical_jerk_max_m_s3=min(wanted.vertical_jerk_max_m_s3, _VERTICAL_JERK.find(parameters)),
        )

    def cascade(self, parameters: Mapping[str, float]) -> Cascade:
        """Return the horizontal gains, by default those of release 4.6.

        A setpoint is carried on by its own velocity and acceleration, so that it needs no lead.
        """
        position_per_s = find_gain(parameters, _POSITION_GAIN, 1.0)
        return Cascade(
            position_per_s=position_per_s,
            velocity_per_s=find_gain(parameters, _VELOCITY_GAIN, 2.0),
            integral_per_s2=find_gain(parameters, _INTEGRAL_GAIN, 1.0, INTEGRAL_FACTOR_MAX),
            lead_s=0.0,
            derivative=find_gain(parameters, _DERIVATIVE_GAIN, 0.5),
            derives_error=True,
            attitude_lag_s=attitude_lag_s(find_gain(parameters, _ATTITUDE_TIME, 0.15), position_per_s),
        )

    def shaping(self, parameters: Mapping[str, float]) -> Shaping | None:
        """Return the path by which GUIDED carries setpoints on, for a tenth of a second at least, whatever is set."""
        told_s = parameters.get(self.timeout_parameter, self.timeout_default_s)
        return Shaping(
            carried_s=max(told_s, _CARRIED_MIN_S) if math.isfinite(told_s) else self.timeout_default_s,
            acceleration_m_s2=_ACCELERATION.find(parameters),
            jerk_m_s3=_shaping_jerk_m_s3(parameters),
            vertical_acceleration_m_s2=_VERTICAL_ACCELERATION.find(parameters),
            vertical_jerk_m_s3=_VERTICAL_JERK.find(parameters),
        )


def _ask_to_take_off(memory: DriverMemory, height_m: float, monotonic_ns: int) -> Requested:
    """Ask again soon while no answer has come: a link may lose the command, and motors that idle are switched off."""
    again_s = _TAKE_OFF_AGAIN_S if memory.takeoff_accepted else ASK_AGAIN_S
    memory, commands = ask(memory, take_off(height_m), monotonic_ns, again_s)
    return (replace(memory, takeoff_accepted=False) if commands else memory), commands


def _shaping_jerk_m_s3(parameters: Mapping[str, float]) -> float:
    """Return the jerk that its shaping keeps to: the one set, and no more than turning over and back leaves."""
    rate_m_s3 = GRAVITY_M_S2 * math.radians(min(limit.find(parameters) for limit in _ATTITUDE_RATES))
    snap_m_s4 = GRAVITY_M_S2 * math.radians(min(limit.find(parameters) for limit in _ATTITUDE_ACCELERATIONS))
    average_m_s3 = 0.5 * math.sqrt(_ACCELERATION.find(parameters) * snap_m_s4)
    return max(min(_JERK.find(parameters), rate_m_s3, average_m_s3), _JERK_LEAST_M_S3)


def _is_airborne(view: AutopilotView, *, rises: bool) -> bool:
    """Return whether it flies and its own take-off is over, or has begun where it only has to leave a deck."""
    return view.armed and view.landed is False and (rises or not view.taking_off)
