"""How often and how hard this vehicle's driver has slowed down, sped up, turned in and departed; pure.

Each is taken for a Poisson process whose rate is Gamma distributed: before anything is seen of a driver it is that of
the drivers whom `scenarios/worlds/odd.toml` draws from its sources, with the weight of one event. What is seen counts
by its time, and is forgotten.
"""

import math

import numpy as np
from msgspec import Struct

from companion.vehicle.hindsight import Driven
from companion.vehicle.steady_driving import MEMORY_S
from link.records import replace

SLOWS, SPEEDS_UP, TURNS, DEPARTS = range(4)
PRIOR_GAPS_S = (23.0, 39.0, 40.0, 6.4)
"""Mean times between two of them in 26,000 s of 300 of the domain's worlds, counted as here. Of turns those that change
the acceleration to the side by 1 m/s^2 within a second; `update_drivers` misses two in five of them."""
_COMPARED = 10  # velocities, of a second, over which a receiver's error of 0.1 m/s counts little
_APART_MAX_S = 2.0  # farther apart there was an outage
_BEGINS_M_S2 = 1.0  # the least of the drivers' decelerations (odd.toml, `driver.stop_m_s2`)
_ENDS_M_S2 = 0.5
_RIGHT_ANGLE_RAD = 0.5 * math.pi
_STANDS_M_S = 0.5  # over poor data a parked vehicle seems to move by 0.3 m/s


class Drivers(Struct, frozen=True, kw_only=True):
    """What has been seen, forgotten with time.

    Attributes:
        counts: of each kind of event, (4,).
        sizes_m_s2: sum of their accelerations, (4,).
        driven_s: for how long it was seen driving.
        stood_s: for how long standing.
        under_way: the acceleration of each kind that has not ended, 0 of one that has, (4,).
        left_m_s2: acceleration to the left a second before, for what turns in.
        bends_s: for how long it has been driven through the same bend.
        seen_ns: UTC of the newest velocity that counts; None before the first.
    """

    counts: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    sizes_m_s2: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    driven_s: float = 0.0
    stood_s: float = 0.0
    under_way: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    left_m_s2: float = 0.0
    bends_s: float = 0.0
    seen_ns: int | None = None

    def rate_hz(self, kind: int) -> float:
        """Return the mean rate of a kind while the vehicle drives, of departures while it stands."""
        seen_s = self.stood_s if kind == DEPARTS else self.driven_s
        return (1.0 + self.counts[kind]) / (PRIOR_GAPS_S[kind] + seen_s)

    def exits_hz(self, left_m_s2: float, speed_m_s: float) -> float:
        """Return at which rate the bend ends that is driven through, 0 on a straight.

        Before anything is seen of it, it turns by a right angle in the mean, as at a junction; one that goes on and on,
        as a roundabout's or a circle's, ends the later.
        """
        if abs(left_m_s2) < _ENDS_M_S2:
            return 0.0
        return 1.0 / (_RIGHT_ANGLE_RAD * max(speed_m_s, _STANDS_M_S) / abs(left_m_s2) + self.bends_s)

    def seen_share(self, kind: int) -> float:
        """Return which share of the next events of a kind is taken to be as hard as those seen."""
        return self.counts[kind] / (1.0 + self.counts[kind])

    def seen_m_s2(self, kind: int) -> float:
        """Return the mean size of those seen, 0 without any."""
        return self.sizes_m_s2[kind] / self.counts[kind] if self.counts[kind] > 0.0 else 0.0


