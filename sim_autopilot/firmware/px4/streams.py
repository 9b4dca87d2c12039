"""The messages that PX4 can send, with the rates at which its simulation streams them to a companion.

Source: measured on that simulation.
"""

from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.core.firmware import DefaultLink, LinkRules
from sim_autopilot.core.streams import Stream
from sim_autopilot.telemetry.versions import PROTOCOL_VERSION

STREAMS = (
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HEARTBEAT, rate_hz=1.0, fixed=True),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SYS_STATUS, rate_hz=5.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SYSTEM_TIME, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GPS_RAW_INT, rate_hz=8.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE, rate_hz=100.0, from_s=1.8),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, rate_hz=50.0, from_s=1.8),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, rate_hz=30.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, rate_hz=50.0, from_s=2.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN, from_s=0.8),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_VFR_HUD, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, rate_hz=50.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_TIMESYNC, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_BATTERY_STATUS, rate_hz=0.5, from_s=1.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIGH_LATENCY2),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
    Stream(message_id=PROTOCOL_VERSION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_FLIGHT_INFORMATION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HOME_POSITION, rate_hz=0.5, from_s=1.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, rate_hz=5.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ODOMETRY, rate_hz=30.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ALTITUDE, rate_hz=10.0, from_s=2.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_IMU),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ACTUATOR_OUTPUT_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_VIBRATION, rate_hz=0.5),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_WIND_COV),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_MISSION_CURRENT, rate_hz=1.0, fixed=True),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_RC_CHANNELS, rate_hz=20.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_CURRENT_MODE, rate_hz=0.5, from_s=1.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS, rate_hz=5.0),
)
SILENT_MESSAGES = frozenset(
    {
        mavlink.MAVLINK_MSG_ID_GPS_STATUS,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
        mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL,
        mavlink.MAVLINK_MSG_ID_COMMAND_LONG,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
        mavlink.MAVLINK_MSG_ID_HIL_ACTUATOR_CONTROLS,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW_RAD,
        mavlink.MAVLINK_MSG_ID_CAMERA_TRIGGER,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU2,
        mavlink.MAVLINK_MSG_ID_GPS2_RAW,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU3,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE3,
        mavlink.MAVLINK_MSG_ID_LANDING_TARGET,
        mavlink.MAVLINK_MSG_ID_MAG_CAL_REPORT,
        mavlink.MAVLINK_MSG_ID_EFI_STATUS,
        mavlink.MAVLINK_MSG_ID_GPS_RTCM_DATA,
        mavlink.MAVLINK_MSG_ID_ADSB_VEHICLE,
        mavlink.MAVLINK_MSG_ID_DEBUG_VECT,
        mavlink.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT,
        mavlink.MAVLINK_MSG_ID_STATUSTEXT,
        mavlink.MAVLINK_MSG_ID_DEBUG,
        mavlink.MAVLINK_MSG_ID_STORAGE_INFORMATION,
        mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED,
        mavlink.MAVLINK_MSG_ID_MOUNT_ORIENTATION,
        mavlink.MAVLINK_MSG_ID_GIMBAL_MANAGER_INFORMATION,
        mavlink.MAVLINK_MSG_ID_GIMBAL_MANAGER_STATUS,
        mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_INFORMATION,
        mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_SET_ATTITUDE,
        mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS,
        mavlink.MAVLINK_MSG_ID_AUTOPILOT_STATE_FOR_GIMBAL_DEVICE,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
        mavlink.MAVLINK_MSG_ID_RAW_RPM,
        mavlink.MAVLINK_MSG_ID_DEBUG_FLOAT_ARRAY,
        mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES,
        mavlink.MAVLINK_MSG_ID_OPEN_DRONE_ID_BASIC_ID,
        mavlink.MAVLINK_MSG_ID_OPEN_DRONE_ID_LOCATION,
        mavlink.MAVLINK_MSG_ID_OPEN_DRONE_ID_SYSTEM,
        mavlink.MAVLINK_MSG_ID_OPEN_DRONE_ID_ARM_STATUS,
        mavlink.MAVLINK_MSG_ID_HYGROMETER_SENSOR,
    }
)
"""What it takes a rate for and has nothing to tell of: no such hardware, or nothing that is simulated."""


_REMOTE_PORT_LAST = 14549  # companions of more than ten instances share it
_GROUND_RATES_HZ = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: 1.0,
        mavlink.MAVLINK_MSG_ID_ALTITUDE: 1.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE: 50.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 50.0,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: 50.0,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 0.5,
        mavlink.MAVLINK_MSG_ID_CURRENT_MODE: 0.5,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.5,
        mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 0.5,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 1.0,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 50.0,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 5.0,
        mavlink.MAVLINK_MSG_ID_HOME_POSITION: 0.5,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 50.0,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 1.0,
        mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS: 2.0,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: 1.0,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: 50.0,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS: 20.0,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: 1.0,
        mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 50.0,
        mavlink.MAVLINK_MSG_ID_SYS_STATUS: 1.0,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: 4.0,
        mavlink.MAVLINK_MSG_ID_VIBRATION: 0.1,
    }
)
"""Of the link to a ground station, as its simulation sets it up; messages that are not simulated are left out."""


def _default_links(instance: int) -> tuple[DefaultLink, ...]:
    companion_port = min(14540 + instance, _REMOTE_PORT_LAST)
    return (
        DefaultLink(device=f"udpout:127.0.0.1:{companion_port}:{14580 + instance}"),
        DefaultLink(device=f"udpout:127.0.0.1:14550:{18570 + instance}", is_ground=True),
    )


LINKS = LinkRules(defaults=_default_links, answers_ping=True, takes_signing=False, ground_rates_hz=_GROUND_RATES_HZ)
