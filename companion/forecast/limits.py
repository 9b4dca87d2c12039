"""The limits of a contact that a forecast is asked about: those by which landings are scored (docs/benchmark.md)."""

import math

from msgspec import Struct


class ContactLimits(Struct, frozen=True, kw_only=True):
    """The largest values against the deck; the tilt is beyond that of steady flight through the same air."""

    horizontal_error_m: float
    relative_speed_m_s: float
    sink_rate_m_s: float
    tilt_over_trim_rad: float


S1 = ContactLimits(
    horizontal_error_m=0.50, relative_speed_m_s=1.0, sink_rate_m_s=1.0, tilt_over_trim_rad=math.radians(15.0)
)
"""Beyond these a contact is unsafe."""

S2 = ContactLimits(
    horizontal_error_m=0.30, relative_speed_m_s=0.5, sink_rate_m_s=0.7, tilt_over_trim_rad=math.radians(10.0)
)
