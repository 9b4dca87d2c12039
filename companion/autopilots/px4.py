"""PX4: OFFBOARD needs a stream of setpoints first, and takes off from the ground by a setpoint above.

Source: PX4 user guide, offboard mode; behaviour measured against its built-in quadrotor simulation.
"""

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
    Requested,
    ask,
    ask_for_control,
    ask_to_arm,
    ask_to_disarm,
    have_same_place,
    local_ned_setpoint,
    set_mode,
    with_answer,
    without_past_orders,
)
from companion.autopilots.px4_events import refusal_of
from companion.autopilots.response import Cascade, Shaping
from companion.core.data import FlightLimits, Setpoint
from link.frames.geodesy import Projection
from link.mavlink.dialect import Message, mavlink
from link.records import replace

_MAIN_MODE_AUTO = 4
_MAIN_MODE_OFFBOARD = 6
_SUB_MODE_LOITER = 3
_IGNORE_POSITION = 0b0000_0000_0000_0111
_STREAM_FIRST_S = 0.5  # 0.3 s of setpoints were seen to suffice before OFFBOARD is granted
_TILT_MAX_DEG = 45.0  # nothing is planned beyond
# With the defaults of its versions 1.14 to 1.17.
_SPEED = Limit(12.0, (Named("MPC_XY_VEL_MAX"),))
_CLIMB = Limit(3.0, (Named("MPC_Z_VEL_MAX_UP"),))
_DESCENT = Limit(1.5, (Named("MPC_Z_VEL_MAX_DN"),))
_TILT = Limit(45.0, (Named("MPC_TILTMAX_AIR", least=TILT_LEAST_DEG),))


