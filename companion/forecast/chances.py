"""From the samples' contacts to the forecast: how likely each tier is, and which limit would be missed; pure."""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from companion.forecast.samples import CONTACT, ERROR, IN_S, SINK, SPEED, TILT
from link.messages import ContactForecast


class ContactLimits(Struct, frozen=True, kw_only=True):
    """The largest values against the deck; the tilt is beyond that of steady flight through the same air."""

    horizontal_error_m: float
    relative_speed_m_s: float
    sink_rate_m_s: float
    tilt_over_trim_rad: float


S1 = ContactLimits(
    horizontal_error_m=0.50, relative_speed_m_s=1.0, sink_rate_m_s=1.0, tilt_over_trim_rad=math.radians(15.0)
)
"""Beyond these a contact is unsafe."""

S2 = ContactLimits(
    horizontal_error_m=0.30, relative_speed_m_s=0.5, sink_rate_m_s=0.7, tilt_over_trim_rad=math.radians(10.0)
)


_MEASURES = (ERROR, SPEED, SINK, TILT)


def sum_up(ends: Array, weight: Array, room_m: float) -> ContactForecast:
    """Return the forecast.

    Args:
        ends: (n, 6) of the samples, as `rollout.roll_out` has them.
        weight: (n,) probabilities.
        room_m: from the pad's centre, within which what is touched is the pad.
    """
    lands = ends[:, CONTACT] > 0.0
    beyond = _excess(ends, S1, room_m)
    within_s1 = lands & (beyond <= 1.0).all(axis=1)
    within_s2 = lands & (_excess(ends, S2, room_m) <= 1.0).all(axis=1)
    is_unsafe = lands & ~within_s1
    worst = np.argmax(beyond, axis=1)
    missed = [_sum(weight[is_unsafe & (worst == place)]) for place in range(len(_MEASURES))]
    landed = float(weight[lands].sum())
    return ContactForecast(
        in_s=float(weight[lands] @ ends[lands, IN_S]) / landed if landed > 0.0 else None,
        s1=_sum(weight[within_s1]),
        s2=_sum(weight[within_s2]),
        unsafe=_sum(weight[is_unsafe]),
        broken_off=max(1.0 - landed, 0.0),
        misses_position=missed[0],
        misses_speed=missed[1],
        misses_sink=missed[2],
        misses_tilt=missed[3],
    )


def _sum(weight: Array) -> float:
    """Return a probability; rounding may have made it more than one."""
    return min(float(weight.sum()), 1.0)


def _excess(ends: Array, limits: ContactLimits, room_m: float) -> Array:
    """Return by how many times of its limit each measure goes, (n, 4)."""
    most = [
        min(limits.horizontal_error_m, room_m),
        limits.relative_speed_m_s,
        limits.sink_rate_m_s,
        limits.tilt_over_trim_rad,
    ]
    return np.asarray(ends[:, _MEASURES] / np.array(most))
