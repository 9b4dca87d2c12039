"""How strong the gusts are, learnt from how the push that they give the drone changes; pure.

The push u of `autopilots.response` is estimated from the drone's reports. What it was before a drone came to rest above
the vehicle, and what the path's own acceleration adds by drag, is known and no gust: only what u differs by from what
was expected a second before is new. Of the variance (1 - exp(-2 t / T)) s^2 that the noise adds to u in that time, with
the model's s, a share k = 1 - P / s^2 is seen, with the estimate's stationary variance P. Its mean square, by k, takes
the place of s^2 as time passes; what the model says counts as much as `_PRIOR_S` of it. From one report to the next
it would be the noise of the reports that is seen.
"""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import DRAG_PER_S, PUSH_STD_M_S2, ResponseModel
from companion.core.data import Array
from link.records import replace

_PUSH = 3  # its place in the state
_PRIOR_S = 1.0  # as long as the estimate of a push needs to forget how it began
_FORGETS_S = 20.0  # a gust lasts some seconds, a landing ten or twenty
_BREAK_S = 0.25
_COMPARED_S = 1.0  # after which a push is compared with what was expected: ten times the drone's lag


class Gusts(Struct, frozen=True, kw_only=True, eq=False):
    """What has been seen of them.

    Attributes:
        square_m2_s4: sum over time of the mean square push of an axis, times 1 s.
        seen_s: over so long.
        seen_ns: monotonic time of the newest report that counts; None before the first.
        expected_m_s2: (2,) push then, by the one that was compared last.
        since_s: how long before that was.
    """

    square_m2_s4: float = 0.0
    seen_s: float = 0.0
    seen_ns: int | None = None
    expected_m_s2: Array | None = None
    since_s: float = 0.0

    @property
    def push_std_m_s2(self) -> float:
        """Standard deviation of an axis of the push."""
        squares = self.square_m2_s4 + _PRIOR_S * PUSH_STD_M_S2**2
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
        return replace(gusts, seen_ns=reported_ns, expected_m_s2=push, since_s=0.0)
    forgets_hz, since_s = response.cascade.forgets_hz, gusts.since_s + passed_s
    expected_m_s2 = math.exp(-passed_s * forgets_hz) * expected_m_s2 - DRAG_PER_S * passed_s * path_m_s2
    if since_s < _COMPARED_S:
        return replace(gusts, seen_ns=reported_ns, expected_m_s2=expected_m_s2, since_s=since_s)
    new_share = 1.0 - math.exp(-2.0 * since_s * forgets_hz)
    seen_share = 1.0 - float(response.covariance[_PUSH, _PUSH]) / PUSH_STD_M_S2**2
    square = float(np.mean(np.square(push - expected_m_s2))) / (new_share * seen_share)
    left = math.exp(-since_s / _FORGETS_S)
    return Gusts(
        square_m2_s4=left * gusts.square_m2_s4 + square * since_s,
        seen_s=left * gusts.seen_s + since_s,
        seen_ns=reported_ns,
        expected_m_s2=push,
    )
