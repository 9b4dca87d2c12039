"""How high the drone waits for a pad, and follows one that it does not land on yet; pure numerics in W."""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.planning.guidance import ReferenceState
from companion.situation.situation import Situation
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import is_unseen, is_vague

_RISES_M_S = 0.5  # ten times as fast as a barometer drifts; a single reading of an insect moves it by a centimetre


def unseen_height_m(height_m: float, pad: PadPath, config: CompanionConfig) -> float:
    """Return how high the drone stays above a pad that it has to see first, and `height_m` above any other.

    Higher by what the pad's height is unsure, but not out of its detector's sight: it would never be seen then. Fixes
    that are not coarse tell heights well enough for the height at which a vehicle is waited for.
    """
    if not (pad.is_coarse and is_unseen(pad, config)):
        return height_m
    clear_m = height_m + config.chase.unseen_height_stds * float(pad.position_std_m[0, 2])
    return max(height_m, min(clear_m, config.chase.unseen_height_max_m))


def clear_height_m(height_m: float, pad: PadPath, config: CompanionConfig) -> float:
    """Return how high the drone stays above where a pad is said to be, so as to be `height_m` above where it may be."""
    return max(unseen_height_m(height_m, pad, config), height_m + pad.frame_offset.higher_m)


def chase_height_m(pad: PadPath, reference: ReferenceState, config: CompanionConfig) -> float:
    """Come down towards the height of alignment as the horizontal distance closes, two metres for each.

    Over a vehicle whose place is not known well enough to align with it, nothing says that its side is not below, and
    as long as its height is as vague, that the roof is not where the drone flies.
    """
    if config.silent_vehicle is not None:
        return _sight_height_m(pad, reference, config)
    if is_vague(pad, config) or is_unseen(pad, config):
        return clear_height_m(config.chase.height_m, pad, config)
    distance_m = math.hypot(*(reference.position_enu_m[:2] - pad.position_enu_m[0, :2]).tolist())
    beyond_m = max(distance_m - config.descent.alignment.begin_distance_m, 0.0)
    return min(config.descent.alignment.height_m + 0.5 * beyond_m, config.chase.height_m) + pad.frame_offset.higher_m


def _sight_height_m(pad: PadPath, reference: ReferenceState, config: CompanionConfig) -> float:
    """Return the height over a pad that tells nothing, so that it stays in sight.

    A camera that sees 45 degrees to each side has it in view then, with what its place is unsure by.
    """
    distance_m = math.hypot(*(reference.position_enu_m[:2] - pad.position_enu_m[0, :2]).tolist())
    unsure_m = config.chase.unseen_height_stds * float(np.max(pad.position_std_m[0, :2]))
    beyond_m = max(distance_m + unsure_m - config.descent.alignment.begin_distance_m, 0.0)
    lowest_m = config.chase.height_m if is_unseen(pad, config) else config.descent.alignment.height_m
    return min(max(config.descent.alignment.height_m + beyond_m, lowest_m), config.chase.unseen_height_max_m)


def chase_floor_m(config: CompanionConfig) -> float:
    """Return how far the feet stay above the pad before the alignment."""
    return 0.8 * config.descent.alignment.height_m


def vague_height_m(pad: PadPath, config: CompanionConfig) -> float:
    """Return by how much a pad that has to be seen first may be lower than it is said to be; 0 for any other."""
    if not (pad.is_coarse and is_unseen(pad, config)):
        return 0.0
    return min(config.chase.unseen_height_stds * float(pad.position_std_m[0, 2]), config.chase.unseen_height_max_m)


def waiting_rise_m(waiting_enu_m: float, s: Situation, config: CompanionConfig) -> float:
    """Return how much higher the drone waits for a pad that is near or whose height is vague, to be clear of its roof.

    A roof that is said to be too high for the chase may well be lower: the drone climbs and looks. One that is known to
    be would drive into a drone that stays. No vehicle makes it climb to more than twice the height at which it waits.

    Args:
        waiting_enu_m: height in W of the place where the drone is to wait.
        s: the facts.
        config: all numbers.
    """
    if s.pad is None:
        return 0.0
    height_m = waiting_enu_m - s.feet_offset_m - float(s.pad.position_enu_m[0, 2])
    lacking_m, most_m = chase_floor_m(config) - height_m, vague_height_m(s.pad, config)
    if s.approach is not None and s.approach.distance_m <= config.integrity.ground_within_m:
        most_m = max(most_m, config.takeoff.waiting_height_m)
    return min(lacking_m + config.takeoff.reached_distance_m, most_m) if 0.0 < lacking_m < most_m else 0.0


def rise_from_ground_m(waiting_enu_m: float, s: Situation, dt_s: float, config: CompanionConfig) -> float:
    """Return by how much the waiting point rises in `dt_s`, so as to be as high over what the range finder sees.

    The drone's own height wanders by metres while it waits (a barometer), and nothing else sees the ground come nearer.
    It does not come down again: what is below may have been a roof that drove on. No range finder that something hangs
    before makes it climb to more than twice the height at which it waits.
    """
    seen_m, wait_m = s.below.range_height_m, config.takeoff.waiting_height_m
    if s.drone is None or seen_m is None:
        return 0.0
    wanted_enu_m = min(float(s.drone.position_enu_m[2]) - seen_m + wait_m, _feet_on_ground_m(s) + 2.0 * wait_m)
    return min(max(wanted_enu_m - waiting_enu_m, 0.0), _RISES_M_S * dt_s)


def climb_m(height_enu_m: float, s: Situation, config: CompanionConfig) -> float:
    """Return how far the waiting point is above a drone at this height in W: one that flies may wait higher already."""
    flies = s.autopilot.armed and s.autopilot.landed is False
    return too_low_m(height_enu_m, s, config) if flies else config.takeoff.waiting_height_m


def too_low_m(height_enu_m: float, s: Situation, config: CompanionConfig) -> float:
    """Return how far below the height of waiting a drone at this height in W is, 0 where it is not.

    Where no range finder has told the ground, it is taken to be where the autopilot's local frame began.
    """
    return min(max(waiting_height_m(s, config) - height_enu_m, 0.0), config.takeoff.waiting_height_m)


def waiting_height_m(s: Situation, config: CompanionConfig) -> float:
    """Return the height in W at which a vehicle is waited for."""
    return _feet_on_ground_m(s) + config.takeoff.waiting_height_m


def _feet_on_ground_m(s: Situation) -> float:
    """Return the height in W of a drone that stands on the ground."""
    ground = s.below.ground_enu_m
    return s.feet_offset_m + (0.0 if ground is None else float(ground[2]))
