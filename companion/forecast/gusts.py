"""How strong the gusts are, learnt from how the push that they give the drone changes; pure.

The push u of `autopilots.response` is estimated from the drone's reports. What it was before a drone came to rest above
the vehicle, and what the path's own acceleration adds by drag, is known and no gust: only what a report changes in the
estimate beyond that is new. Of the variance that the noise adds to u in a time, (1 - exp(-2 t / T)) s^2 with the
model's s, a share k = 1 - P / s^2 is seen so, with the estimate's stationary variance P. Its mean square, by k, takes
the place of s^2 as time passes; what the model says counts as much as `_PRIOR_S` of it.
"""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import DRAG_PER_S, PUSH_STD_M_S2, ResponseModel
from companion.core.data import Array

_PUSH = 3  # its place in the state
_PRIOR_S = 1.0  # as long as the estimate of a push needs to forget how it began
_FORGETS_S = 20.0  # a gust lasts some seconds, a landing ten or twenty
_BREAK_S = 0.25


class Gusts(Struct, frozen=True, kw_only=True, eq=False):
    """What has been seen of them.

    Attributes:
        square_m2_s4: sum over time of the mean square push of an axis, times 1 s.
        seen_s: over so long.
        seen_ns: monotonic time of the newest report that counts; None before the first.
        push_m_s2: (2,) as it was estimated then.
    """

    square_m2_s4: float = 0.0
    seen_s: float = 0.0
    seen_ns: int | None = None
    push_m_s2: Array | None = None

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
    push = deviation[_PUSH].copy()
    since_s = _BREAK_S if gusts.seen_ns is None else (reported_ns - gusts.seen_ns) * 1e-9
    if since_s >= _BREAK_S or gusts.push_m_s2 is None:
        return Gusts(square_m2_s4=gusts.square_m2_s4, seen_s=gusts.seen_s, seen_ns=reported_ns, push_m_s2=push)
    kept = math.exp(-since_s * response.cascade.forgets_hz)
    seen_share = 1.0 - float(response.covariance[_PUSH, _PUSH]) / PUSH_STD_M_S2**2
    new = push - (kept * gusts.push_m_s2 - DRAG_PER_S * since_s * path_m_s2)
    square = float(np.mean(np.square(new))) / ((1.0 - kept * kept) * seen_share)
    left = math.exp(-since_s / _FORGETS_S)
    return Gusts(
        square_m2_s4=left * gusts.square_m2_s4 + square * since_s,
        seen_s=left * gusts.seen_s + since_s,
        seen_ns=reported_ns,
        push_m_s2=push,
    )
