"""Models of the sensors on the vehicle and of the drone's detector of the landing pattern.

A sample carries the instant at which it was TAKEN, by the clock of who takes it, and leaves the suite later, when its
delay is over. Samples are taken at the first step at or after they are due, so rates should divide the step rate.
Each sensor draws from a generator of its own, seeded by its name: another sensor changes nothing about it.
Noise: white normal, and first-order Gauss-Markov for a bias; standard deviations hold on each axis.
"""

import heapq
import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from link.frames.geodesy import Datum, geodetic_from_enu
from link.frames.rotations import canonical, conjugate, multiply, rotate
from link.messages import BodyTruth, Fix, FixVelocity, PadSighting, Vector3, VehicleImu
from link.records import replace
from scenarios.config import FixConfig, PatternConfig, SensorsConfig, VelocityConfig
from scenarios.simulation.inertial_unit import InertialUnit, cross, diagonal, scaled, small_turn, total
from scenarios.simulation.noise import Dropouts, GaussMarkov, Seed, SensorSchedule, StampClock, named_rng, normal3
from scenarios.simulation.vehicle import VehicleState

Sample = Fix | FixVelocity | VehicleImu | PadSighting
_DRONE_AGE_MAX_S = 0.1  # an older truth of the drone makes no sighting
_STATED_STD_MIN_M = 0.01  # a receiver never states less


@dataclass(frozen=True, slots=True, kw_only=True)
class Mounting:
    """Where things are on the vehicle, in V."""

    antenna_flu_m: Vector3
    pad_height_m: float


class _FixSensor:
    """The receiver's position, at the antenna, in the receiver's own frame."""

    def __init__(
        self, config: FixConfig, seed: Seed, *, mounting: Mounting, offset_enu_m: Vector3, datum: Datum
    ) -> None:
        self.schedule = SensorSchedule(config, seed, "fix")
        self._rng = named_rng(seed, "fix")
        self._bias = GaussMarkov(named_rng(seed, "fix bias"), std=config.bias_m, tau_s=config.bias_tau_s)
        self._config = config
        self._covariance = diagonal(max(_STATED_STD_MIN_M, math.hypot(config.white_m, config.bias_m)) ** 2)
        self._mounting = mounting
        self._offset_enu_m = offset_enu_m
        self._datum = datum
        self.slide_enu_m_s: Vector3 = (0.0, 0.0, 0.0)

    def sample(self, stamp_ns: int, vehicle: VehicleState, elapsed_s: float) -> Fix:
        self._offset_enu_m = total(self._offset_enu_m, scaled(self.slide_enu_m_s, elapsed_s))
        lever_m = rotate(vehicle.orientation_wxyz, self._mounting.antenna_flu_m)
        errors_m = (self._offset_enu_m, self._bias.step(elapsed_s), white_error_m(self._config, self._rng))
        position_enu_m = total(vehicle.position_enu_m, lever_m, *errors_m)
        latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(self._datum, position_enu_m)
        return Fix(
            t_ns=stamp_ns,
            latitude_rad=latitude_rad,
            longitude_rad=longitude_rad,
            altitude_m=altitude_m,
            covariance_enu_m2=self._covariance,
        )


def white_error_m(config: FixConfig, rng: np.random.Generator) -> Vector3:
    """Return the white part of a fix's error."""
    if not config.white_shared:
        return normal3(rng, config.white_m)
    error_m = float(rng.normal(0.0, config.white_m))
    return error_m, error_m, error_m


class _VelocitySensor:
    """The receiver's velocity, at the antenna."""

    def __init__(self, config: VelocityConfig, seed: Seed, *, mounting: Mounting) -> None:
        self.schedule = SensorSchedule(config, seed, "velocity")
        self._rng = named_rng(seed, "velocity")
        self._white_m_s = config.white_m_s
        self._covariance = diagonal(max(_STATED_STD_MIN_M, config.white_m_s) ** 2)
        self._mounting = mounting

    def sample(self, stamp_ns: int, vehicle: VehicleState, _elapsed_s: float) -> FixVelocity:
        swing_flu_m_s = cross(vehicle.angular_velocity_flu_rad_s, self._mounting.antenna_flu_m)
        swing_enu_m_s = rotate(vehicle.orientation_wxyz, swing_flu_m_s)
        velocity_enu_m_s = total(vehicle.velocity_enu_m_s, swing_enu_m_s, normal3(self._rng, self._white_m_s))
        return FixVelocity(
            t_ns=stamp_ns, velocity_enu_m_s=velocity_enu_m_s, velocity_covariance_enu_m2_s2=self._covariance
        )


