"""How much a body sways whose vehicle does not tell its tilt, learnt from how its antenna moves; pure.

Heave, roll and pitch are states of the filter, damped oscillators (`imm_swing`). Where no inertial unit tells them,
what sways an antenna would be taken for driving: on a lorry's roof 0.15 m/s twice a second, as if it braked by 2 m/s^2.
And the grade of a smooth road that begins to climb would be taken for a heave, which soon swings back. Damping is that
of a body on wheels; how much it sways depends on the road, and is learnt. By the law of total
variance that of a rate is the mean of its square as far as it is known, and of what is left unknown. So a sway that
nothing shows stays as it was taken to be. Of a wrong variance only that share shows by which a rate is known at all, so
the step is as much larger. Nor does it show a sway that the models of driving explain: it is at least as
large as the velocities themselves go to and fro, and as slow (`to_and_fro`).
Source: Shumway and Stoffer 1982, the EM algorithm for state-space models, with what is known at once.
"""

import math
from functools import lru_cache

import numpy as np
from msgspec import Struct

from companion.config.estimation import ImmConfig, SwayConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.deck_motion import MEMORY_S
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_swing import HEAVE_RATE, PITCH_RATE, ROLL_RATE
from companion.vehicle.to_and_fro import Shown, ToAndFro, passed, watch

_GAP_MAX_S = 1.0  # of velocities, after which the filter knows of no sway any more
_SHOWS_MIN = 0.1  # of a wrong variance; what shows less is all chance
_ANTENNA_MIN_M = 0.5  # above the axis of roll: a lower one hardly moves as the body tilts
_PERIODS_APART = 1.25  # a damping of 0.3 takes no notice of less
_RATE_STDS_MIN = (0.01, 0.003, 0.003)  # m/s and rad/s: less moves an antenna 4 m up by a centimetre a second


class Swing(Struct, frozen=True, kw_only=True):
    """One of the body's oscillators.

    Attributes:
        rate_variance: of its rate, rad^2/s^2; of the heave's m^2/s^2.
        frequency_rad_s: at which it swings.
    """

    rate_variance: float
    frequency_rad_s: float

    def oscillator(self, damping: float) -> tuple[float, float, float]:
        """Return angular frequency, rad/s, damping and standard deviation, rad."""
        return self.frequency_rad_s, damping, math.sqrt(self.rate_variance) / self.frequency_rad_s


class BodySway(Struct, frozen=True, kw_only=True):
    """What has been learnt.

    Attributes:
        heave: of the pad.
        roll: of the body.
        pitch: of the body.
        seen_s: for how long all three were watched; what is longer ago counts less.
        antenna: how much it goes to and fro.
    """

    heave: Swing
    roll: Swing
    pitch: Swing
    seen_s: float
    antenna: ToAndFro = ToAndFro()


def first_sway(config: SwayConfig) -> BodySway:
    """Return what is taken for granted of a body that has not been watched."""
    w = 2.0 * math.pi * config.frequency_hz
    tilt = Swing(rate_variance=(config.tilt_std_rad * w) ** 2, frequency_rad_s=w)
    heave = Swing(rate_variance=(config.heave_std_m * w) ** 2, frequency_rad_s=w)
    return BodySway(heave=heave, roll=tilt, pitch=tilt, seen_s=config.prior_s)


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
    heave, roll, pitch = (
        _learnt(swing, float(weights @ means[:, i] ** 2), float(weights @ covariances[:, i, i]), dt_s / seen_s, least)
        for i, swing, least in zip(
            (HEAVE_RATE, ROLL_RATE, PITCH_RATE), (sway.heave, sway.roll, sway.pitch), _RATE_STDS_MIN, strict=True
        )
    )
    return BodySway(heave=heave, roll=roll, pitch=pitch, seen_s=seen_s, antenna=sway.antenna)


def _learnt(swing: Swing, known: float, unknown: float, weight: float, least: float) -> Swing:
    """Return a swing after another reading: the square of what is known of its rate counts, and what is not.

    Args:
        swing: so far.
        known: square of the rate's mean.
        unknown: its variance.
        weight: of the reading among all.
        least: standard deviation of the rate.
    """
    before = swing.rate_variance
    shows = max(1.0 - unknown / before, _SHOWS_MIN)
    variance = before + min(weight / shows, 1.0) * (known + unknown - before)
    return Swing(rate_variance=max(variance, least**2), frequency_rad_s=swing.frequency_rad_s)


def widen_sway(sway: BodySway, reading: Measurement, dt_s: float, antenna_m: float, config: ImmConfig) -> BodySway:
    """Return the sway, at least as large as the antenna of a vehicle that drives goes to and fro, and then as slow.

    Args:
        sway: so far.
        reading: of place or velocity.
        dt_s: since the reading before.
        antenna_m: its height above the axis of roll.
        config: of the filter.
    """
    half_periods_s = _half_periods_s(config.sway.frequency_min_hz, config.sway.frequency_hz)
    antenna = passed(sway.antenna, dt_s)
    if reading.quantity is Quantity.VELOCITY:
        east_m_s, north_m_s, _ = reading.value.tolist()
        if math.hypot(east_m_s, north_m_s) > config.heading.curvature_speed_min_m_s:
            antenna = watch(antenna, reading.value, reading.covariance, half_periods_s)
    if antenna is sway.antenna:
        return sway
    heave, roll, pitch = _widened(sway.heave, antenna.up, 1.0, half_periods_s), sway.roll, sway.pitch
    if antenna_m > _ANTENNA_MIN_M:
        roll = _widened(roll, antenna.across, antenna_m, half_periods_s)
        pitch = _widened(pitch, antenna.along, antenna_m, half_periods_s)
    return BodySway(heave=heave, roll=roll, pitch=pitch, seen_s=sway.seen_s, antenna=antenna)


def _widened(swing: Swing, shown: Shown, arm_m: float, half_periods_s: tuple[float, ...]) -> Swing:
    """Return the swing with at least the variance that is shown at the end of an arm, and its period if that is most.

    An arm of 1 m stands for none.
    """
    variance = shown.variance_m2_s2 / arm_m**2
    if variance < 0.5 * swing.rate_variance:
        return swing
    w = math.pi / half_periods_s[shown.period]
    return Swing(rate_variance=max(swing.rate_variance, variance), frequency_rad_s=w)


@lru_cache(maxsize=4)
def _half_periods_s(longest_hz: float, shortest_hz: float) -> tuple[float, ...]:
    """Return half the periods (k,) that a body may sway with, rising."""
    count = 1 + int(math.log(shortest_hz / longest_hz) / math.log(_PERIODS_APART))
    return tuple(0.5 / shortest_hz * _PERIODS_APART**i for i in range(count))


def sway_variances(sway: BodySway) -> Array:
    """Return the variances (4,) of roll, its rate, pitch and its rate, rad^2 and rad^2/s^2."""
    roll, pitch = sway.roll, sway.pitch
    return np.array(
        [
            roll.rate_variance / roll.frequency_rad_s**2,
            roll.rate_variance,
            pitch.rate_variance / pitch.frequency_rad_s**2,
            pitch.rate_variance,
        ]
    )


def sway_oscillators(sway: BodySway, config: SwayConfig) -> Array:
    """Return angular frequency, rad/s, damping and standard deviation of the heave's rate, of roll and pitch, (9,)."""
    heave, (roll, pitch) = sway.heave, (one.oscillator(config.damping) for one in (sway.roll, sway.pitch))
    heaves = (heave.frequency_rad_s, config.damping, math.sqrt(heave.rate_variance))
    return np.array([*heaves, *roll, *pitch])
