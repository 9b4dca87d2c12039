"""PX4: OFFBOARD needs a stream of setpoints first, and takes off from the ground by a setpoint above.

Source: PX4 user guide, offboard mode; behaviour measured against its built-in quadrotor simulation.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

from companion.autopilots.driver import AutopilotCommand, AutopilotView, Desire, DriverMemory
from companion.autopilots.setpoint_message import local_ned_setpoint
from companion.data import FlightLimits, Setpoint
from link.mavlink.dialect import Message, mavlink

_MAIN_MODE_AUTO = 4
_MAIN_MODE_OFFBOARD = 6
_SUB_MODE_LOITER = 3
_CUSTOM_MODE_FLAG = 1.0  # MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
_FORCE_DISARM = 21196.0  # MAVLink common, MAV_CMD_COMPONENT_ARM_DISARM, parameter 2
_STREAM_FIRST_S = 0.5  # 0.3 s of setpoints were seen to suffice before OFFBOARD is granted
_ASK_AGAIN_S = 1.0  # the heartbeat that confirms a mode may be a second late
_DISARM_AGAIN_S = 0.2
_GRAVITY_M_S2 = 9.81
_TILT_MAX_DEG = 45.0  # taken while MPC_TILTMAX_AIR is unknown: its default
_STATED_MIN = 0.1  # m/s or degrees; a limit below this cannot be flown with
_TILT_SHARE = 0.7  # of the tilt limit left to planned acceleration; the rest is for drag and wind


class Px4Driver:
    """Drives PX4, and the simulated autopilot that stands in for it."""

    name = "px4"
    autopilot_id: int = mavlink.MAV_AUTOPILOT_PX4
    limit_parameters = ("MPC_XY_VEL_MAX", "MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN", "MPC_TILTMAX_AIR")
    # 310 messages a second of PX4's default set for an onboard computer
    unused_streams = (
        mavlink.MAVLINK_MSG_ID_ATTITUDE,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU,
        mavlink.MAVLINK_MSG_ID_ODOMETRY,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED,
        mavlink.MAVLINK_MSG_ID_VFR_HUD,
    )

    def is_in_control(self, base_mode: int, custom_mode: int) -> bool:
        """Return whether the mode is OFFBOARD."""
        custom = base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        return bool(custom) and (custom_mode >> 16) & 0xFF == _MAIN_MODE_OFFBOARD

    def act(
        self, memory: DriverMemory, view: AutopilotView, desire: Desire, t_ns: int
    ) -> tuple[DriverMemory, tuple[AutopilotCommand, ...]]:
        """Return the commands that bring PX4 nearer to `desire`."""
        if not desire.control:
            memory = replace(memory, streaming_since_ns=None)
        elif memory.streaming_since_ns is None:
            memory = replace(memory, streaming_since_ns=t_ns)
        if desire.armed is False and view.armed:
            return self._disarm(memory, desire, t_ns)
        memory = replace(memory, disarm_asked=False, disarm_refusals=0)
        if desire.release and view.in_control:
            return _ask(memory, _set_mode(_MAIN_MODE_AUTO, _SUB_MODE_LOITER), t_ns, _ASK_AGAIN_S)
        if desire.control and not view.in_control and _streamed_s(memory, t_ns) >= _STREAM_FIRST_S:
            return _ask(memory, _set_mode(_MAIN_MODE_OFFBOARD, 0), t_ns, _ASK_AGAIN_S)
        if desire.armed and view.in_control and not view.armed:
            return _ask(memory, _arm(armed=True), t_ns, _ASK_AGAIN_S)
        return memory, ()

    def _disarm(
        self, memory: DriverMemory, desire: Desire, t_ns: int
    ) -> tuple[DriverMemory, tuple[AutopilotCommand, ...]]:
        """Ask plainly; once that was refused, and only with the evidence complete, force it."""
        force = desire.force_disarm and memory.disarm_refusals > 0
        return _ask(replace(memory, disarm_asked=True), _arm(armed=False, force=force), t_ns, _DISARM_AGAIN_S)

    def acknowledged(self, memory: DriverMemory, command: int, result: int) -> DriverMemory:
        """Count refused disarms; an answer to an earlier arming is none."""
        refused = result not in (mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_IN_PROGRESS)
        if command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM and refused and memory.disarm_asked:
            return replace(memory, disarm_refusals=memory.disarm_refusals + 1)
        return memory

    def setpoint_message(self, setpoint: Setpoint, boot_ms: int, target_system: int) -> Message:
        """Return SET_POSITION_TARGET_LOCAL_NED."""
        return local_ned_setpoint(setpoint, boot_ms, target_system)

    def limits(self, wanted: FlightLimits, parameters: Mapping[str, float]) -> FlightLimits:
        """Return `wanted` cut to PX4's speed, climb, descent and tilt limits."""
        tilt_rad = math.radians(min(_stated(parameters, "MPC_TILTMAX_AIR"), _TILT_MAX_DEG))
        return replace(
            wanted,
            speed_max_m_s=min(wanted.speed_max_m_s, _stated(parameters, "MPC_XY_VEL_MAX")),
            climb_max_m_s=min(wanted.climb_max_m_s, _stated(parameters, "MPC_Z_VEL_MAX_UP")),
            descent_max_m_s=min(wanted.descent_max_m_s, _stated(parameters, "MPC_Z_VEL_MAX_DN")),
            acceleration_max_m_s2=min(wanted.acceleration_max_m_s2, _TILT_SHARE * _GRAVITY_M_S2 * math.tan(tilt_rad)),
        )


def _stated(parameters: Mapping[str, float], name: str) -> float:
    """Return a parameter, infinity where it is unknown or says what cannot be meant."""
    value = parameters.get(name, math.inf)
    return value if value >= _STATED_MIN else math.inf


def _streamed_s(memory: DriverMemory, t_ns: int) -> float:
    return 0.0 if memory.streaming_since_ns is None else (t_ns - memory.streaming_since_ns) * 1e-9


def _ask(
    memory: DriverMemory, command: AutopilotCommand, t_ns: int, again_s: float
) -> tuple[DriverMemory, tuple[AutopilotCommand, ...]]:
    """Return `command`, unless the same one, parameters included, was sent less than `again_s` ago."""
    asked = dict(memory.asked_ns or {})
    last_ns = asked.get(command)
    if last_ns is not None and (t_ns - last_ns) * 1e-9 < again_s:
        return memory, ()
    asked[command] = t_ns
    return replace(memory, asked_ns=asked), (command,)


def _set_mode(main: int, sub: int) -> AutopilotCommand:
    parameters = (_CUSTOM_MODE_FLAG, float(main), float(sub), 0.0, 0.0, 0.0, 0.0)
    return AutopilotCommand(command=mavlink.MAV_CMD_DO_SET_MODE, parameters=parameters)


def _arm(*, armed: bool, force: bool = False) -> AutopilotCommand:
    parameters = (float(armed), _FORCE_DISARM if force else 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return AutopilotCommand(command=mavlink.MAV_CMD_COMPONENT_ARM_DISARM, parameters=parameters)
