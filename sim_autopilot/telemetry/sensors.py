"""Messages about sensors, actuators and the estimator: all but the truth of a simulation err as `own_state` does.

Pressure and temperature: ICAO standard atmosphere, troposphere.
"""

from math import degrees, dist

from link.frames.rotations import frd_from_flu, quaternion_ned_frd_from_enu_flu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.places import geodetic
from sim_autopilot.flight.manual import sticks_in_effect
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.plant.snapshot import Snapshot, take_snapshot
from sim_autopilot.telemetry.range_finder import height_over_surface_m
from sim_autopilot.telemetry.status import boot_ms

_SEA_LEVEL_HPA = 1013.25
_SEA_LEVEL_K = 288.15
_LAPSE_K_M = 0.0065
_PRESSURE_EXPONENT = 5.2559
_ZERO_CELSIUS_K = 273.15
_MILLI_G_PER_M_S2 = 1000.0 / 9.80665
_PWM_LOW_US = 1000
_PWM_SPAN_US = 1000
_PWM_UNUSED_US = 900
_OUTPUTS = 16
_PWM_MIDDLE_US, _PWM_SWING_US = 1500, 500
_CHANNELS, _CHANNELS_MAX = 8, 18
_NO_CHANNEL, _NO_RSSI = 65535, 255
_UPDATED = 0b1_1011_1111_1111
"""All of HIGHRES_IMU but the differential pressure."""
_ESTIMATOR_FLAGS = 895
"""Attitude, velocity, position relative and absolute, height above ground, and their predictions: all good."""
_GAUSS_NORTH_DOWN = (0.19, 0.0, 0.45)
"""The Earth's field in Central Europe (World Magnetic Model 2025, rounded, declination left out)."""


def _altitude_m(memory: AutopilotMemory) -> float:
    return geodetic(memory.places.chart, memory.now.position_enu_m)[2]


def pressure_hpa(altitude_m: float) -> float:
    """Return the static pressure at an altitude above the sea; above the atmosphere of the formula it is 0."""
    share = max(1.0 - _LAPSE_K_M * altitude_m / _SEA_LEVEL_K, 0.0)
    return float(_SEA_LEVEL_HPA * share**_PRESSURE_EXPONENT)


