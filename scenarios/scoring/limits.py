"""The limits of a touchdown, by tier, and which of them one exceeds."""

import math
from dataclasses import dataclass

from scenarios.scoring.touchdown import Touchdown


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """The largest values, each of the measure of that name of a `Touchdown`."""

    horizontal_error_m: float
    relative_speed_m_s: float
    sink_rate_m_s: float
    tilt_over_trim_rad: float


S1_LIMITS = Limits(
    horizontal_error_m=0.50, relative_speed_m_s=1.0, sink_rate_m_s=1.0, tilt_over_trim_rad=math.radians(15.0)
)
S2_LIMITS = Limits(
    horizontal_error_m=0.30, relative_speed_m_s=0.5, sink_rate_m_s=0.7, tilt_over_trim_rad=math.radians(10.0)
)


def find_exceeded(touchdown: Touchdown, limits: Limits) -> list[str]:
    """Return the measures of `touchdown` that exceed `limits`, with their values."""
    names = Limits.__dataclass_fields__
    return [
        f"{name} {getattr(touchdown, name):.3g}" for name in names if getattr(touchdown, name) > getattr(limits, name)
    ]
