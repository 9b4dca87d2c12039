"""The messages that ArduCopter can stream: none unasked but the heartbeat, and the groups that older clients ask for.

Source: ArduCopter's own table of stream groups, as far as the stand-in can build the messages.
"""

from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.core.streams import Stream

_POSITION_S = 41.4
"""After boot the estimator begins to use GPS, and LOCAL_POSITION_NED begins to exist."""
_ORIGIN_S = 20.0
_TIMESYNC_HZ = 0.1

STREAMS = (
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HEARTBEAT, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_TIMESYNC, rate_hz=_TIMESYNC_HZ),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SYS_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SYSTEM_TIME),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GPS_RAW_INT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, from_s=_POSITION_S),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN, from_s=_ORIGIN_S),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HOME_POSITION, from_s=_ORIGIN_S),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_VFR_HUD),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_BATTERY_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_CURRENT_MODE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_RC_CHANNELS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_MISSION_CURRENT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_RAW_IMU),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_VIBRATION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_IMU),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIGHRES_IMU),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AHRS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AHRS2),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_WIND),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_POWER_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_MEMINFO),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HWSTATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SIMSTATE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_IMU2),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_IMU3),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_FENCE_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SIM_STATE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIGH_LATENCY2),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AUTOPILOT_STATE_FOR_GIMBAL_DEVICE),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_RELAY_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4),
)

CONTACT_STREAMS = frozenset({mavlink.MAVLINK_MSG_ID_TIMESYNC})

_RAW_SENSORS = (
    mavlink.MAVLINK_MSG_ID_RAW_IMU,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU2,
    mavlink.MAVLINK_MSG_ID_SCALED_IMU3,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2,
)
_EXTENDED_STATUS = (
    mavlink.MAVLINK_MSG_ID_SYS_STATUS,
    mavlink.MAVLINK_MSG_ID_POWER_STATUS,
    mavlink.MAVLINK_MSG_ID_MEMINFO,
    mavlink.MAVLINK_MSG_ID_MISSION_CURRENT,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
    mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
)
_POSITION = (
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
)
_CHANNELS = (
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
    mavlink.MAVLINK_MSG_ID_RC_CHANNELS,
)
_EXTRA1 = (
    mavlink.MAVLINK_MSG_ID_ATTITUDE,
    mavlink.MAVLINK_MSG_ID_SIMSTATE,
    mavlink.MAVLINK_MSG_ID_AHRS2,
)
_EXTRA2 = (mavlink.MAVLINK_MSG_ID_VFR_HUD,)
_EXTRA3 = (
    mavlink.MAVLINK_MSG_ID_AHRS,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME,
    mavlink.MAVLINK_MSG_ID_WIND,
    mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS,
    mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT,
    mavlink.MAVLINK_MSG_ID_VIBRATION,
)
_GROUPS = {
    mavlink.MAV_DATA_STREAM_RAW_SENSORS: _RAW_SENSORS,
    mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: _EXTENDED_STATUS,
    mavlink.MAV_DATA_STREAM_RC_CHANNELS: _CHANNELS,
    mavlink.MAV_DATA_STREAM_POSITION: _POSITION,
    mavlink.MAV_DATA_STREAM_EXTRA1: _EXTRA1,
    mavlink.MAV_DATA_STREAM_EXTRA2: _EXTRA2,
    mavlink.MAV_DATA_STREAM_EXTRA3: _EXTRA3,
}

STREAM_GROUPS = MappingProxyType(
    {int(mavlink.MAV_DATA_STREAM_ALL): tuple(one for group in _GROUPS.values() for one in group)}
    | {int(number): group for number, group in _GROUPS.items()}
)

GROUP_PARAMETERS = MappingProxyType(
    {
        int(mavlink.MAV_DATA_STREAM_RAW_SENSORS): "RAW_SENS",
        int(mavlink.MAV_DATA_STREAM_EXTENDED_STATUS): "EXT_STAT",
        int(mavlink.MAV_DATA_STREAM_RC_CHANNELS): "RC_CHAN",
        int(mavlink.MAV_DATA_STREAM_RAW_CONTROLLER): "RAW_CTRL",
        int(mavlink.MAV_DATA_STREAM_POSITION): "POSITION",
        int(mavlink.MAV_DATA_STREAM_EXTRA1): "EXTRA1",
        int(mavlink.MAV_DATA_STREAM_EXTRA2): "EXTRA2",
        int(mavlink.MAV_DATA_STREAM_EXTRA3): "EXTRA3",
    }
)
"""After the link's SR0_, SR1_ and so on. ALL sets these and SRn_ADSB, which has no group of its own."""

SILENT_MESSAGES = frozenset(
    {
        mavlink.MAVLINK_MSG_ID_PARAM_VALUE,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS_SCALED,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS_RAW,
        mavlink.MAVLINK_MSG_ID_MISSION_ITEM_REACHED,
        mavlink.MAVLINK_MSG_ID_OPTICAL_FLOW,
        mavlink.MAVLINK_MSG_ID_GPS2_RAW,
        mavlink.MAVLINK_MSG_ID_GPS_RTK,
        mavlink.MAVLINK_MSG_ID_GPS2_RTK,
        mavlink.MAVLINK_MSG_ID_TERRAIN_REQUEST,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE3,
        mavlink.MAVLINK_MSG_ID_RANGEFINDER,
        mavlink.MAVLINK_MSG_ID_CAMERA_FEEDBACK,
        mavlink.MAVLINK_MSG_ID_MAG_CAL_PROGRESS,
        mavlink.MAVLINK_MSG_ID_MAG_CAL_REPORT,
        mavlink.MAVLINK_MSG_ID_PID_TUNING,
        mavlink.MAVLINK_MSG_ID_DEEPSTALL,
        mavlink.MAVLINK_MSG_ID_EFI_STATUS,
        mavlink.MAVLINK_MSG_ID_RPM,
        mavlink.MAVLINK_MSG_ID_ADSB_VEHICLE,
        mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION,
        mavlink.MAVLINK_MSG_ID_CAMERA_SETTINGS,
        mavlink.MAVLINK_MSG_ID_CAMERA_CAPTURE_STATUS,
        mavlink.MAVLINK_MSG_ID_VIDEO_STREAM_INFORMATION,
        mavlink.MAVLINK_MSG_ID_CAMERA_FOV_STATUS,
        mavlink.MAVLINK_MSG_ID_CAMERA_THERMAL_RANGE,
        mavlink.MAVLINK_MSG_ID_GIMBAL_MANAGER_INFORMATION,
        mavlink.MAVLINK_MSG_ID_GIMBAL_MANAGER_STATUS,
        mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS,
        mavlink.MAVLINK_MSG_ID_AIRSPEED,
        mavlink.MAVLINK_MSG_ID_AIS_VESSEL,
        mavlink.MAVLINK_MSG_ID_GENERATOR_STATUS,
        mavlink.MAVLINK_MSG_ID_WINCH_STATUS,
        mavlink.MAVLINK_MSG_ID_UAVIONIX_ADSB_OUT_STATUS,
        mavlink.MAVLINK_MSG_ID_AOA_SSA,
    }
)
"""What can be asked for as on the measured build, with nothing to tell here (and, most of them, there)."""
