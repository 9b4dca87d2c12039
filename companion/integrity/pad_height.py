"""The pad's height where the drone's own height wanders: as its range finder sees the pad below; pure."""

from companion.config.companion import CompanionConfig
from companion.situation.phases import LANDING_PHASES, Phase
from companion.situation.situation import Situation, with_pad
from companion.vehicle.pad_reach import over_pad_radius_m
from link.records import replace

RAISED_MAX_M = 1.0  # what is farther off is not the pad: a roof is 1.5 m above the road
_SLEW_M_S = 0.5
_OVER_PHASES = LANDING_PHASES | {Phase.TOUCHDOWN}


def update_pad_raised_m(raised_m: float, phase: Phase, situation: Situation, config: CompanionConfig) -> float:
    """Return by how much the pad is to be raised in the drone's frame.

    Args:
        raised_m: so far.
        phase: of the landing; only over the pad the range finder sees it.
        situation: with the pad where the vehicle says that it is.
        config: all numbers.
    """
    if phase not in _OVER_PHASES or not config.touchdown.range_corrects_height:
        return 0.0
    relative, seen_m = situation.approach, situation.below.range_height_m
    if relative is None or seen_m is None:
        return raised_m
    if relative.distance_m > over_pad_radius_m(relative.pad_half_width_m, config):
        return raised_m
    off_m = relative.height_m - seen_m
    if abs(off_m) > RAISED_MAX_M:
        return raised_m
    step_m = _SLEW_M_S / config.step_rate_hz
    return raised_m + min(max(off_m - raised_m, -step_m), step_m)


def with_pad_raised(situation: Situation, raised_m: float) -> Situation:
    """Return the facts with the pad raised."""
    if situation.pad is None or not raised_m:
        return situation
    position = situation.pad.position_enu_m.copy()
    position[:, 2] += raised_m
    return with_pad(situation, replace(situation.pad, position_enu_m=position))
