"""Flight limits from an autopilot's parameters, which may be unknown or absurd; shared by the drivers."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from companion.core.gravity import GRAVITY_M_S2

_STATED_MIN = 0.1  # m/s or degrees; a limit below this cannot be flown with
_TILT_SHARE = 0.85  # of the largest tilt's thrust; the rest is for gusts and for the autopilot's own corrections


@dataclass(frozen=True, slots=True)
class Named:
    """One name of a parameter, and what one of its units is in m/s or degrees."""

    name: str
    unit: float = 1.0


def stated(parameters: Mapping[str, float], names: Sequence[Named]) -> float:
    """Return a limit by whichever of its names is known, infinity where none is or what it says cannot be meant."""
    for named in names:
        value = parameters.get(named.name, math.nan) * named.unit
        if value >= _STATED_MIN:
            return value
    return math.inf


def gain(parameters: Mapping[str, float], names: Sequence[str], default: float) -> float:
    """Return a gain by whichever of its names is known, the firmware's default where none is or it is not positive."""
    for name in names:
        value = parameters.get(name, math.nan)
        if value > 0.0 and math.isfinite(value):
            return value
    return default


def acceleration_of_tilt_m_s2(tilt_deg: float) -> float:
    """Return the horizontal thrust by mass that may be planned with under a tilt limit."""
    return _TILT_SHARE * GRAVITY_M_S2 * math.tan(math.radians(tilt_deg))