class _PatternSensor:
    """The detector on the drone: a cone of view straight down from the drone's centre."""

    def __init__(self, config: PatternConfig, seed: Seed, *, mounting: Mounting) -> None:
        self.schedule = SensorSchedule(config, seed, "pattern")
        self._rng = named_rng(seed, "pattern")
        chain = named_rng(seed, "pattern dropouts")
        share = float(chain.uniform(*config.dropout_share_range))
        self._dropouts = Dropouts(chain, share=share, mean_s=config.dropout_mean_s)
        self._config = config
        self._mounting = mounting

    def sample(self, vehicle: VehicleState, drone: BodyTruth, elapsed_s: float) -> PadSighting | None:
        """Return the sighting at the drone's own time, to which the vehicle is carried by its velocity."""
        errors = self._rng.standard_normal(6).tolist()
        hidden = self._dropouts.step(elapsed_s)
        age_s = (vehicle.t_ns - drone.t_ns) * 1e-9
        pad_enu_m = rotate(vehicle.orientation_wxyz, (0.0, 0.0, self._mounting.pad_height_m))
        moved_m = scaled(vehicle.velocity_enu_m_s, -age_s)
        away_enu_m = total(vehicle.position_enu_m, pad_enu_m, moved_m, scaled(drone.position_enu_m, -1.0))
        away_flu_m = rotate(conjugate(drone.orientation_wxyz), away_enu_m)
        if hidden or age_s > _DRONE_AGE_MAX_S or not self._sees(away_flu_m):
            return None
        std_m = self._config.range_share * math.hypot(*away_flu_m) + self._config.white_m
        turn = small_turn(scaled((errors[3], errors[4], errors[5]), self._config.white_rad))
        attitude = multiply(conjugate(drone.orientation_wxyz), vehicle.orientation_wxyz)
        return PadSighting(
            t_ns=drone.t_ns,
            position_flu_m=total(away_flu_m, scaled((errors[0], errors[1], errors[2]), std_m)),
            orientation_wxyz=canonical(multiply(attitude, turn)),
            position_covariance_m2=diagonal(std_m**2),
        )

    def _sees(self, away_flu_m: Vector3) -> bool:
        range_m = math.hypot(*away_flu_m)
        if not self._config.range_min_m <= range_m <= self._config.range_max_m:
            return False
        return -away_flu_m[2] >= range_m * math.cos(self._config.half_field_of_view_rad)


class Detector(Protocol):
    """What sees the pad from the drone."""

    schedule: SensorSchedule

    def sample(self, vehicle: VehicleState, drone: BodyTruth, elapsed_s: float) -> PadSighting | None:
        """Return the sighting at the drone's own time, `elapsed_s` after the sample before; None if it is not seen."""


class SensorSuite:
    """All sensors of a scenario, and the samples that are under way; `detector` is in place of the noise model."""

    def __init__(
        self,
        config: SensorsConfig,
        seed: Seed,
        *,
        mounting: Mounting,
        datum: Datum,
        detector: Detector | None = None,
    ) -> None:
        self._queue: list[tuple[int, int, Sample]] = []
        self._count = 0
        self._clock: StampClock | None = None
        clock = named_rng(seed, "clock").uniform(-1.0, 1.0, 2).tolist()
        self._offset_s, self._drift = clock[0] * config.clock.offset_max_s, clock[1] * config.clock.drift_max
        angle_rad = float(named_rng(seed, "frame offset").uniform(0.0, 2.0 * math.pi))
        offset_enu_m = (config.frame_offset_m * math.cos(angle_rad), config.frame_offset_m * math.sin(angle_rad), 0.0)
        self._fix = _FixSensor(config.fix, seed, mounting=mounting, offset_enu_m=offset_enu_m, datum=datum)
        self._on_vehicle: list[_FixSensor | _VelocitySensor | InertialUnit] = [self._fix]
        if config.velocity is not None:
            self._on_vehicle.append(_VelocitySensor(config.velocity, seed, mounting=mounting))
        if config.imu is not None:
            self._on_vehicle.append(InertialUnit(config.imu, seed))
        self._pattern = detector
        if detector is None and config.pattern is not None:
            self._pattern = _PatternSensor(config.pattern, seed, mounting=mounting)

    def set_clock(self, ahead_s: float) -> None:
        """Set the vehicle's clock ahead by `ahead_s`: what is taken from now on is stamped by it."""
        self._offset_s += ahead_s
        if self._clock is not None:
            self._clock = replace(self._clock, offset_s=self._offset_s)

    def slide_fixes(self, by_enu_m_s: Vector3) -> None:
        """Let the fixes slide away from now on, as of a receiver that is led astray; its velocities stay true."""
        self._fix.slide_enu_m_s = by_enu_m_s

    def step(self, t_ns: int, vehicle: VehicleState, drone: BodyTruth | None) -> list[Sample]:
        """Take the samples that are due at `t_ns` and return those that leave by then, in the order of leaving."""
        if self._clock is None:
            self._clock = StampClock(start_ns=t_ns, offset_s=self._offset_s, drift=self._drift)
        for sensor in self._on_vehicle:
            if sensor.schedule.due(t_ns):
                elapsed_s = sensor.schedule.take(t_ns)
                sample = sensor.sample(self._clock.stamp_ns(t_ns), vehicle, elapsed_s)
                self._send(sensor.schedule, t_ns, sample)
        if self._pattern is not None and drone is not None and self._pattern.schedule.due(t_ns):
            elapsed_s = self._pattern.schedule.take(t_ns)
            self._send(self._pattern.schedule, t_ns, self._pattern.sample(vehicle, drone, elapsed_s))
        released: list[Sample] = []
        while self._queue and self._queue[0][0] <= t_ns:
            released.append(heapq.heappop(self._queue)[2])
        return released

    def _send(self, schedule: SensorSchedule, t_ns: int, sample: Sample | None) -> None:
        release_ns = schedule.release_ns(t_ns)
        if sample is not None and release_ns is not None:
            heapq.heappush(self._queue, (release_ns, self._count, sample))
            self._count += 1