class Px4Driver:
    """Drives PX4, and the simulated autopilot that stands in for it."""

    name = "px4"
    autopilot_id: int = mavlink.MAV_AUTOPILOT_PX4
    projection = Projection.PX4
    limit_names = names_of((_SPEED, _CLIMB, _DESCENT, _TILT))
    gain_names = (("MPC_XY_P",), ("MPC_XY_VEL_P_ACC",), ("MPC_XY_VEL_I_ACC",), ("MPC_XY_VEL_D_ACC",), ("MC_ROLL_P",))
    hover_mode = "Hold"
    timeout_parameter = "COM_OF_LOSS_T"
    timeout_default_s = 1.0
    waits_in_mode = False
    takes_target_in_body_axes = False
    follows_in_failsafe = False  # what it only warns of is none
    speed_parameters = tuple(chain(*names_of((_SPEED,))))
    mode_streams_hz: Mapping[int, float] = MappingProxyType({mavlink.MAVLINK_MSG_ID_CURRENT_MODE: 20.0})
    # 340 messages a second of PX4's default set for an onboard computer; slow ones are left for the log
    unused_streams = (
        mavlink.MAVLINK_MSG_ID_ALTITUDE,
        mavlink.MAVLINK_MSG_ID_ATTITUDE,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU,
        mavlink.MAVLINK_MSG_ID_ODOMETRY,
        mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
        mavlink.MAVLINK_MSG_ID_VFR_HUD,
    )

    def is_in_control(self, base_mode: int, custom_mode: int) -> bool:
        """Return whether the mode is OFFBOARD."""
        custom = base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        return bool(custom) and (custom_mode >> 16) & 0xFF == _MAIN_MODE_OFFBOARD

    def refusal(self, message: Message) -> str | None:
        """Return what stands against arming, from an EVENT; a companion is sent no STATUSTEXT."""
        return refusal_of(message) if message.get_type() == "EVENT" else None

    def act(self, memory: DriverMemory, view: AutopilotView, desire: Desire, monotonic_ns: int) -> Requested:
        """Return the commands that bring PX4 nearer to `desire`."""
        if not desire.control:
            if memory.streaming_since_ns is not None:
                memory = replace(memory, streaming_since_ns=None)
        elif memory.streaming_since_ns is None:
            memory = replace(memory, streaming_since_ns=monotonic_ns)
        if desire.armed is False and view.armed:
            return ask_to_disarm(memory, desire, monotonic_ns)
        memory = without_past_orders(memory, desire)
        if desire.release and view.in_control:
            return ask(memory, set_mode(_MAIN_MODE_AUTO, _SUB_MODE_LOITER), monotonic_ns)
        if desire.control and not view.in_control and _streamed_s(memory, monotonic_ns) >= _STREAM_FIRST_S:
            return ask_for_control(memory, set_mode(_MAIN_MODE_OFFBOARD), monotonic_ns)
        if desire.armed and view.in_control and not view.armed:
            return ask_to_arm(memory, monotonic_ns)
        return memory, ()

    def acknowledged(self, memory: DriverMemory, command: int, result: int) -> DriverMemory:
        """Note what came of a mode, of arming and of disarming.

        Of a mode's two acknowledgements the second counts; the first one always accepts.
        """
        return with_answer(memory, command, result)

    def setpoint_message(self, setpoint: Setpoint, boot_ms: int, target_system: int) -> Message:
        """Return SET_POSITION_TARGET_LOCAL_NED."""
        return local_ned_setpoint(setpoint, boot_ms, target_system)

    def flies_to(self, sent: Message, told: Message) -> bool:
        """Return whether the place is the setpoint's; velocity and acceleration are the controller's own.

        Once its land detector has felt the ground it names no place: it presses down whatever setpoints ask for
        (MulticopterPositionControl::Run).
        """
        return bool(told.type_mask & _IGNORE_POSITION) or have_same_place(sent, told)

    def limits(self, wanted: FlightLimits, parameters: Mapping[str, float]) -> FlightLimits:
        """Return `wanted` cut to PX4's speed, climb, descent and tilt limits.

        MPC_ACC_*_MAX and MPC_JERK_MAX belong to the flight tasks of its own modes; OFFBOARD gives a setpoint to the
        position controller as it is (MulticopterPositionControl).
        """
        return replace(
            wanted,
            speed_max_m_s=min(wanted.speed_max_m_s, _SPEED.find(parameters)),
            climb_max_m_s=min(wanted.climb_max_m_s, _CLIMB.find(parameters)),
            descent_max_m_s=min(wanted.descent_max_m_s, _DESCENT.find(parameters)),
            tilt_acceleration_m_s2=acceleration_of_tilt_m_s2(min(_TILT.find(parameters), _TILT_MAX_DEG)),
        )

    def cascade(self, parameters: Mapping[str, float]) -> Cascade:
        """Return the horizontal gains, by default those of its version between 1.16 and 1.17.

        An acceleration that is asked for is added to the corrections as it comes (PositionControl::_velocityControl).
        The derivative is of the velocity alone, behind a filter of 5 Hz that is left out. A setpoint is held as it
        came: on average for half a period of 20 ms.
        """
        position, velocity, integral, derivative, attitude = self.gain_names
        position_per_s = find_gain(parameters, position, 0.95)
        return Cascade(
            position_per_s=position_per_s,
            velocity_per_s=find_gain(parameters, velocity, 1.8),
            integral_per_s2=find_gain(parameters, integral, 0.4, INTEGRAL_FACTOR_MAX),
            lead_s=0.01,
            derivative=find_gain(parameters, derivative, 0.2),
            is_led=True,
            attitude_lag_s=attitude_lag_s(1.0 / find_gain(parameters, attitude, 4.0), position_per_s),
        )

    def shaping(self, parameters: Mapping[str, float]) -> Shaping | None:  # noqa: ARG002 (the others' signature)
        """Return None: PX4 shapes no path, and holds setpoints as they came."""
        return None


def _streamed_s(memory: DriverMemory, monotonic_ns: int) -> float:
    return 0.0 if memory.streaming_since_ns is None else (monotonic_ns - memory.streaming_since_ns) * 1e-9
