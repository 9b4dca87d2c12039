"""PX4's events, as far as they say why it does not arm: it sends them where others send text.

Names are part of PX4's source and stay, since translations hang on them. The arguments of a `check_` event begin with a
field of the modes that it bars.

Source: MAVLink events interface, https://mavlink.io/en/services/events.html.
"""

from link.mavlink.dialect import Message, event_id

_EXTERNAL_LEVEL = 0x0F
_ERROR_LEVEL = 3  # as in syslog: this and below is emergency, alert, critical, error
_OFFBOARD_BIT = 14  # NAVIGATION_STATE_OFFBOARD

_NAMES = (
    "check_accel_no_data",
    "check_accel_not_calibrated",
    "check_avionics_power_low",
    "check_avionics_power_missing",
    "check_baro_no_data",
    "check_battery_critical",
    "check_battery_disconnected",
    "check_battery_emergency",
    "check_battery_fault",
    "check_battery_low",
    "check_battery_missing",
    "check_battery_unhealthy",
    "check_cpuload_too_high",
    "check_escs_offline",
    "check_estimator_gps_fix_too_low",
    "check_estimator_gps_hor_pos_err_too_high",
    "check_estimator_gps_not_fusing",
    "check_estimator_gps_num_sats_too_low",
    "check_estimator_heading_not_stable",
    "check_estimator_hgt_not_stable",
    "check_estimator_high_accel_bias",
    "check_estimator_high_gyro_bias",
    "check_estimator_hor_pos_not_stable",
    "check_estimator_hor_vel_not_stable",
    "check_estimator_mag_fault",
    "check_estimator_mag_interference",
    "check_estimator_missing_data",
    "check_estimator_vert_vel_not_stable",
    "check_failure_detector_pitch",
    "check_failure_detector_roll",
    "check_gf_no_home",
    "check_gyro_no_data",
    "check_gyro_not_calibrated",
    "check_mag_consistency",
    "check_mag_fault",
    "check_mag_no_data",
    "check_mag_not_calibrated",
    "check_man_control_kill_engaged",
    "check_missing_fmu_sdcard",
    "check_modes_attitude",
    "check_modes_global_pos",
    "check_modes_local_pos",
    "check_modes_manual_control",
    "check_modes_offboard_signal",
    "check_navigator_failure_hagl",
    "check_rc_dl_no_dllink",
    "check_system_flight_term_active",
    "check_system_no_global_pos",
    "check_system_no_home_pos",
    "check_system_safety_button",
    "check_system_usb_connected",
    "commander_arm_denied_calibrating",
    "commander_arm_denied_not_manual",
    "commander_arm_denied_resolve_failures",
    "commander_arm_denied_throttle_center",
    "commander_arm_denied_throttle_high",
    "commander_disarm_denied_not_landed",
)


_BY_ID = {event_id(name): name for name in _NAMES}


def refusal_of(event: Message) -> str | None:
    """Return why PX4 does not arm in OFFBOARD, or disarm, in words; None when EVENT says nothing of the kind."""
    if event.log_levels & _EXTERNAL_LEVEL > _ERROR_LEVEL:
        return None
    name = _BY_ID.get(event.id)
    if name is None:
        return f"event {event.id:#010x}"
    kind, _, words = name.partition("_")
    modes = int.from_bytes(event.arguments[:4], "little")
    return None if kind == "check" and not modes >> _OFFBOARD_BIT & 1 else words.replace("_", " ")
