"""What the vehicle of each sample does: its branch, when it begins, how hard, and with which weight; pure.

How hard is heavy-tailed: as hard as what this driver has done, or as the domain's drivers (`scenarios/worlds/odd.toml`,
where the sources stand): decelerations to stops and behind others of 2.5 +- 0.7 m/s^2, beside hard brakes of 4.5 to 9,
accelerations of 1.6 +- 0.5, and to the side 2.3 +- 0.7 in bends, within what a clothoid takes.
"""

import numpy as np
from msgspec import Struct
from scipy.special import ndtr, ndtri

from companion.core.data import Array
from companion.forecast.draws import Draws
from companion.forecast.drivers import DEPARTS, SLOWS, SPEEDS_UP, TURNS, Drivers, chances
from companion.forecast.samples import ALONG, ASIDE, STEADY, IndexArray

NOTHING, SLOWER, FASTER, TURN = range(4)
_KINDS = np.array([STEADY, ALONG, ALONG, ASIDE])
_HARD_SHARE = 0.12  # of the events that slow down: 2 of 16 in town, 2 of 14 in the country
_SEEN_SPREAD = 0.3  # of the logarithm: one driver's brakes differ by that, a choice
_RELEASED_S = 3.0  # mean time that an acceleration lasts: the estimator's `acceleration_decay_s`
_BRAKE_RAMP_S = 0.1  # brake pressure is there in a tenth of a second or two
_TURN_RAMP_S = (0.3, 3.0)  # a clothoid of A = R / 3 to R at what bends take of grip
_CURVATURE_MAX_PER_M = 0.15  # of a car's tightest turn
_LEVELS = np.linspace(0.001, 0.999, 400)


def _quantiles(mean: float, std: float, low: float, high: float) -> Array:
    """Return those of a truncated normal distribution at `_LEVELS`."""
    first, last = ndtr([(low - mean) / std, (high - mean) / std])
    return np.asarray(mean + std * ndtri(first + _LEVELS * (last - first)))


_COMFORTABLE_M_S2 = _quantiles(2.5, 0.7, 1.0, 4.5)
_FASTER_M_S2 = _quantiles(1.6, 0.5, 0.7, 3.0)
_ASIDE_M_S2 = _quantiles(2.3, 0.7, 0.4, 5.0)


class Events(Struct, frozen=True, kw_only=True, eq=False):
    """Of n samples.

    Attributes:
        kind: (n,) as `samples.Samples` has it.
        event: (n, 4) what happens, as `samples.Samples` has it.
        weight: (n,) probabilities, which make one.
    """

    kind: IndexArray
    event: Array
    weight: Array


def make_events(
    numbers: Draws,
    drivers: Drivers,
    *,
    within_s: float,
    unseen_s: float,
    speed_m_s: float,
    left_m_s2: float,
    stands: bool,
) -> Events:
    """Return what happens.

    Args:
        numbers: random ones.
        drivers: what is known of them.
        within_s: from the newest datum to the last possible contact.
        unseen_s: before the newest datum, in which a turn may have begun that no datum shows.
        speed_m_s: of the vehicle.
        left_m_s2: its acceleration to the left.
        stands: whether it does.
    """
    u = numbers.uniforms
    turns_s = within_s + unseen_s
    onset_s = np.where(numbers.branch == TURN, turns_s * u[:, 0] - unseen_s, within_s * u[:, 0])
    size, ramp_s = np.zeros(len(u)), np.full(len(u), _BRAKE_RAMP_S)
    slower, faster, turn = (numbers.branch == branch for branch in (SLOWER, FASTER, TURN))
    size[slower] = -_size_m_s2(drivers, SLOWS, u[slower], _slower_m_s2(u[slower, 2]))
    up = DEPARTS if stands else SPEEDS_UP
    size[faster] = _size_m_s2(drivers, up, u[faster], np.interp(u[faster, 2], _LEVELS, _FASTER_M_S2))
    new = _size_m_s2(drivers, TURNS, u[turn], np.interp(u[turn, 2], _LEVELS, _ASIDE_M_S2))
    new = np.minimum(new, _CURVATURE_MAX_PER_M * speed_m_s**2) * np.where(u[turn, 3] < 0.5, -1.0, 1.0)
    exits_hz = 0.0 if stands else drivers.exits_hz(left_m_s2, speed_m_s)
    size[turn] = np.where(u[turn, 6] * (drivers.rate_hz(TURNS) + exits_hz) < exits_hz, 0.0, new)
    shortest_s, longest_s = _TURN_RAMP_S
    ramp_s[turn] = shortest_s * (longest_s / shortest_s) ** u[turn, 5]
    released_s = -_RELEASED_S * np.log(u[:, 1])
    return Events(
        kind=_KINDS[numbers.branch],
        event=np.column_stack([onset_s, size, ramp_s, released_s]),
        weight=chances(drivers, within_s, turns_s, exits_hz, stands=stands)[numbers.branch] * numbers.share,
    )


def _slower_m_s2(u: Array) -> Array:
    hard = 4.5 + 4.5 * (u - 1.0 + _HARD_SHARE) / _HARD_SHARE
    return np.where(u > 1.0 - _HARD_SHARE, hard, np.interp(u / (1.0 - _HARD_SHARE), _LEVELS, _COMFORTABLE_M_S2))


def _size_m_s2(drivers: Drivers, kind: int, u: Array, drawn_m_s2: Array) -> Array:
    """Return sizes: as seen of this driver where the sample says so, else as drawn."""
    seen = drivers.seen_m_s2(kind) * np.exp(_SEEN_SPREAD * ndtri(u[:, 2]))
    return np.where(u[:, 4] < drivers.seen_share(kind), seen, drawn_m_s2)
