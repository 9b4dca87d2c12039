"""How near a pad's centre the drone has to be, and how well the pad is to be known, before it is landed on; pure.

How near the pad's centre the drone has to be for what it touches to be the pad, the pad's own size says. The
benchmark's pad is 1.5 m wide. On a smaller one the same shares of its width hold; a larger one changes nothing, for
the configured radius is what a drone in gusts is to keep to.
"""

import math

import numpy as np

from companion.autopilots.response import POSITION_STD_M
from companion.config.companion import CompanionConfig
from companion.core.data import FIXED_STD_MAX_M, Array
from companion.vehicle.pad import KNOWN_SHARE, PadPath

_CONE_SHARE = 0.4  # of half of the pad's width: 0.3 m on a pad of 1.5 m
_CONTACT_SHARE = 0.8  # 0.6 m
_ONE_FRAME_STD_M = 0.1  # along an axis, of receivers with corrections: the best of `scenarios/worlds/odd.toml`
_STDS = 2.0  # of both places, that the feet have room for


def cone_radius_at_pad_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return the radius of the descent's cone at the height of a pad that is twice `half_width_m` wide."""
    return min(config.descent.cone.radius_at_pad_m, _CONE_SHARE * half_width_m)


def cone_radius_m(height_m: float, half_width_m: float, config: CompanionConfig) -> float:
    """Return how far beside the centre of a pad the drone may be at `height_m` above it while it descends."""
    return cone_radius_at_pad_m(half_width_m, config) + config.descent.cone.slope * max(height_m, 0.0)


def over_pad_radius_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return how far from the pad's centre what is touched is still the pad."""
    return min(2.0 * config.descent.cone.radius_at_pad_m, _CONTACT_SHARE * half_width_m)


def left_behind_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return how far from the pad's centre a drone has been left by a pad that it had touched."""
    return 2.0 * over_pad_radius_m(half_width_m, config)


def unseen_std_max_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return up to which standard deviation a pad is landed on that only what is seen of it can place."""
    return min(config.descent.unseen.std_max_m, KNOWN_SHARE * half_width_m)


def frames_apart_m2(pad: PadPath) -> Array:
    """Return the part (3,) of the pad's variance that doubts frames which count as one; 0 where they do not.

    If they are not one, that is a wrong model and no bad luck: nothing that weighs luck counts with it. What frames are
    apart that are one is luck, until sightings tell it.
    """
    std_m, is_height_told = pad.frame_offset.std_m, pad.frame_offset.is_height_told
    as_one_m = 0.0 if pad.frame_offset.is_confirmed else _ONE_FRAME_STD_M
    variance = max(std_m**2 - as_one_m**2, 0.0) if pad.has_one_frame and math.isfinite(std_m) else 0.0
    return np.array([variance, variance, 0.0 if is_height_told else variance])


def placed_std_m(pad: PadPath) -> Array:
    """Return the standard deviation (3,) of the pad's place in W now, without the doubt of frames that count as one."""
    return np.asarray(np.sqrt(np.maximum(pad.position_std_m[0] ** 2 - frames_apart_m2(pad), 0.0)))


def is_too_small(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad is narrower than what a drone can be brought onto."""
    return 2.0 * pad.half_width_m < pad_width_min_m(config)


def pad_width_min_m(config: CompanionConfig) -> float:
    """Return how wide a pad has to be: it has room for the feet, wherever the best receivers' places err to."""
    return 2.0 * (config.touchdown.foot_radius_m + _STDS * math.hypot(POSITION_STD_M, FIXED_STD_MAX_M))


def is_vague(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad is not known well enough to come near it."""
    return float(max(pad.position_std_m[0, :2].tolist())) > config.abort.position_std_max_m


def is_unseen(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad has to be seen (again) before it is landed on.

    Fixes of some decimetres or better place it by themselves where both receivers have one frame. Where they may not,
    sightings tell the offset; between coarser fixes and the drone's own place lie metres, and what a sighting said of
    them holds for seconds only. A single sighting may be of anything, by anybody: what moves the pad is seen again.
    """
    if pad.is_coarse or not pad.has_one_frame:
        return not pad.frame_offset.is_confirmed or is_place_vague(pad, config)
    off_m = pad.frame_offset.distance_m
    is_moved = off_m is not None and off_m > cone_radius_at_pad_m(pad.half_width_m, config)
    return is_moved and not pad.frame_offset.is_confirmed


def is_agreement_old(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether what sightings, or a launch, have told of the pad's place does not tell it any more.

    Between fine fixes of two frames that is how far these are apart; a vehicle that was silent is where it says again.
    """
    if pad.is_coarse:
        return is_place_vague(pad, config)
    return not pad.has_one_frame and pad.frame_offset.std_m > unseen_std_max_m(pad.half_width_m, config)


def is_place_vague(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad is known too vaguely to be landed on where only what is seen of it places it."""
    return float(np.max(pad.position_std_m[0, :2])) > unseen_std_max_m(pad.half_width_m, config)