def altitude(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return ALTITUDE."""
    now, above_sea_m = memory.now, _altitude_m(memory)
    local_m = above_sea_m - memory.places.origin.frame.origin.altitude_m
    clearance_m = height_over_surface_m(memory)
    return mavlink.MAVLink_altitude_message(
        now.boot_ns // 1000,
        above_sea_m,
        above_sea_m,
        local_m,
        now.position_enu_m[2] - memory.places.home_enu_m[2],
        local_m - clearance_m,
        clearance_m,
    )


def scaled_pressure(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return SCALED_PRESSURE of the barometer."""
    above_sea_m = _altitude_m(memory)
    celsius = _SEA_LEVEL_K - _LAPSE_K_M * above_sea_m - _ZERO_CELSIUS_K
    return mavlink.MAVLink_scaled_pressure_message(
        boot_ms(memory), pressure_hpa(above_sea_m), 0.0, round(100.0 * celsius)
    )


def _inertial(memory: AutopilotMemory) -> tuple[int, ...]:
    """Acceleration in mG, turn rates in mrad/s, magnetic field in mgauss, forward, right, down."""
    now = memory.now
    force = frd_from_flu(now.specific_force_flu_m_s2)
    rates = frd_from_flu(now.angular_velocity_flu_rad_s)
    field = magnetic_field_frd(memory)
    values = [f * _MILLI_G_PER_M_S2 for f in force] + [1000.0 * v for v in (*rates, *field)]
    return tuple(max(-32767, min(32767, round(value))) for value in values)


def magnetic_field_frd(memory: AutopilotMemory) -> tuple[float, float, float]:
    """Return the Earth's field in gauss, forward, right, down."""
    w, x, y, z = quaternion_ned_frd_from_enu_flu(memory.now.orientation_wxyz)
    north, _, down = _GAUSS_NORTH_DOWN
    forward = (1.0 - 2.0 * (y * y + z * z)) * north + 2.0 * (x * z - w * y) * down
    right = 2.0 * (x * y - w * z) * north + 2.0 * (y * z + w * x) * down
    below = 2.0 * (x * z + w * y) * north + (1.0 - 2.0 * (x * x + y * y)) * down
    return (forward, right, below)


def highres_imu(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return HIGHRES_IMU: accelerometer, gyroscope, magnetometer and barometer, in Pa as PX4 has it."""
    now, above_sea_m = memory.now, _altitude_m(memory)
    return mavlink.MAVLink_highres_imu_message(
        now.boot_ns // 1000,
        *frd_from_flu(now.specific_force_flu_m_s2),
        *frd_from_flu(now.angular_velocity_flu_rad_s),
        *magnetic_field_frd(memory),
        100.0 * pressure_hpa(above_sea_m),
        0.0,
        above_sea_m,
        _SEA_LEVEL_K - _LAPSE_K_M * above_sea_m - _ZERO_CELSIUS_K,
        _UPDATED,
    )


def rc_channels(memory: AutopilotMemory, _config: AutopilotConfig) -> Message | None:
    """Return RC_CHANNELS: what the modes obey, in pulse widths; None where there is no receiver and nobody steers."""
    sticks = sticks_in_effect(memory.heard.sticks, memory.now.boot_ns, memory.tuning.settings.sticks)
    if sticks is None:
        return None
    values = (sticks.roll, -sticks.pitch, sticks.throttle, sticks.yaw)
    used = [round(_PWM_MIDDLE_US + _PWM_SWING_US * value) for value in values]
    unused = (_NO_CHANNEL,) * (_CHANNELS_MAX - _CHANNELS)
    return mavlink.MAVLink_rc_channels_message(boot_ms(memory), _CHANNELS, *used, *sticks.others_us, *unused, _NO_RSSI)


def scaled_imu(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return SCALED_IMU."""
    return mavlink.MAVLink_scaled_imu_message(boot_ms(memory), *_inertial(memory))


def raw_imu(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return RAW_IMU, in the units of SCALED_IMU as ArduPilot has it."""
    return mavlink.MAVLink_raw_imu_message(memory.now.boot_ns // 1000, *_inertial(memory))


def _throttles(memory: AutopilotMemory) -> list[float]:
    """The share of its greatest speed that each rotor turns with."""
    airframe = memory.tuning.plant_config.airframe
    most_rad_s = airframe.hover_speed_rad_s * (airframe.thrust_to_weight or 2.0) ** 0.5
    return [min(1.0, max(0.0, speed / most_rad_s)) for speed in memory.plant.state.rotor_speed_rad_s.tolist()]


def servo_output_raw(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return SERVO_OUTPUT_RAW of the four motors."""
    used = [_PWM_LOW_US + round(_PWM_SPAN_US * share) for share in _throttles(memory)]
    return mavlink.MAVLink_servo_output_raw_message(
        memory.now.boot_ns // 1000 & 0xFFFFFFFF, 0, *used, *(_PWM_UNUSED_US,) * (_OUTPUTS - len(used))
    )


def actuator_output_status(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return ACTUATOR_OUTPUT_STATUS of the four motors."""
    shares = _throttles(memory)
    values = (*shares, *(0.0,) * (32 - len(shares)))
    return mavlink.MAVLink_actuator_output_status_message(memory.now.boot_ns // 1000, 0b1111, values)


def vibration(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return VIBRATION: the simulated airframe has none."""
    return mavlink.MAVLink_vibration_message(memory.now.boot_ns // 1000, 0.0, 0.0, 0.0, 0, 0, 0)


def estimator_status(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return ESTIMATOR_STATUS of an estimator that has converged."""
    return mavlink.MAVLink_estimator_status_message(
        memory.now.boot_ns // 1000, _ESTIMATOR_FLAGS, 0.1, 0.1, 0.1, 0.1, 0.1, 0.0, 0.3, 0.3
    )


def attitude_target(memory: AutopilotMemory, _config: AutopilotConfig) -> Message | None:
    """Return ATTITUDE_TARGET, None while the motors are off; the controller's own is taken as the attitude flown."""
    if memory.course.following is None:
        return None
    now = memory.now
    rates = frd_from_flu(now.angular_velocity_flu_rad_s)
    most = memory.tuning.plant_config.airframe.thrust_to_weight or 2.0
    thrust = min(1.0, now.thrust_share / most)
    q = quaternion_ned_frd_from_enu_flu(now.orientation_wxyz)
    return mavlink.MAVLink_attitude_target_message(boot_ms(memory), 0, q, *rates, thrust)


def wind_cov(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return WIND_COV of the air that the drone flies in."""
    east, north, up = memory.world.wind_enu_m_s
    altitude_m = _altitude_m(memory)
    return mavlink.MAVLink_wind_cov_message(
        memory.now.boot_ns // 1000, north, east, -up, 0.1, 0.1, altitude_m, 0.1, 0.1
    )


def truth(memory: AutopilotMemory) -> Snapshot:
    """Return the drone as it is, without the error of what its autopilot believes."""
    return take_snapshot(memory.plant.state, memory.tuning.plant_config.airframe, memory.now.boot_ns)


def hil_state_quaternion(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return HIL_STATE_QUATERNION, by which a simulation tells the truth."""
    now = truth(memory)
    latitude, longitude, altitude_m = geodetic(memory.places.chart, now.position_enu_m)
    east, north, up = now.velocity_enu_m_s
    velocity = (round(100.0 * v) for v in (north, east, -up))
    airspeed_cm_s = round(100.0 * dist(now.velocity_enu_m_s, memory.world.wind_enu_m_s))
    force = (max(-32767, min(32767, round(f * _MILLI_G_PER_M_S2))) for f in frd_from_flu(now.specific_force_flu_m_s2))
    return mavlink.MAVLink_hil_state_quaternion_message(
        now.boot_ns // 1000,
        quaternion_ned_frd_from_enu_flu(now.orientation_wxyz),
        *frd_from_flu(now.angular_velocity_flu_rad_s),
        round(degrees(latitude) * 1e7),
        round(degrees(longitude) * 1e7),
        round(1000.0 * altitude_m),
        *velocity,
        airspeed_cm_s,
        airspeed_cm_s,
        *force,
    )
