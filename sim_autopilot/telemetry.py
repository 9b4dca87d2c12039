"""The messages that the autopilot sends of itself: which builder makes which, and from when on it can."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot import telemetry_motion as motion
from sim_autopilot import telemetry_status as status
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.streams import Stream

Builder = Callable[[AutopilotMemory, AutopilotConfig], Message | None]

BUILDERS: Mapping[int, Builder] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: status.heartbeat,
        mavlink.MAVLINK_MSG_ID_SYS_STATUS: status.sys_status,
        mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: status.system_time,
        mavlink.MAVLINK_MSG_ID_TIMESYNC: status.timesync_question,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: status.extended_sys_state,
        mavlink.MAVLINK_MSG_ID_CURRENT_MODE: status.current_mode,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: status.battery_status,
        mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: status.autopilot_version,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: motion.attitude,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: motion.attitude_quaternion,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: motion.local_position_ned,
        mavlink.MAVLINK_MSG_ID_ODOMETRY: motion.odometry,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: motion.position_target,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: motion.highres_imu,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: motion.distance_sensor,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: motion.vfr_hud,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: motion.global_position_int,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: motion.gps_raw_int,
        mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: motion.gps_global_origin,
        mavlink.MAVLINK_MSG_ID_HOME_POSITION: motion.home_position,
    }
)


def build_message(stream: Stream, memory: AutopilotMemory, config: AutopilotConfig) -> Message | None:
    """Return the message of `stream` as of now, None where there is nothing to tell yet."""
    if not config.instant and memory.now.boot_ns * 1e-9 < stream.from_s:
        return None
    return BUILDERS[stream.message_id](memory, config)
