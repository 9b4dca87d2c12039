"""A configuration of the interacting models as their kernels take it: plain arrays, derived once."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from companion.config.estimation import (
    BrakingConfig,
    EasingConfig,
    ImmConfig,
    RampConfig,
    SteadyConfig,
    SwingConfig,
    TurningConfig,
)
from companion.core.data import Array
from companion.vehicle.deck_motion import rate_std_m_s
from companion.vehicle.imm_kernels import CURVATURE, UNKNOWN_HEADING_VARIANCE
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_noise import (
    ACROSS_NOISE,
    ALONG_NOISE,
    CLOCK_NOISE,
    CURVATURE_STD,
    HEADING_AT_REST,
    HEADING_NOISE,
    OWN_NOISE,
    OWN_RATE_NOISE,
    RECEIVER_NOISE,
    UNIT_NOISE,
)
from link.messages import PadGeometry, Vector3

STEADY, EASING, BRAKING, TURNING, RAMP = range(5)
"""The models in their order."""
Bounds = tuple[float, float]
_STEADY_SHARE_MAX = 0.1  # of a manoeuvre's noise: a steady model as wide would be none, and the two not told apart
CAR_CURVATURE_MAX_RAD_M = 1.0 / 3.5  # the smallest turning circle of a car is 7 m across
ON_THE_SPOT_RAD_M = 10.0  # 1 rad/s while the middle moves at 0.1 m/s


@dataclass(frozen=True, slots=True, kw_only=True)
class Deck:
    """Where the pad is on the vehicle, as it tells it.

    Attributes:
        antenna_to_pad_m: lever arm in V.
        pad_height_m: above the road or the water, about which the body is taken to tilt.
        half_width_m: of the pad, from its centre to the nearest edge; 0 until it is told.
        is_afloat: it floats.
    """

    antenna_to_pad_m: Vector3 = (0.0, 0.0, 0.0)
    pad_height_m: float = 0.0
    half_width_m: float = 0.0
    is_afloat: bool = False


def deck_of(pad: PadGeometry) -> Deck:
    """Return the deck that `pad` is on."""
    return Deck(
        antenna_to_pad_m=pad.antenna_to_pad_m,
        pad_height_m=pad.height_m,
        half_width_m=0.5 * min(pad.size_m),
        is_afloat=pad.is_afloat,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Numbers:
    """A configuration as the kernels take it.

    Attributes:
        motion: (18,) as `imm_mixing` has it.
        begins_after_s: (n,) of the modes, as `imm_mixing.switching` takes it.
        noises: (n, 18) as `imm_noise.process_noise` takes them, but for what depends on the state (`noises_with`).
        is_steady: (2, n) whether each mode is steady along the track, and across it.
        steady_m2_s5: how fast a steady driver's, or helm's, accelerations along the track and across it walk: the
            ordinary one's, and at most.
        lever_m: (4,) from the antenna to the pad in V, and the pad's height above the axis of roll.
        prior_variances: (26,) of every state but position, offset and clock, when nothing else is known.
        courses: (4,) as `imm_judgement.align_modes` takes it, while no sensor tells the heading, and while one does.
    """

    motion: Array
    begins_after_s: Array
    noises: Array
    is_steady: Array
    steady_m2_s5: tuple[Bounds, Bounds]
    lever_m: Array
    prior_variances: Array
    courses: tuple[Array, Array]


def swing_of(config: ImmConfig, *, is_afloat: bool) -> SwingConfig:
    """Return how a deck swings that has not been watched, on the water or on a road."""
    return config.afloat if is_afloat else config.on_road


def numbers_of(config: ImmConfig, deck: Deck) -> Numbers:
    """Return the numbers of `config` for a pad on `deck`."""
    swing = swing_of(config, is_afloat=deck.is_afloat)
    heave = (2.0 * math.pi * swing.heave.frequency_hz, swing.heave.damping, rate_std_m_s(swing.heave))
    level = (2.0 * math.pi * swing.tilt.frequency_hz, swing.tilt.damping, 0.0)  # until it is told
    lever_m = (*deck.antenna_to_pad_m, deck.pad_height_m)
    modes, heading = _modes(config), config.heading
    # Wind and current set a vessel: at no speed does its course tell where it points.
    least_m_s = math.inf if deck.is_afloat else heading.course_speed_min_m_s
    course = (least_m_s, heading.course_std_rad**2, heading.known_std_rad**2)
    return Numbers(
        motion=np.array(
            [
                config.acceleration_decay_s,
                *heave,
                config.receivers.clock_time_s,
                *lever_m,
                config.road.gravity_leak_time_s,
                *level,
                *level,
                config.receivers.own_height_rate_time_s,
                config.heading.unit_error_time_s,
            ]
        ),
        begins_after_s=np.array([mode.begins_after_s for mode in modes]),
        noises=np.array([_noise(config, mode, is_afloat=deck.is_afloat) for mode in modes]),
        is_steady=np.array([_is_steady(config, name) for name in ("jerk_psd_m2_s5", "lateral_acceleration_psd_m2_s5")]),
        steady_m2_s5=(
            _bounds(config.steady.jerk_psd_m2_s5, config.easing.jerk_psd_m2_s5),
            _bounds(
                config.helm_psd_m2_s5 if deck.is_afloat else config.steady.lateral_acceleration_psd_m2_s5,
                config.turning.lateral_acceleration_psd_m2_s5,
            ),
        ),
        lever_m=np.array(lever_m),
        prior_variances=_prior_variances(config, is_afloat=deck.is_afloat),
        courses=(np.array([*course, 0.0]), np.array([*course, 1.0])),
    )


def _bounds(ordinary_m2_s5: float, manoeuvre_m2_s5: float) -> Bounds:
    return ordinary_m2_s5, max(ordinary_m2_s5, _STEADY_SHARE_MAX * manoeuvre_m2_s5)


@lru_cache(maxsize=4)  # without sightings it changes with a fix's stated error, and with every pair of `steady_driving`
def noises_with(
    numbers: Numbers,
    wandering: tuple[float, float, float],
    psd_m2_s5: tuple[float, float],
    unit_rad2_s: float,
    *,
    turn_is_measured: bool,
) -> Array:
    """Return the modes' noise (n, 18) with what depends on the state.

    `wandering` is as `imm_frames.wandering` returns it. `psd_m2_s5` is how fast the accelerations along the track and
    across it walk while nothing new begins, `unit_rad2_s` how fast what the unit tells of the heading too much does.

    Where the drone's own place does not wander, fixes have corrections, and are dated without an error.
    A vehicle whose turning is measured may be one that turns on the spot. Any other is taken for a car: it turns no
    tighter than a car steers, and not at all while it stands.
    """
    noises = numbers.noises.copy()
    noises[:, [RECEIVER_NOISE, OWN_NOISE, OWN_RATE_NOISE]] = wandering
    noises[:, UNIT_NOISE] = unit_rad2_s
    noises[numbers.is_steady[0], ALONG_NOISE], noises[numbers.is_steady[1], ACROSS_NOISE] = psd_m2_s5
    if not wandering[1]:
        noises[:, CLOCK_NOISE] = 0.0
    if turn_is_measured:
        noises[:, CURVATURE_STD] = ON_THE_SPOT_RAD_M
        noises[:, HEADING_AT_REST] = noises[:, HEADING_NOISE]
    return noises


def turns_as_modelled(modes: Modes, *, turn_is_measured: bool) -> bool:
    """Return whether the heading that fits the course is the vehicle's: none that turns tighter than a car is a car."""
    means, _, weights = modes
    return turn_is_measured or abs(float(weights @ means[:, CURVATURE])) < CAR_CURVATURE_MAX_RAD_M


