"""A configuration of the interacting models as their kernels take it: plain arrays, derived once."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from companion.config.estimation import ImmConfig, ImmModeConfig
from companion.core.data import Array
from companion.vehicle.imm_kernels import CLOCK_NOISE, CURVATURE_STD, HEADING_AT_REST, HEADING_NOISE
from link.messages import Vector3

UNKNOWN_HEADING_VARIANCE = math.pi**2 / 3.0  # of an angle that may be anything
ON_THE_SPOT_RAD_M = 10.0  # 1 rad/s while the middle moves at 0.1 m/s


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Numbers:
    """A configuration as the kernels take it.

    Attributes:
        motion: (9,) as `imm_mixing` has it.
        dwell_s: (2,) of both modes.
        noises: (2, 15) as `imm_kernels.process_noise` takes them, but for what depends on the state (`noises_with`).
        lever_m: (3,) from the antenna to the pad in V.
        prior_variances: (18,) of every state but position, offset and clock, when nothing else is known.
        course: (3,) as `imm_judgement.take_reading` takes it.
    """

    motion: Array
    dwell_s: Array
    noises: Array
    lever_m: Array
    prior_variances: Array
    course: Array


def numbers_of(config: ImmConfig, antenna_to_pad_m: Vector3) -> Numbers:
    """Return the numbers of `config` with the lever arm (3,) in V from the antenna to the pad, m."""
    heave = (2.0 * math.pi * config.heave.frequency_hz, config.heave.damping, config.heave.std_m)
    modes, heading = (config.steady, config.manoeuvre), config.heading
    return Numbers(
        motion=np.array(
            [
                config.acceleration_decay_s,
                *heave,
                config.receivers.clock_time_s,
                *antenna_to_pad_m,
                config.road.gravity_leak_time_s,
            ]
        ),
        dwell_s=np.array([mode.dwell_s for mode in modes]),
        noises=np.array([_noise(config, mode) for mode in modes]),
        lever_m=np.array(antenna_to_pad_m),
        prior_variances=_prior_variances(config),
        course=np.array([heading.course_speed_min_m_s, heading.course_std_rad**2, heading.known_std_rad**2]),
    )


@lru_cache(maxsize=4)  # it changes with a fix's stated error only
def noises_with(numbers: Numbers, receiver_m2_s: float, own_m2_s: float, *, turn_is_measured: bool) -> Array:
    """Return both modes' noise (2, 15) with the wandering of the vehicle's receiver and of the drone's own place.

    Where the drone's own place does not wander, fixes have corrections, and are dated without an error.
    A vehicle whose turning is measured may be one that turns on the spot. Any other is taken for a car: it turns no
    tighter than a car steers, and not at all while it stands.
    """
    noises = numbers.noises.copy()
    noises[:, 6], noises[:, 7] = receiver_m2_s, own_m2_s
    if not own_m2_s:
        noises[:, CLOCK_NOISE] = 0.0
    if turn_is_measured:
        noises[:, CURVATURE_STD] = ON_THE_SPOT_RAD_M
        noises[:, HEADING_AT_REST] = noises[:, HEADING_NOISE]
    return noises


def _prior_variances(config: ImmConfig) -> Array:
    speed, acceleration = config.initial_speed_std_m_s**2, config.initial_acceleration_std_m_s2**2
    heave = config.heave.std_m**2
    heave_rate = heave * (2.0 * math.pi * config.heave.frequency_hz) ** 2
    curvature = config.heading.curvature_std_rad_m**2
    moving = [speed, speed, acceleration, acceleration, curvature, UNKNOWN_HEADING_VARIANCE]
    vertical = [0.0, config.road.grade_std**2, heave, heave_rate]
    driven = [config.road.bend_std_per_m**2, config.road.gravity_leak_std_m_s2**2]
    return np.array([0.0, 0.0, *moving, *vertical, 0.0, 0.0, 0.0, 0.0, *driven])


def _noise(config: ImmConfig, mode: ImmModeConfig) -> tuple[float, ...]:
    return (
        mode.jerk_psd_m2_s5,
        config.side_jerk_psd_m2_s5,
        mode.lateral_acceleration_psd_m2_s5,
        config.heading.curvature_speed_min_m_s,
        config.heading.psd_rad2_s,
        config.road.bend_std_per_m,
        0.0,
        0.0,
        2.0 * config.receivers.clock_std_s**2 / config.receivers.clock_time_s,
        config.heading.curvature_std_rad_m,
        0.0,
        config.road.bend_acceleration_std_m_s2,
        config.road.bend_length_m,
        config.road.height_psd_m2_m,
        2.0 * config.road.gravity_leak_std_m_s2**2 / config.road.gravity_leak_time_s,
    )
