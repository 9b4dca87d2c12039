"""How much a body sways whose vehicle does not tell its tilt, learnt from how its antenna moves; pure.

Heave, roll and pitch are states of the filter, damped oscillators (`imm_swing`). Where no inertial unit tells them,
what sways an antenna would be taken for driving: on a lorry's roof 0.15 m/s twice a second, as if it braked by 2 m/s^2.
And the grade of a smooth road that begins to climb would be taken for a heave, which soon swings back. Frequency and
damping are those of a body on wheels; how much it sways depends on the road, and is learnt. By the law of total
variance that of a rate is the mean of its square as far as it is known, and of what is left unknown. So a sway that
nothing shows stays as it was taken to be. Of a wrong variance only that share shows by which a rate is known at all, so
the step is as much larger. Nor does it show a sway that the models of driving explain: it is at least as
large as the velocities themselves go to and fro (`to_and_fro`).
Source: Shumway and Stoffer 1982, the EM algorithm for state-space models, with what is known at once.
"""

import math

import numpy as np
from msgspec import Struct

from companion.config.estimation import ImmConfig, SwayConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.deck_motion import MEMORY_S
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_swing import HEAVE_RATE, PITCH_RATE, ROLL_RATE
from companion.vehicle.to_and_fro import ToAndFro, least_variances_m2_s2, passed, watch
from link.records import replace

_GAP_MAX_S = 1.0  # of velocities, after which the filter knows of no sway any more
_SHOWS_MIN = 0.1  # of a wrong variance; what shows less is all chance
_ANTENNA_MIN_M = 0.5  # above the axis of roll: a lower one hardly moves as the body tilts
_RATE_STDS_MIN = (0.003, 0.003, 0.01)  # rad/s and m/s: less moves an antenna 4 m up by a centimetre a second


class BodySway(Struct, frozen=True, kw_only=True):
    """What has been learnt.

    Attributes:
        rate_variances_rad2_s2: of roll and of pitch.
        heave_rate_variance_m2_s2: of the heave.
        seen_s: for how long they were watched, what is longer ago counting less.
        antenna: how much it goes to and fro.
    """

    rate_variances_rad2_s2: tuple[float, float]
    heave_rate_variance_m2_s2: float
    seen_s: float
    antenna: ToAndFro = ToAndFro()


def first_sway(config: SwayConfig) -> BodySway:
    """Return what is taken for granted of a body that has not been watched."""
    variance = (config.tilt_std_rad * _frequency_rad_s(config)) ** 2
    return BodySway(
        rate_variances_rad2_s2=(variance, variance),
        heave_rate_variance_m2_s2=(config.heave_std_m * _frequency_rad_s(config)) ** 2,
        seen_s=config.prior_s,
    )


def learn_sway(sway: BodySway, modes: Modes, dt_s: float, config: ImmConfig) -> BodySway:
    """Return the sway after a reading of place or velocity; only of a vehicle that drives.

    Args:
        sway: so far.
        modes: of the filter, after the reading.
        dt_s: since the reading before.
        config: of the filter.
    """
    means, covariances, weights = modes
    speed_m_s = math.hypot(*(weights @ means[:, 2:4]).tolist())
    if not 0.0 < dt_s < _GAP_MAX_S or speed_m_s < config.heading.curvature_speed_min_m_s:
        return sway
    seen_s = sway.seen_s * math.exp(-dt_s / MEMORY_S) + dt_s
    kept = (*sway.rate_variances_rad2_s2, sway.heave_rate_variance_m2_s2)
    learnt = (
        _learnt(before, float(weights @ means[:, i] ** 2), float(weights @ covariances[:, i, i]), dt_s / seen_s)
        for i, before in zip((ROLL_RATE, PITCH_RATE, HEAVE_RATE), kept, strict=True)
    )
    roll, pitch, heave = (max(one, least**2) for one, least in zip(learnt, _RATE_STDS_MIN, strict=True))
    return BodySway(
        rate_variances_rad2_s2=(roll, pitch),
        heave_rate_variance_m2_s2=heave,
        seen_s=seen_s,
        antenna=sway.antenna,
    )


def widen_sway(sway: BodySway, reading: Measurement, dt_s: float, antenna_m: float, config: ImmConfig) -> BodySway:
    """Return the sway, at least as large as the antenna of a vehicle that drives goes to and fro.

    Args:
        sway: so far.
        reading: of place or velocity.
        dt_s: since the reading before.
        antenna_m: its height above the axis of roll.
        config: of the filter.
    """
    antenna = passed(sway.antenna, dt_s)
    if reading.quantity is Quantity.VELOCITY and antenna_m > _ANTENNA_MIN_M:
        east_m_s, north_m_s, _ = reading.value.tolist()
        if math.hypot(east_m_s, north_m_s) > config.heading.curvature_speed_min_m_s:
            antenna = watch(antenna, reading.value, reading.covariance, math.pi / _frequency_rad_s(config.sway))
    if antenna is sway.antenna:
        return sway
    along, across = least_variances_m2_s2(antenna)
    roll, pitch = sway.rate_variances_rad2_s2
    least = (max(roll, across / antenna_m**2), max(pitch, along / antenna_m**2)) if antenna_m > 0.0 else (roll, pitch)
    return replace(sway, antenna=antenna, rate_variances_rad2_s2=least)


def _learnt(before: float, known: float, unknown: float, weight: float) -> float:
    """Return the variance of a rate after another reading: the square of what is known counts, and what is not."""
    shows = max(1.0 - unknown / before, _SHOWS_MIN)
    return before + min(weight / shows, 1.0) * (known + unknown - before)


def sway_variances(sway: BodySway, config: SwayConfig) -> Array:
    """Return the variances (4,) of roll, its rate, pitch and its rate, rad^2 and rad^2/s^2."""
    (roll, pitch), w = sway.rate_variances_rad2_s2, _frequency_rad_s(config)
    return np.array([roll / w**2, roll, pitch / w**2, pitch])


def sway_oscillators(sway: BodySway, config: SwayConfig) -> Array:
    """Return angular frequency, rad/s, damping and standard deviation of the heave's rate, of roll and pitch, (9,)."""
    w, heave_m_s = _frequency_rad_s(config), math.sqrt(sway.heave_rate_variance_m2_s2)
    roll, pitch = (math.sqrt(variance) / w for variance in sway.rate_variances_rad2_s2)
    return np.array([w, config.damping, heave_m_s, w, config.damping, roll, w, config.damping, pitch])


def _frequency_rad_s(config: SwayConfig) -> float:
    return 2.0 * math.pi * config.frequency_hz