def update_drivers(drivers: Drivers, driven: tuple[Driven, ...]) -> Drivers:
    """Return the drivers after what the vehicle has driven, its velocities ten a second, oldest first."""
    if len(driven) <= _COMPARED or (drivers.seen_ns is not None and driven[-1][0] <= drivers.seen_ns):
        return drivers
    before, now = driven[-1 - _COMPARED], driven[-1]
    passed_s = (now[0] - before[0]) * 1e-9
    if passed_s > _APART_MAX_S or drivers.seen_ns is None:
        return replace(drivers, seen_ns=now[0])
    speed_m_s, later_m_s = math.hypot(*before[1:]), math.hypot(*now[1:])
    turned_rad = math.atan2(before[1] * now[2] - before[2] * now[1], before[1] * now[1] + before[2] * now[2])
    along_m_s2, left_m_s2 = (later_m_s - speed_m_s) / passed_s, min(speed_m_s, later_m_s) * turned_rad / passed_s
    departs = speed_m_s < _STANDS_M_S or drivers.under_way[DEPARTS] > 0.0
    turns_m_s2 = abs(left_m_s2 - drivers.left_m_s2)
    sizes = (-along_m_s2, 0.0 if departs else along_m_s2, turns_m_s2, along_m_s2 if departs else 0.0)
    since_s = min((now[0] - drivers.seen_ns) * 1e-9, _APART_MAX_S)
    drivers = _forget(drivers, since_s, stands=later_m_s < _STANDS_M_S)
    share = min(since_s / passed_s, 1.0)
    goes_on = abs(left_m_s2) >= _ENDS_M_S2 and left_m_s2 * drivers.left_m_s2 >= 0.0
    drivers = replace(
        drivers,
        left_m_s2=drivers.left_m_s2 + share * (left_m_s2 - drivers.left_m_s2),
        bends_s=drivers.bends_s + since_s if goes_on else 0.0,
        seen_ns=now[0],
    )
    return _count(drivers, sizes)


def _forget(drivers: Drivers, since_s: float, *, stands: bool) -> Drivers:
    left = math.exp(-since_s / MEMORY_S)
    return replace(
        drivers,
        counts=tuple(left * count for count in drivers.counts),
        sizes_m_s2=tuple(left * size for size in drivers.sizes_m_s2),
        driven_s=left * drivers.driven_s + (0.0 if stands else since_s),
        stood_s=left * drivers.stood_s + (since_s if stands else 0.0),
    )


def _count(drivers: Drivers, sizes_m_s2: tuple[float, ...]) -> Drivers:
    """Count what begins; what is under way grows to its greatest size."""
    counts, sums, under_way = list(drivers.counts), list(drivers.sizes_m_s2), list(drivers.under_way)
    for kind, size_m_s2 in enumerate(sizes_m_s2):
        if under_way[kind] > 0.0:
            more_m_s2 = max(size_m_s2 - under_way[kind], 0.0)
            sums[kind] += more_m_s2
            under_way[kind] = under_way[kind] + more_m_s2 if size_m_s2 > _ENDS_M_S2 else 0.0
        elif size_m_s2 > _BEGINS_M_S2:
            counts[kind] += 1.0
            sums[kind] += size_m_s2
            under_way[kind] = size_m_s2
    return replace(drivers, counts=tuple(counts), sizes_m_s2=tuple(sums), under_way=tuple(under_way))


def chances(
    drivers: Drivers, within_s: float, turns_s: float, exits_hz: float, *, stands: bool
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return how likely the vehicle does nothing new, slows, speeds up (or departs), and turns in, (4,).

    One that turns and uses a pedal, too, counts for its pedal: a turn, which every bend ends with, would otherwise take
    from the weight of a brake, which displaces the pad by more.

    Args:
        drivers: what is known of them.
        within_s: for how long anything may begin.
        turns_s: for how long a turn may, out of a bend too.
        exits_hz: at which rate a bend ends beside the turns that have been seen.
        stands: whether the vehicle does.
    """
    slows = 0.0 if stands else within_s * drivers.rate_hz(SLOWS)
    speeds_up = within_s * drivers.rate_hz(DEPARTS if stands else SPEEDS_UP)
    turns = 0.0 if stands else turns_s * (drivers.rate_hz(TURNS) + exits_hz)
    no_pedal = math.exp(-slows - speeds_up)
    share = (1.0 - no_pedal) / (slows + speeds_up)
    return np.array([no_pedal * math.exp(-turns), slows * share, speeds_up * share, no_pedal * -math.expm1(-turns)])
