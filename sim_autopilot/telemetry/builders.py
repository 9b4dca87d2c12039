"""The messages that the autopilot sends of itself: which builder makes which, and from when on it can."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.firmware.component_metadata import COMPONENT_METADATA, PROTOCOL_VERSION
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, has_passed
from sim_autopilot.missions.step import mission_current
from sim_autopilot.streams import Stream
from sim_autopilot.telemetry import ardupilot, asked, motion, sensors, status, versions

Builder = Callable[[AutopilotMemory, AutopilotConfig], Message | None]

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
        PROTOCOL_VERSION: versions.protocol_version,
        COMPONENT_METADATA: versions.component_metadata,
        mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION: versions.flight_information,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: motion.attitude,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: motion.attitude_quaternion,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: motion.local_position_ned,
        mavlink.MAVLINK_MSG_ID_ODOMETRY: motion.odometry,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: motion.position_target,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: sensors.highres_imu,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS: sensors.rc_channels,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: motion.distance_sensor,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: motion.vfr_hud,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: motion.global_position_int,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: motion.gps_raw_int,
        mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: motion.gps_global_origin,
        mavlink.MAVLINK_MSG_ID_HOME_POSITION: motion.home_position,
        mavlink.MAVLINK_MSG_ID_AHRS: ardupilot.ahrs,
        mavlink.MAVLINK_MSG_ID_AHRS2: ardupilot.ahrs2,
        mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: ardupilot.ekf_status_report,
        mavlink.MAVLINK_MSG_ID_WIND: ardupilot.wind,
        mavlink.MAVLINK_MSG_ID_POWER_STATUS: ardupilot.power_status,
        mavlink.MAVLINK_MSG_ID_MEMINFO: ardupilot.meminfo,
        mavlink.MAVLINK_MSG_ID_HWSTATUS: ardupilot.hwstatus,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: ardupilot.nav_controller_output,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: ardupilot.position_target_global,
        mavlink.MAVLINK_MSG_ID_SIMSTATE: ardupilot.simstate,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU2: ardupilot.scaled_imu2,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU3: ardupilot.scaled_imu3,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2: ardupilot.scaled_pressure2,
        mavlink.MAVLINK_MSG_ID_FENCE_STATUS: ardupilot.fence_status,
        mavlink.MAVLINK_MSG_ID_SIM_STATE: asked.sim_state,
        mavlink.MAVLINK_MSG_ID_HIGH_LATENCY2: asked.high_latency2,
        mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT: asked.terrain_report,
        mavlink.MAVLINK_MSG_ID_AUTOPILOT_STATE_FOR_GIMBAL_DEVICE: asked.state_for_gimbal,
        mavlink.MAVLINK_MSG_ID_RELAY_STATUS: asked.relay_status,
        mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4: asked.esc_telemetry,
    }
)


def build_message(stream: Stream, memory: AutopilotMemory, config: AutopilotConfig) -> Message | None:
    """Return the message of `stream` as of now, None where there is nothing to tell yet."""
    if not has_passed(config, memory, stream.from_s):
        return None
    if stream.message_id in config.firmware.contact_streams and not memory.ground_station:
        return None
    return BUILDERS[stream.message_id](memory, config)
