"""The drone of a world, the air that it flies in, and how fast a vehicle it can be asked to follow."""

import math

from companion.config.companion import CompanionConfig
from companion.config.landing import TakeoffConfig
from scenarios.config import FirmwareName, SystemConfig, WindConfig
from scenarios.worlds.draws import Draws
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.runtime.config import DroneConfig

_LEAN_MAX_RAD = math.radians(25.0)  # against the air in steady flight: leaves 20 of 45 degrees to brake and turn
_SPEED_SHARE_MAX = 0.8  # of the speed to which the firmware is set: the rest is to catch up
_SPEED_SET_M_S = 30.0  # as the catalogue sets both firmwares, scenarios/catalogue/presets/system.toml
_GUST_STDS = 2.0  # of the turbulence along the wind, which is less than twice the vertical at 5 m


def draw_wind(draws: Draws) -> WindConfig:
    """Return the air of a world."""
    mean_m_s = draws.number("wind.mean_m_s")
    gusts_m_s = draws.number("wind.gust_share") * mean_m_s
    return WindConfig(
        mean_m_s=mean_m_s,
        from_rad=draws.number("wind.from_rad"),
        turbulence_std_m_s=draws.number("wind.turbulence_share") * mean_m_s,
        gust_m_s=gusts_m_s if draws.yes("wind.gust") else 0.0,
        gust_duration_s=draws.number("wind.gust_duration_s"),
        gust_from_rad=draws.number("wind.gust_from_rad"),
        gust_at_s=draws.number("wind.gust_at_s"),
    )


def draw_firmware(draws: Draws) -> FirmwareName:
    """Return the firmware that flies."""
    return "ardupilot" if draws.word("drone.firmware") == "ardupilot" else "px4"


def draw_drone(draws: Draws) -> DroneConfig:
    """Return the drone of a world."""
    return DroneConfig(
        mass_kg=draws.number("drone.mass_kg"),
        thrust_to_weight=draws.number("drone.thrust_to_weight"),
        drag_n_s_m=draws.number("drone.drag_n_s_m"),
        motor_time_constant_s=draws.number("drone.motor_time_constant_s"),
        friction_coefficient=draws.number("drone.gear_friction"),
    )


def system_of(draws: Draws, drone: DroneConfig, waiting_height_m: float) -> SystemConfig:
    """Return what flies: the companion as it is delivered, but for the height at which it waits."""
    hover_share = 1.0 / draws.number("drone.thrust_to_weight")
    response = draws.number("drone.response")
    parameters: dict[FirmwareName, dict[str, float]] = {
        "px4": {
            "MPC_XY_VEL_MAX": _SPEED_SET_M_S,
            "COM_OF_LOSS_T": 3.0,
            "COM_OBL_RC_ACT": 5.0,
            "MPC_THR_HOVER": hover_share,
        },
        "ardupilot": {
            "ANGLE_MAX": 4500.0,
            "WPNAV_SPEED": 100.0 * _SPEED_SET_M_S,
            "WPNAV_ACCEL": 500.0,
            "PSC_JERK_XY": 10.0,
            "WPNAV_SPEED_DN": 200.0,
            "WPNAV_ACCEL_Z": 300.0,
            "PSC_JERK_Z": 25.0,
            "GUID_TIMEOUT": 1.0,
            "MOT_THST_HOVER": hover_share,
            "PSC_POSXY_P": response,
            "PSC_VELXY_P": 2.0 * response,
        },
    }
    companion = CompanionConfig(takeoff=TakeoffConfig(waiting_height_m=waiting_height_m))
    return SystemConfig(companion=companion, drone=drone, parameters=parameters)


def speed_bound_m_s(drone: DroneConfig, wind: WindConfig) -> float:
    """Return the fastest cruise that the drone can follow against the wind, with something left to catch up."""
    if drone.mass_kg is None or drone.drag_n_s_m is None:
        raise ValueError("a drawn drone has a mass and a drag")
    through_air_m_s = drone.mass_kg * GRAVITY_M_S2 * math.tan(_LEAN_MAX_RAD) / drone.drag_n_s_m
    gusts_m_s = 2.0 * _GUST_STDS * (wind.turbulence_std_m_s or 0.0)
    return min(_SPEED_SHARE_MAX * _SPEED_SET_M_S, through_air_m_s - wind.mean_m_s - gusts_m_s)
