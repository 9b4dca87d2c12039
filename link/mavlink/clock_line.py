"""One clock as a straight line of another: offset and drift, fitted to pairs of simultaneous readings.

Model: y = x + o + d (x - x_ref), with x and y the two clocks in ns, o the offset at x_ref in ns and d the drift
(dimensionless). Weighted least squares; the drift has a Gaussian prior, so that one pair is enough to begin with.
Source: Gelman et al., Bayesian Data Analysis, 3rd ed., section 14.8 (regression with a prior as a further datum).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from msgspec import Struct

from link.units import NS_PER_S

_RATE_MIN = 1e-3  # of y in x: a clock that stands still has no inverse


class ClockPair(NamedTuple):
    """Both clocks at one instant; `std_ns` tells how well they are known to be simultaneous."""

    x_ns: int
    y_ns: int
    std_ns: float


class ClockLine(Struct, frozen=True, kw_only=True):
    """Clock y as a line of clock x about `reference_ns`, a reading of x; variances in ns² and of ns per s."""

    reference_ns: int
    offset_ns: int
    drift: float
    offset_variance_ns2: float
    covariance_ns2_per_s: float
    drift_variance_ns2_per_s2: float

    def y_ns(self, x_ns: int) -> int:
        """The reading of y when x reads `x_ns`."""
        return x_ns + self.offset_ns + round(self.drift * (x_ns - self.reference_ns))

    def x_ns(self, y_ns: int) -> int:
        """The reading of x when y reads `y_ns`."""
        since_reference_ns = y_ns - self.reference_ns - self.offset_ns
        return self.reference_ns + round(since_reference_ns / max(1.0 + self.drift, _RATE_MIN))

    def std_ns(self, x_ns: int) -> float:
        """Standard deviation of `y_ns(x_ns)`, which grows away from the pairs."""
        s = (x_ns - self.reference_ns) / NS_PER_S
        variance_ns2 = (
            self.offset_variance_ns2 + 2.0 * s * self.covariance_ns2_per_s + s * s * self.drift_variance_ns2_per_s2
        )
        return math.sqrt(max(variance_ns2, 0.0))


def fit_clock_line(pairs: Sequence[ClockPair], drift: float, drift_std: float) -> ClockLine:
    """Fits the line about the last pair.

    Args:
        pairs: at least one, each with a positive standard deviation.
        drift: what it is expected to be.
        drift_std: standard deviation of that expectation.

    Returns:
        The line.
    """
    last = pairs[-1]
    reference_offset_ns = last.y_ns - last.x_ns
    drift_ns_per_s = drift * NS_PER_S
    prior_weight = (drift_std * NS_PER_S) ** -2
    w = wx = wxx = wy = wxy = 0.0
    for x_ns, y_ns, std_ns in pairs:
        x_s = (x_ns - last.x_ns) / NS_PER_S
        rest_ns = y_ns - x_ns - reference_offset_ns - drift_ns_per_s * x_s
        weight = std_ns**-2
        w += weight
        wx += weight * x_s
        wxx += weight * x_s * x_s
        wy += weight * rest_ns
        wxy += weight * x_s * rest_ns
    wxx += prior_weight
    determinant = w * wxx - wx * wx
    return ClockLine(
        reference_ns=last.x_ns,
        offset_ns=reference_offset_ns + round((wxx * wy - wx * wxy) / determinant),
        drift=drift + (w * wxy - wx * wy) / determinant / NS_PER_S,
        offset_variance_ns2=wxx / determinant,
        covariance_ns2_per_s=-wx / determinant,
        drift_variance_ns2_per_s2=w / determinant,
    )
