"""The inertial unit on the vehicle: heading, yaw rate and, if it tells it, the specific force.

Model: white noise on each reading; the heading errs slowly as well (Gauss-Markov), the force by what stays in a run,
such as the sensor's offset and the angle at which it is mounted. Frames: W is ENU, V the vehicle's body in FLU.
"""

import math

from link.frames.rotations import conjugate, quaternion_from_yaw, rotate
from link.messages import Vector3, VehicleImu
from scenarios.config import ImuConfig
from scenarios.simulation.noise import GaussMarkov, Seed, SensorSchedule, named_rng, normal3
from scenarios.simulation.vectors import diagonal, total
from scenarios.simulation.vehicle import VehicleState
from sim_autopilot.physics.airframe import GRAVITY_M_S2


class InertialUnit:
    """Heading and yaw rate; roll and pitch are reported as level, with the same doubt as the heading.

    The specific force has gravity in it by roll and pitch of the road and of the body on its wheels. The unit is where
    the body's origin is, in the middle of the vehicle.
    """

    def __init__(self, config: ImuConfig, seed: Seed) -> None:
        self.schedule = SensorSchedule(config, seed, "imu")
        self._rng = named_rng(seed, "imu")
        self._bias = GaussMarkov(
            named_rng(seed, "imu bias"), std=config.heading_bias_rad, tau_s=config.heading_bias_tau_s
        )
        self._config = config
        self._heading_covariance = diagonal(math.hypot(config.heading_white_rad, config.heading_bias_rad) ** 2)
        self._rate_covariance = diagonal(config.yaw_rate_white_rad_s**2)
        self._force_rng = named_rng(seed, "imu acceleration")
        self._force_bias_m_s2 = normal3(self._force_rng, config.acceleration_bias_m_s2)

    def sample(self, stamp_ns: int, vehicle: VehicleState, elapsed_s: float) -> VehicleImu:
        """Return what it reads, `elapsed_s` after the sample before."""
        heading_white, rate_white = self._rng.standard_normal(2).tolist()
        bias_rad = self._bias.step(elapsed_s)[2]
        yaw_rad = vehicle.yaw_rad + bias_rad + self._config.heading_white_rad * heading_white
        yaw_rate_rad_s = vehicle.angular_velocity_flu_rad_s[2] + self._config.yaw_rate_white_rad_s * rate_white
        return VehicleImu(
            t_ns=stamp_ns,
            orientation_wxyz=quaternion_from_yaw(yaw_rad),
            orientation_covariance_rad2=self._heading_covariance,
            angular_velocity_flu_rad_s=(0.0, 0.0, yaw_rate_rad_s),
            angular_velocity_covariance_rad2_s2=self._rate_covariance,
            specific_force_flu_m_s2=self._force_m_s2(vehicle),
            specific_force_covariance_m2_s4=diagonal((self._config.acceleration_white_m_s2 or 0.0) ** 2),
        )

    def _force_m_s2(self, vehicle: VehicleState) -> Vector3 | None:
        white_m_s2 = self._config.acceleration_white_m_s2
        if white_m_s2 is None:
            return None
        force_enu_m_s2 = total(vehicle.acceleration_enu_m_s2, (0.0, 0.0, GRAVITY_M_S2))
        force_flu_m_s2 = rotate(conjugate(vehicle.orientation_wxyz), force_enu_m_s2)
        return total(force_flu_m_s2, self._force_bias_m_s2, normal3(self._force_rng, white_m_s2))
