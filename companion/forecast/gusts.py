"""How strong the gusts are, learnt from how the push that they give the drone changes; pure.

The push u of `autopilots.response` is estimated from the drone's reports. What it was before a drone came to rest above
the vehicle, and what the path's own acceleration adds by drag, is known and no gust: only what u differs by from what
was expected a second before is new. Of the variance (1 - exp(-2 t / T)) s^2 that the noise adds to u in that time, with
the model's s, a share k = 1 - P / s^2 is seen, with the estimate's stationary variance P. From one report to the next
it would be the noise of the reports that is seen. Its mean square, by k, takes the place of what is expected before
anything is seen, which counts as much as `_PRIOR_S` of it.
On a path whose acceleration changes, a lean that lags by other than the model's lag looks like a push, too. What that
may be, by the jerk before either end of the second, is no gust, and the second counts the less for it.
"""

import math

import numpy as np
from msgspec import Struct, field

from companion.autopilots.response import ATTITUDE_LAG_S, DRAG_PER_S, PUSH_STD_M_S2, ResponseModel
from companion.core.data import Array
from link.records import replace

_PUSH = 3  # its place in the state
_PRIOR_S = 1.0  # as long as the estimate of a push needs to forget how it began
_FORGETS_S = 20.0  # a gust lasts some seconds, a landing ten or twenty
_BREAK_S = 0.25
_COMPARED_S = 1.0  # after which a push is compared with what was expected: ten times the drone's lag
_MATTERS_STD_M_S2 = 1.5 * DRAG_PER_S  # that a doubt is weighed against: light turbulence of MIL-F-8785C, 1.5 m/s
_EXPECTED_STD_M_S2 = 0.8 * DRAG_PER_S  # turbulence of MIL-F-8785C at 5 m in a gentle breeze: a fifth of 4 m/s
_SETTLES_S = 0.4  # the longest time constant of the estimate of a push: earlier jerk is forgotten


class Gusts(Struct, frozen=True, kw_only=True, eq=False):
    """What has been seen of them.

    Attributes:
        square_m2_s4: sum over time of the mean square push of an axis, times 1 s.
        seen_s: over so long.
        seen_ns: monotonic time of the newest report that counts; None before the first.
        expected_m_s2: (2,) push then, by the one that was compared last.
        since_s: how long before that was.
        smoothed_m_s2: (2,) acceleration of the path, over `_SETTLES_S`.
        doubt_m2_s4: (2,) what may be no gust of the push that was compared last, as a variance.
    """

    square_m2_s4: float = 0.0
    seen_s: float = 0.0
    seen_ns: int | None = None
    expected_m_s2: Array | None = None
    since_s: float = 0.0
    smoothed_m_s2: Array = field(default_factory=lambda: np.zeros(2))
    doubt_m2_s4: Array = field(default_factory=lambda: np.zeros(2))

    @property
    def push_std_m_s2(self) -> float:
        """Standard deviation of an axis of the push."""
        squares = self.square_m2_s4 + _PRIOR_S * _EXPECTED_STD_M_S2**2
        return math.sqrt(squares / (self.seen_s + _PRIOR_S))


def update_gusts(gusts: Gusts, reported_ns: int, deviation: Array, path_m_s2: Array, response: ResponseModel) -> Gusts:
    """Return the gusts after a report.

    Args:
        gusts: so far.
        reported_ns: monotonic time of the report.
        deviation: (4, 2) the cascade's state then.
        path_m_s2: (2,) acceleration of the path.
        response: of the autopilot.
    """
    if gusts.seen_ns is not None and reported_ns <= gusts.seen_ns:
        return gusts
    push, expected_m_s2 = deviation[_PUSH].copy(), gusts.expected_m_s2
    passed_s = _BREAK_S if gusts.seen_ns is None else (reported_ns - gusts.seen_ns) * 1e-9
    if passed_s >= _BREAK_S or expected_m_s2 is None:
        return replace(
            gusts,
            seen_ns=reported_ns,
            expected_m_s2=push,
            since_s=0.0,
            # How the path went before is unknown, so its acceleration is taken to have begun just now.
            smoothed_m_s2=np.zeros(2),
            doubt_m2_s4=_doubt_m2_s4(path_m_s2),
        )
    forgets_hz, since_s = response.cascade.forgets_hz, gusts.since_s + passed_s
    expected_m_s2 = math.exp(-passed_s * forgets_hz) * expected_m_s2 - DRAG_PER_S * passed_s * path_m_s2
    smoothed = gusts.smoothed_m_s2 + (path_m_s2 - gusts.smoothed_m_s2) * (passed_s / _SETTLES_S)
    gusts = replace(gusts, seen_ns=reported_ns, smoothed_m_s2=smoothed)
    if since_s < _COMPARED_S:
        return replace(gusts, expected_m_s2=expected_m_s2, since_s=since_s)
    new_share = 1.0 - math.exp(-2.0 * since_s * forgets_hz)
    seen_share = 1.0 - float(response.covariance[_PUSH, _PUSH]) / PUSH_STD_M_S2**2
    doubt = _doubt_m2_s4(path_m_s2 - smoothed)
    told = _told(np.square(push - expected_m_s2), gusts.doubt_m2_s4 + doubt, new_share * seen_share)
    left = math.exp(-since_s / _FORGETS_S)
    return replace(
        gusts,
        square_m2_s4=left * gusts.square_m2_s4 + told[0] * since_s,
        seen_s=left * gusts.seen_s + told[1] * since_s,
        expected_m_s2=push,
        since_s=0.0,
        doubt_m2_s4=doubt,
    )


def forget_push(gusts: Gusts) -> Gusts:
    """Return the gusts where the push before is unknown, so that the next one differs from nothing."""
    return replace(gusts, expected_m_s2=None)


def _doubt_m2_s4(changed_m_s2: Array) -> Array:
    """Return the variance (2,) of a push that is none, while the path's acceleration changes by so much."""
    return np.square(ATTITUDE_LAG_S * changed_m_s2 / _SETTLES_S)


def _told(square_m2_s4: Array, doubt_m2_s4: Array, share: float) -> tuple[float, float]:
    """Return the mean square of a gust's push that a second shows, by its weight, and the weight, 0 to 1."""
    matters_m2_s4 = share * _MATTERS_STD_M_S2**2
    trust = np.square(matters_m2_s4 / (matters_m2_s4 + doubt_m2_s4))
    gust_m2_s4 = np.maximum(square_m2_s4 - doubt_m2_s4, 0.0) / share
    return float(np.mean(trust * gust_m2_s4)), float(np.mean(trust))
