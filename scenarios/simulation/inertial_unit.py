"""The inertial unit on the vehicle: heading, yaw rate and, if it tells them, roll, pitch and the specific force.

Model: white noise on each reading; the heading errs slowly as well (Gauss-Markov), the others by what stays in a run,
such as a sensor's offset and the angle at which it is mounted. Frames: W is ENU, V the vehicle's body in FLU.
"""

import math

from link.frames.rotations import conjugate, quaternion_from_roll_pitch_yaw, roll_pitch_yaw_of, rotate
from link.messages import Matrix3, Quaternion, Vector3, VehicleImu
from scenarios.config import ImuConfig
from scenarios.simulation.noise import GaussMarkov, Seed, SensorSchedule, named_rng, normal3
from scenarios.simulation.vehicle import VehicleState
from sim_autopilot.physics.airframe import GRAVITY_M_S2


def diagonal(variance: float) -> Matrix3:
    """Return the covariance (3, 3), row by row, of three independent errors of that variance."""
    return (variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance)


def total(*vectors: Vector3) -> Vector3:
    """Return the sum of `vectors`."""
    return sum(v[0] for v in vectors), sum(v[1] for v in vectors), sum(v[2] for v in vectors)


def scaled(vector: Vector3, factor: float) -> Vector3:
    """Return `factor` times `vector`."""
    return factor * vector[0], factor * vector[1], factor * vector[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the cross product of `a` and `b`."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def small_turn(rotation_vector_rad: Vector3) -> Quaternion:
    """Return the unit quaternion of a rotation vector."""
    angle_rad = math.hypot(*rotation_vector_rad)
    scale = 0.5 if angle_rad < 1e-9 else math.sin(0.5 * angle_rad) / angle_rad
    x, y, z = scaled(rotation_vector_rad, scale)
    return math.cos(0.5 * angle_rad), x, y, z


_UNTOLD_RAD2 = math.pi**2 / 3.0  # variance of an angle that may be anything


class InertialUnit:
    """Heading and yaw rate; a unit that does not tell roll and pitch reports them as level and wholly unknown.

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
        self._attitude_covariance = _attitude_covariance(config)
        self._rate_covariance = diagonal(config.yaw_rate_white_rad_s**2)
        self._tilt_rng = named_rng(seed, "imu tilt")
        self._tilt_bias_rad = normal3(self._tilt_rng, config.tilt_bias_rad)
        self._force_rng = named_rng(seed, "imu acceleration")
        self._force_bias_m_s2 = normal3(self._force_rng, config.acceleration_bias_m_s2)

    def sample(self, stamp_ns: int, vehicle: VehicleState, elapsed_s: float) -> VehicleImu:
        """Return what it reads, `elapsed_s` after the sample before."""
        heading_white, rate_white = self._rng.standard_normal(2).tolist()
        bias_rad = self._bias.step(elapsed_s)[2]
        yaw_rad = vehicle.yaw_rad + bias_rad + self._config.heading_white_rad * heading_white
        yaw_rate_rad_s = vehicle.angular_velocity_flu_rad_s[2] + self._config.yaw_rate_white_rad_s * rate_white
        (roll_rad, pitch_rad), (roll_rate_rad_s, pitch_rate_rad_s) = self._tilt(vehicle)
        return VehicleImu(
            t_ns=stamp_ns,
            orientation_wxyz=quaternion_from_roll_pitch_yaw(roll_rad, pitch_rad, yaw_rad),
            orientation_covariance_rad2=self._attitude_covariance,
            angular_velocity_flu_rad_s=(roll_rate_rad_s, pitch_rate_rad_s, yaw_rate_rad_s),
            angular_velocity_covariance_rad2_s2=self._rate_covariance,
            specific_force_flu_m_s2=self._force_m_s2(vehicle),
            specific_force_covariance_m2_s4=diagonal((self._config.acceleration_white_m_s2 or 0.0) ** 2),
        )

    def _tilt(self, vehicle: VehicleState) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return roll and pitch, and what it turns at about the body's axes."""
        white_rad = self._config.tilt_white_rad
        if white_rad is None:
            return (0.0, 0.0), (0.0, 0.0)
        roll_rad, pitch_rad, _ = roll_pitch_yaw_of(vehicle.orientation_wxyz)
        errors = self._tilt_rng.standard_normal(4).tolist()
        rate_rad_s = self._config.yaw_rate_white_rad_s
        p_rad_s, q_rad_s, _ = vehicle.angular_velocity_flu_rad_s
        tilt = (
            roll_rad + self._tilt_bias_rad[0] + white_rad * errors[0],
            pitch_rad + self._tilt_bias_rad[1] + white_rad * errors[1],
        )
        return tilt, (p_rad_s + rate_rad_s * errors[2], q_rad_s + rate_rad_s * errors[3])

    def _force_m_s2(self, vehicle: VehicleState) -> Vector3 | None:
        white_m_s2 = self._config.acceleration_white_m_s2
        if white_m_s2 is None:
            return None
        force_enu_m_s2 = total(vehicle.acceleration_enu_m_s2, (0.0, 0.0, GRAVITY_M_S2))
        force_flu_m_s2 = rotate(conjugate(vehicle.orientation_wxyz), force_enu_m_s2)
        return total(force_flu_m_s2, self._force_bias_m_s2, normal3(self._force_rng, white_m_s2))


def _attitude_covariance(config: ImuConfig) -> Matrix3:
    heading_rad2 = math.hypot(config.heading_white_rad, config.heading_bias_rad) ** 2
    tilt_rad2 = _UNTOLD_RAD2
    if config.tilt_white_rad is not None:
        tilt_rad2 = math.hypot(config.tilt_white_rad, config.tilt_bias_rad) ** 2
    return (tilt_rad2, 0.0, 0.0, 0.0, tilt_rad2, 0.0, 0.0, 0.0, heading_rad2)
