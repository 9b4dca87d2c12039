"""How commands are answered that change nothing here: about cameras, gimbals, calibration, logs and the like.

As both simulations were seen to answer them, on the ground and disarmed, with parameters of zero. Everything that is
neither here nor obeyed is UNSUPPORTED.
"""

from collections.abc import Mapping
from types import MappingProxyType

from link.mavlink.dialect import mavlink

_ACCEPTED, _DENIED, _FAILED = (
    int(result) for result in (mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_FAILED)
)

_CANCELLED = 6
"""MAV_RESULT_CANCELLED, which the dialect does not have."""

PX4_ANSWERS: Mapping[int, int | None] = MappingProxyType(
    dict.fromkeys(
        (
            mavlink.MAV_CMD_NAV_ROI,
            mavlink.MAV_CMD_DO_SET_ACTUATOR,
            mavlink.MAV_CMD_DO_GO_AROUND,
            mavlink.MAV_CMD_DO_SET_ROI_LOCATION,
            mavlink.MAV_CMD_DO_SET_ROI_WPNEXT_OFFSET,
            mavlink.MAV_CMD_DO_SET_ROI_NONE,
            mavlink.MAV_CMD_DO_SET_ROI,
            mavlink.MAV_CMD_REQUEST_STORAGE_INFORMATION,
        ),
        _ACCEPTED,
    )
    | dict.fromkeys((mavlink.MAV_CMD_DO_SET_STANDARD_MODE, mavlink.MAV_CMD_CONTROL_HIGH_LATENCY), _FAILED)
    | {mavlink.MAV_CMD_DO_LAND_START: _CANCELLED}
    | dict.fromkeys(
        (
            mavlink.MAV_CMD_DO_FIGURE_EIGHT,
            mavlink.MAV_CMD_NAV_VTOL_TAKEOFF,
            mavlink.MAV_CMD_NAV_DELAY,
            mavlink.MAV_CMD_DO_DIGICAM_CONTROL,
            mavlink.MAV_CMD_DO_MOUNT_CONFIGURE,
            mavlink.MAV_CMD_DO_MOUNT_CONTROL,
            mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
            mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL,
            mavlink.MAV_CMD_DO_MOUNT_CONTROL_QUAT,
            mavlink.MAV_CMD_PREFLIGHT_SET_SENSOR_OFFSETS,
            mavlink.MAV_CMD_OBLIQUE_SURVEY,
            mavlink.MAV_CMD_CONFIGURE_ACTUATOR,
            mavlink.MAV_CMD_START_RX_PAIR,
            mavlink.MAV_CMD_REQUEST_CAMERA_INFORMATION,
            mavlink.MAV_CMD_SET_CAMERA_MODE,
            mavlink.MAV_CMD_SET_CAMERA_ZOOM,
            mavlink.MAV_CMD_SET_CAMERA_FOCUS,
            mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
            mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
            mavlink.MAV_CMD_DO_TRIGGER_CONTROL,
            mavlink.MAV_CMD_DO_VTOL_TRANSITION,
            mavlink.MAV_CMD_PAYLOAD_PREPARE_DEPLOY,
            mavlink.MAV_CMD_PAYLOAD_CONTROL_DEPLOY,
            mavlink.MAV_CMD_DO_WINCH,
        ),
        None,
    )
)

ARDUCOPTER_ANSWERS: Mapping[int, int | None] = MappingProxyType(
    dict.fromkeys(
        (
            mavlink.MAV_CMD_DO_SET_RELAY,
            mavlink.MAV_CMD_DO_REPEAT_RELAY,
            mavlink.MAV_CMD_DO_SET_ROI,
            mavlink.MAV_CMD_DO_SET_ROI_LOCATION,
            mavlink.MAV_CMD_DO_SET_ROI_NONE,
            mavlink.MAV_CMD_DO_SET_ROI_SYSID,
            mavlink.MAV_CMD_DO_DIGICAM_CONFIGURE,
            mavlink.MAV_CMD_DO_DIGICAM_CONTROL,
            mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
            mavlink.MAV_CMD_DO_PARACHUTE,
            mavlink.MAV_CMD_DO_SPRAYER,
            mavlink.MAV_CMD_RUN_PREARM_CHECKS,
            mavlink.MAV_CMD_IMAGE_STOP_CAPTURE,
            mavlink.MAV_CMD_AIRFRAME_CONFIGURATION,
            mavlink.MAV_CMD_CONTROL_HIGH_LATENCY,
            mavlink.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE,
            mavlink.MAV_CMD_CAN_FORWARD,
            mavlink.MAV_CMD_SOLO_BTN_FLY_CLICK,
            mavlink.MAV_CMD_SOLO_BTN_FLY_HOLD,
            mavlink.MAV_CMD_SOLO_BTN_PAUSE_CLICK,
            mavlink.MAV_CMD_DO_START_MAG_CAL,
            mavlink.MAV_CMD_DO_ACCEPT_MAG_CAL,
            mavlink.MAV_CMD_DO_CANCEL_MAG_CAL,
            mavlink.MAV_CMD_BATTERY_RESET,
            mavlink.MAV_CMD_FIXED_MAG_CAL_YAW,
        ),
        _ACCEPTED,
    )
    | dict.fromkeys(
        (
            mavlink.MAV_CMD_DO_FOLLOW,
            mavlink.MAV_CMD_SET_CAMERA_FOCUS,
            mavlink.MAV_CMD_SET_CAMERA_SOURCE,
            mavlink.MAV_CMD_SET_EKF_SOURCE_SET,
            mavlink.MAV_CMD_DEBUG_TRAP,
        ),
        _DENIED,
    )
    | dict.fromkeys(
        (
            mavlink.MAV_CMD_NAV_VTOL_TAKEOFF,
            mavlink.MAV_CMD_DO_SET_ACTUATOR,
            mavlink.MAV_CMD_DO_RETURN_PATH_START,
            mavlink.MAV_CMD_DO_LAND_START,
            mavlink.MAV_CMD_DO_MOUNT_CONFIGURE,
            mavlink.MAV_CMD_DO_MOUNT_CONTROL,
            mavlink.MAV_CMD_DO_GRIPPER,
            mavlink.MAV_CMD_DO_AUX_FUNCTION,
            mavlink.MAV_CMD_START_RX_PAIR,
            mavlink.MAV_CMD_DO_JUMP_TAG,
            mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
            mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
            mavlink.MAV_CMD_IMAGE_START_CAPTURE,
            mavlink.MAV_CMD_VIDEO_START_CAPTURE,
            mavlink.MAV_CMD_VIDEO_STOP_CAPTURE,
            mavlink.MAV_CMD_DO_ADSB_OUT_IDENT,
            mavlink.MAV_CMD_ACCELCAL_VEHICLE_POS,
            mavlink.MAV_CMD_DO_WINCH,
        ),
        _FAILED,
    )
)
