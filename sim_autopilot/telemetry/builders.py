"""The messages that an autopilot of any firmware sends of itself: which builder makes which, and from when on."""

from collections.abc import Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.streams import Stream
from sim_autopilot.interfaces import AutopilotConfig, Builder, has_passed
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.missions.step import mission_current
from sim_autopilot.telemetry import high_latency, motion, range_finder, sensors, status, versions

BUILDERS: Mapping[int, Builder] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: status.heartbeat,
        mavlink.MAVLINK_MSG_ID_SYS_STATUS: status.sys_status,
        mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: status.system_time,
        mavlink.MAVLINK_MSG_ID_TIMESYNC: status.timesync_question,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: status.extended_sys_state,
        mavlink.MAVLINK_MSG_ID_ALTITUDE: sensors.altitude,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: sensors.scaled_pressure,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU: sensors.scaled_imu,
        mavlink.MAVLINK_MSG_ID_RAW_IMU: sensors.raw_imu,
        mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: sensors.servo_output_raw,
        mavlink.MAVLINK_MSG_ID_ACTUATOR_OUTPUT_STATUS: sensors.actuator_output_status,
        mavlink.MAVLINK_MSG_ID_VIBRATION: sensors.vibration,
        mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: sensors.estimator_status,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: sensors.attitude_target,
        mavlink.MAVLINK_MSG_ID_WIND_COV: sensors.wind_cov,
        mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION: sensors.hil_state_quaternion,
        mavlink.MAVLINK_MSG_ID_MISSION_CURRENT: mission_current,
        mavlink.MAVLINK_MSG_ID_CURRENT_MODE: status.current_mode,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: status.battery_status,
        mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: versions.autopilot_version,
        versions.PROTOCOL_VERSION: versions.protocol_version,
        mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION: versions.flight_information,
        mavlink.MAVLINK_MSG_ID_HIGH_LATENCY2: high_latency.high_latency2,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: motion.attitude,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: motion.attitude_quaternion,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: motion.local_position_ned,
        mavlink.MAVLINK_MSG_ID_ODOMETRY: motion.odometry,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: motion.position_target,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: sensors.highres_imu,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS: sensors.rc_channels,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: range_finder.distance_sensor,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: motion.vfr_hud,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: motion.global_position_int,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: motion.gps_raw_int,
        mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: motion.gps_global_origin,
        mavlink.MAVLINK_MSG_ID_HOME_POSITION: motion.home_position,
    }
)


def stream_of(message_id: int, config: AutopilotConfig) -> Stream | None:
    """Return the stream of a message that can be sent, None for one that cannot."""
    return config.firmware.streams.messages.get(message_id) or config.services.streams.get(message_id)


def build_message(stream: Stream, memory: AutopilotMemory, config: AutopilotConfig) -> Message | None:
    """Return the message of `stream` as of now, None where there is nothing to tell yet."""
    if not has_passed(config, memory, stream.from_s):
        return None
    rules, message_id = config.firmware.streams, stream.message_id
    if message_id in rules.on_contact and not memory.links.here.ground_station:
        return None
    builder = rules.builders.get(message_id) or BUILDERS.get(message_id) or config.services.builders[message_id]
    return builder(memory, config)
