"""How near the pad's centre the drone has to be for what it touches to be the pad: by the pad's own size; pure.

The benchmark's pad is 1.5 m wide. On a smaller one the same shares of its width hold; a larger one changes nothing, for
the configured radius is what a drone in gusts is to keep to.
"""

from companion.config.companion import CompanionConfig
from companion.vehicle.pad import PadPath

_CONE_SHARE = 0.4  # of half of the pad's width: 0.3 m on a pad of 1.5 m
_CONTACT_SHARE = 0.8  # 0.6 m
_KNOWN_SHARE = 1.0 / 3.0  # standard deviation of a pad that has to be seen: 0.25 m


def cone_radius_at_pad_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return the radius of the descent's cone at the height of a pad that is twice `half_width_m` wide."""
    return min(config.descent.cone_radius_at_pad_m, _CONE_SHARE * half_width_m)


def cone_radius_m(height_m: float, half_width_m: float, config: CompanionConfig) -> float:
    """Return how far beside the centre of a pad the drone may be at `height_m` above it while it descends."""
    return cone_radius_at_pad_m(half_width_m, config) + config.descent.cone_slope * max(height_m, 0.0)


def over_pad_radius_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return how far from the pad's centre what is touched is still the pad."""
    return min(2.0 * config.descent.cone_radius_at_pad_m, _CONTACT_SHARE * half_width_m)


def unseen_std_max_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return up to which standard deviation a pad is landed on that only what is seen of it can place."""
    return min(config.descent.unseen_std_max_m, _KNOWN_SHARE * half_width_m)


def is_too_small(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad is narrower than what a drone can be brought onto."""
    return 2.0 * pad.half_width_m < config.descent.pad_width_min_m
