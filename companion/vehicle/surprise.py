"""Whether the vehicle has done what its data had not led to expect, judged in hindsight; pure.

What is known of a vehicle is as old as its data: 0.1 s over a good link, 0.6 s over a poor one. What it
does meanwhile is a guess, which can be checked once the data of that moment are there. A guess that was off by nearly
the speed that a contact may have against the pad means that a contact at that moment would have been too fast. A
vehicle that has braked or started like that will again (a bus, a queue of cars), so it is landed on only while it
stands, or has driven for some time as expected. Over late data it has to stand for some time, too, or it drives again
before that is told. Only its speed is asked about. With fresh data even an emergency brake surprises by little, but
it takes the drone half a second to brake as hard: a vehicle that is seen to brake hard counts as one that has
surprised.
"""

import math

from msgspec import Struct, field

from companion.config.descent import UnevenConfig
from companion.core.data import VehicleEstimate
from companion.vehicle.driving import Driving, brakes_hard, is_late, speeds_up_hard, with_velocity
from companion.vehicle.estimator import Estimator, EstimatorMemory
from link.records import replace

_BELIEF_PERIOD_NS = 100_000_000
_KNOWN_STD_MAX_M_S = 1.0  # of a velocity that is a belief: in its first second an estimate knows no acceleration
_SURPRISE_STDS = 2.5  # less was said to be possible: through an outage of 2 s a belief is off by 1 m/s
_LATENESS_MEAN_S = 1.0  # five periods of the slowest receiver
_KEPT = 30  # beliefs: of 3 s, longer than any data are awaited
_SURE_STD_MAX_M_S = 0.3  # of a velocity that was driven; one fix's is 0.1

Belief = tuple[int, float, float]
"""UTC ns, the horizontal speed that was believed then, m/s, and its standard deviation, m/s."""


class Surprise(Struct, frozen=True, kw_only=True):
    """What has been believed of the vehicle's speed, and when that was last found to be wrong.

    Attributes:
        beliefs: not checked yet, oldest first.
        speed_std_m_s: of the newest of all; infinite while the speed is not known.
        lateness_s: age of the newest fix, a mean of the last second, for between two fixes of a receiver at 5 Hz it
            grows by 0.2 s; None before the first.
        aged_ns: when that was last so, monotonic.
        surprised_ns: when the newest wrong one was held, monotonic; None when none was.
        driving: how it has driven up to the times of the beliefs that have been checked.
    """

    beliefs: tuple[Belief, ...] = ()
    speed_std_m_s: float = math.inf
    lateness_s: float | None = None
    aged_ns: int = 0
    surprised_ns: int | None = None
    driving: Driving = field(default_factory=Driving)


def update_surprise(
    surprise: Surprise,
    estimator: Estimator,
    memory: EstimatorMemory | None,
    t_ns: int,
    *,
    monotonic_ns: int,
    config: UnevenConfig,
) -> Surprise:
    """Return the surprise at `t_ns`: beliefs are checked whose time the vehicle's data have reached, and one is added.

    Args:
        surprise: so far.
        estimator: of the vehicle.
        memory: the estimator's own, after all that has arrived.
        t_ns: now, UTC.
        monotonic_ns: now, on the clock that is never set.
        config: what counts as wrong.
    """
    newest_ns = estimator.newest_fix_ns(memory)
    if newest_ns is None:
        return replace(surprise, beliefs=(), speed_std_m_s=math.inf)
    surprise = _with_age(surprise, (t_ns - newest_ns) * 1e-9, monotonic_ns)
    while surprise.beliefs and surprise.beliefs[0][0] <= newest_ns:
        (then_ns, speed_m_s, std_m_s), *later = surprise.beliefs
        surprise = replace(surprise, beliefs=tuple(later))
        known = estimator.estimate(memory, then_ns)
        if known is None or not _is_known(known):
            continue
        faster_m_s = _speed_m_s(known) - speed_m_s
        is_sure = _std_m_s(known) < _SURE_STD_MAX_M_S
        if is_sure:
            surprise = replace(surprise, driving=with_velocity(surprise.driving, then_ns, known.velocity_enu_m_s))
        # To depart so once more it has to stop first, and over fresh data that surprises by itself if it is as hard.
        departs = faster_m_s > 0.0 or speeds_up_hard(surprise.driving, config)
        counts = not departs or is_late(surprise.lateness_s, config)
        is_wrong = counts and abs(faster_m_s) > max(config.surprise_speed_m_s, _SURPRISE_STDS * std_m_s)
        if is_wrong or (is_sure and brakes_hard(surprise.driving, config)):
            wrong_ns, before_ns = then_ns - t_ns + monotonic_ns, surprise.surprised_ns
            surprise = replace(surprise, surprised_ns=wrong_ns if before_ns is None else max(wrong_ns, before_ns))
    if surprise.beliefs and t_ns - surprise.beliefs[-1][0] < _BELIEF_PERIOD_NS:
        return surprise
    now = estimator.estimate(memory, t_ns)
    if now is None or not _is_known(now):
        return replace(surprise, speed_std_m_s=math.inf)
    std_m_s = _std_m_s(now)
    beliefs = (*surprise.beliefs, (t_ns, _speed_m_s(now), std_m_s))[-_KEPT:]
    return replace(surprise, beliefs=beliefs, speed_std_m_s=std_m_s)


def _with_age(surprise: Surprise, age_s: float, monotonic_ns: int) -> Surprise:
    before_s = surprise.lateness_s
    if before_s is None:
        return replace(surprise, lateness_s=age_s, aged_ns=monotonic_ns)
    share = -math.expm1(-(monotonic_ns - surprise.aged_ns) * 1e-9 / _LATENESS_MEAN_S)
    return replace(surprise, lateness_s=before_s + share * (age_s - before_s), aged_ns=monotonic_ns)


def forget_beliefs(surprise: Surprise) -> Surprise:
    """Return the surprise after UTC was set: what was believed has lost its time."""
    return replace(surprise, beliefs=(), driving=replace(surprise.driving, driven=(), changes=()))


def may_surprise(surprise: Surprise, monotonic_ns: int, config: UnevenConfig) -> bool:
    """Return whether a driving vehicle is to be expected to do at `monotonic_ns` what it has done."""
    since_ns = surprise.surprised_ns
    return since_ns is not None and (monotonic_ns - since_ns) * 1e-9 < config.hold_s


def _speed_m_s(estimate: VehicleEstimate) -> float:
    return math.hypot(*estimate.velocity_enu_m_s[:2].tolist())


def _is_known(estimate: VehicleEstimate) -> bool:
    return _std_m_s(estimate) < _KNOWN_STD_MAX_M_S


def _std_m_s(estimate: VehicleEstimate) -> float:
    return math.sqrt(max(float(estimate.covariance[3, 3] + estimate.covariance[4, 4]), 0.0))  # rounding
