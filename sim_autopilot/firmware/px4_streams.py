"""The messages that PX4 can send, with the rates at which its simulation streams them to a companion.

Source: measured on that simulation.
"""

from link.mavlink.dialect import mavlink
from sim_autopilot.component_metadata import COMPONENT_METADATA, PROTOCOL_VERSION
from sim_autopilot.streams import Stream

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
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
    Stream(message_id=PROTOCOL_VERSION),
    Stream(message_id=COMPONENT_METADATA),
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
)
