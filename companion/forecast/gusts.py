"""How strong the gusts are, learnt from the drone's deviation that its autopilot has not corrected; pure.

The push u of `autopilots.response` is estimated from the drone's reports. Of its variance a share k = 1 - P / s^2 is
seen, with the model's own s and the estimate's variance P. The mean square of what is seen, by k, takes the place of s
as time passes; what the model says counts as much as `_PRIOR_S` of it.
"""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import PUSH_STD_M_S2, ResponseModel
from companion.core.data import Array

_PUSH = 3  # its place in the state
_PRIOR_S = 1.0  # as long as the estimate of a push needs to forget how it began
_FORGETS_S = 20.0  # a gust lasts some seconds, a landing ten or twenty
_BREAK_S = 0.25


class Gusts(Struct, frozen=True, kw_only=True):
    """What has been seen of them.

    Attributes:
        square_m2_s4: sum over time of the mean square push of an axis, times 1 s.
        seen_s: over so long.
        seen_ns: monotonic time of the newest report that counts; None before the first.
    """

    square_m2_s4: float = 0.0
    seen_s: float = 0.0
    seen_ns: int | None = None

    @property
    def push_std_m_s2(self) -> float:
        """Standard deviation of an axis of the push."""
        squares = self.square_m2_s4 + _PRIOR_S * PUSH_STD_M_S2**2
        return math.sqrt(squares / (self.seen_s + _PRIOR_S))


def update_gusts(gusts: Gusts, reported_ns: int, deviation: Array, response: ResponseModel) -> Gusts:
    """Return the gusts after a report.

    Args:
        gusts: so far.
        reported_ns: monotonic time of the report.
        deviation: (4, 2) the cascade's state then.
        response: of the autopilot.
    """
    if gusts.seen_ns is not None and reported_ns <= gusts.seen_ns:
        return gusts
    since_s = _BREAK_S if gusts.seen_ns is None else (reported_ns - gusts.seen_ns) * 1e-9
    if since_s >= _BREAK_S:
        return Gusts(square_m2_s4=gusts.square_m2_s4, seen_s=gusts.seen_s, seen_ns=reported_ns)
    seen_share = 1.0 - float(response.covariance[_PUSH, _PUSH]) / PUSH_STD_M_S2**2
    left = math.exp(-since_s / _FORGETS_S)
    square = float(np.mean(np.square(deviation[_PUSH]))) / seen_share
    return Gusts(
        square_m2_s4=left * gusts.square_m2_s4 + square * since_s,
        seen_s=left * gusts.seen_s + since_s,
        seen_ns=reported_ns,
    )
