"""How the vehicle has driven, as its data show in hindsight, and how well its speed is known meanwhile; pure.

What is known of a vehicle is as old as its data: 0.1 s over a good link, 0.6 s over a poor one. Each tenth of a second
is therefore looked back at once the data of that moment are there.
"""

import math

from msgspec import Struct, field

from companion.core.data import VehicleEstimate
from companion.vehicle.driving import Driving, with_velocity
from companion.vehicle.estimator import Estimator, EstimatorMemory
from link.records import replace

_PERIOD_NS = 100_000_000
_KNOWN_STD_MAX_M_S = 1.0  # of a velocity that is known: in its first second an estimate knows no acceleration
_LATENESS_MEAN_S = 1.0  # five periods of the slowest receiver
_AWAITED = 30  # instants: of 3 s, longer than any data are awaited
_SURE_STD_MAX_M_S = 0.3  # of a velocity that was driven; one fix's is 0.1


class Hindsight(Struct, frozen=True, kw_only=True):
    """What is looked back at, and what that has shown.

    Attributes:
        awaited_ns: instants, UTC, that the vehicle's data have not reached yet, oldest first.
        speed_std_m_s: of the newest of all; infinite while the speed is not known.
        lateness_s: age of the newest fix, a mean of the last second, for between two fixes of a receiver at 5 Hz it
            grows by 0.2 s; None before the first.
        aged_ns: when that was last so, monotonic.
        driving: how the vehicle has driven up to the instants that have been looked back at.
    """

    awaited_ns: tuple[int, ...] = ()
    speed_std_m_s: float = math.inf
    lateness_s: float | None = None
    aged_ns: int = 0
    driving: Driving = field(default_factory=Driving)


def update_hindsight(
    hindsight: Hindsight, estimator: Estimator, memory: EstimatorMemory | None, t_ns: int, *, monotonic_ns: int
) -> Hindsight:
    """Return the hindsight at `t_ns`: instants that the vehicle's data have reached are looked back at, one is added.

    Args:
        hindsight: so far.
        estimator: of the vehicle.
        memory: the estimator's own, after all that has arrived.
        t_ns: now, UTC.
        monotonic_ns: now, on the clock that is never set.
    """
    newest_ns = estimator.newest_fix_ns(memory)
    if newest_ns is None:
        return replace(hindsight, awaited_ns=(), speed_std_m_s=math.inf)
    hindsight = _with_age(hindsight, (t_ns - newest_ns) * 1e-9, monotonic_ns)
    while hindsight.awaited_ns and hindsight.awaited_ns[0] <= newest_ns:
        then_ns, *later = hindsight.awaited_ns
        hindsight = replace(hindsight, awaited_ns=tuple(later))
        known = estimator.estimate(memory, then_ns)
        if known is not None and _std_m_s(known) < _SURE_STD_MAX_M_S:
            hindsight = replace(hindsight, driving=with_velocity(hindsight.driving, then_ns, known.velocity_enu_m_s))
    if hindsight.awaited_ns and t_ns - hindsight.awaited_ns[-1] < _PERIOD_NS:
        return hindsight
    now = estimator.estimate(memory, t_ns)
    std_m_s = math.inf if now is None else _std_m_s(now)
    if std_m_s >= _KNOWN_STD_MAX_M_S:
        return replace(hindsight, speed_std_m_s=math.inf)
    return replace(hindsight, awaited_ns=(*hindsight.awaited_ns, t_ns)[-_AWAITED:], speed_std_m_s=std_m_s)


def _with_age(hindsight: Hindsight, age_s: float, monotonic_ns: int) -> Hindsight:
    before_s = hindsight.lateness_s
    if before_s is None:
        return replace(hindsight, lateness_s=age_s, aged_ns=monotonic_ns)
    share = -math.expm1(-(monotonic_ns - hindsight.aged_ns) * 1e-9 / _LATENESS_MEAN_S)
    return replace(hindsight, lateness_s=before_s + share * (age_s - before_s), aged_ns=monotonic_ns)


def forget_instants(hindsight: Hindsight) -> Hindsight:
    """Return the hindsight after UTC was set: the instants have lost their time."""
    return replace(hindsight, awaited_ns=(), driving=replace(hindsight.driving, driven=(), changes=()))


def _std_m_s(estimate: VehicleEstimate) -> float:
    return math.sqrt(max(float(estimate.covariance[3, 3] + estimate.covariance[4, 4]), 0.0))  # rounding