def _prior_variances(config: ImmConfig, *, is_afloat: bool) -> Array:
    swing = swing_of(config, is_afloat=is_afloat)
    speed, acceleration = config.initial_speed_std_m_s**2, config.initial_acceleration_std_m_s2**2
    heave_rate = rate_std_m_s(swing.heave) ** 2
    heave_change = heave_rate * (2.0 * math.pi * swing.heave.frequency_hz) ** 2
    curvature = config.heading.curvature_std_rad_m**2
    moving = [speed, speed, acceleration, acceleration, curvature, UNKNOWN_HEADING_VARIANCE]
    grade, bend = (0.0, 0.0) if is_afloat else (config.road.grade_std**2, config.steady.bend_std_per_m**2)
    vertical = [0.0, grade, heave_rate, heave_change]
    tilt = swing.tilt.std**2
    tilting = [tilt, tilt * (2.0 * math.pi * swing.tilt.frequency_hz) ** 2]
    driven = [bend, config.road.gravity_leak_std_m_s2**2, *tilting, *tilting, 0.0, 0.0, 0.0, 0.0]
    return np.array([0.0, 0.0, *moving, *vertical, 0.0, 0.0, 0.0, 0.0, *driven])


def _modes(config: ImmConfig) -> tuple[SteadyConfig, ...]:
    """Return the steady model, and one for each manoeuvre, which is steady but for what its configuration names."""
    return (config.steady, *(config.steady.model_copy(update=dict(one)) for one in _manoeuvres(config)))


def _manoeuvres(config: ImmConfig) -> tuple[EasingConfig | BrakingConfig | TurningConfig | RampConfig, ...]:
    return config.easing, config.braking, config.turning, config.ramp


def _is_steady(config: ImmConfig, name: str) -> list[bool]:
    """Return which modes have the steady one's `name`."""
    return [True, *(name not in type(one).model_fields for one in _manoeuvres(config))]


def _noise(config: ImmConfig, mode: SteadyConfig, *, is_afloat: bool) -> tuple[float, ...]:
    """Return one mode's noise; water has no grades."""
    return (
        mode.jerk_psd_m2_s5,
        config.side_jerk_psd_m2_s5,
        mode.lateral_acceleration_psd_m2_s5,
        config.heading.curvature_speed_min_m_s,
        config.heading.psd_rad2_s,
        0.0 if is_afloat else mode.bend_std_per_m,
        0.0,
        0.0,
        2.0 * config.receivers.clock_std_s**2 / config.receivers.clock_time_s,
        config.heading.curvature_std_rad_m,
        0.0,
        mode.bend_acceleration_std_m_s2,
        config.road.bend_length_m,
        0.0 if is_afloat else config.road.height_psd_m2_m,
        2.0 * config.road.gravity_leak_std_m_s2**2 / config.road.gravity_leak_time_s,
        float(is_afloat),
        0.0,
        0.0,
    )
