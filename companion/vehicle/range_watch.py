"""Which readings of the drone's range finder can be believed, and how far what is below rises above the road; pure."""

import numpy as np
from msgspec import Struct

from companion.core.data import OwnState, RangeReading
from link.frames.rotations import rotate
from link.messages import Vector3
from link.records import replace

_UNSEEN_M = 0.05  # which a drone has risen or sunk while every reading is the same to the centimetre: nothing measures
_AGREEING = 5  # readings in a row: one or two may be of anything
_AGREEING_M = 0.15  # of their median: a deck that heaves at 0.5 m/s has moved by as much within them
_AGREEING_S = 0.6  # of a range finder at 10 Hz
ATTITUDE_AGE_MAX_S = 0.15  # of a drone that turns at 0.5 rad/s: what is seen 5 m away is then 0.4 m off
_UPRIGHT_MIN = 0.917  # 23 degrees; one that leans more turns too fast for the attitude to be that of the reading
_CORRECTED_M = 0.3  # from one reading to the next no road climbs by as much: what was believed of the vehicle changed
_LATELY_S = 10.0  # in which a drone comes from behind a vehicle to over it, and its own height wanders by half a metre


class RangeWatch(Struct, frozen=True, kw_only=True):
    """The last readings.

    Attributes:
        newest_ns: when the newest was measured.
        same: the first of the newest ones that are all the same.
        recent: the last few surfaces, which have to agree: when each was seen, and its height in W.
        vehicle_up_m: height of the vehicle in W at the newest that was believed, None before.
        lowest: surfaces lower than all after them, of the last seconds: when each was seen, and its height over the
            vehicle, so that a road that climbs does not rise.
    """

    newest_ns: int | None = None
    same: RangeReading | None = None
    recent: tuple[tuple[int, float], ...] = ()
    vehicle_up_m: float | None = None
    lowest: tuple[tuple[int, float], ...] = ()


def watch_ranges(watch: RangeWatch, seen: RangeReading, vehicle_up_m: float | None) -> tuple[RangeWatch, float | None]:
    """Return what is kept, and how far the surface is above the lowest one lately, m; None of what is not believed.

    Args:
        watch: before.
        seen: a new reading.
        vehicle_up_m: height of the vehicle in W then, None while it is not known.
    """
    same = watch.same
    is_same = same is not None and same.own is not None and seen.distance_m == same.distance_m
    watch = replace(watch, newest_ns=seen.t_ns, same=watch.same if is_same else seen)
    here_m = _surface_m(seen)
    if here_m is None:
        return watch, None
    watch = replace(watch, recent=(*watch.recent, (seen.t_ns, here_m))[-_AGREEING:])
    if vehicle_up_m is None or _is_stuck(watch, seen) or _is_alone(watch.recent):
        return watch, None
    over_m, oldest_ns = here_m - vehicle_up_m, seen.t_ns - round(_LATELY_S * 1e9)
    is_corrected = watch.vehicle_up_m is not None and abs(vehicle_up_m - watch.vehicle_up_m) > _CORRECTED_M
    before = () if is_corrected else watch.lowest
    lower = tuple(one for one in before if oldest_ns <= one[0] <= seen.t_ns and one[1] < over_m)
    lowest = (*lower, (seen.t_ns, over_m))
    return replace(watch, vehicle_up_m=vehicle_up_m, lowest=lowest), over_m - lowest[0][1]


def lowest_over_m(watch: RangeWatch, t_ns: int) -> float | None:
    """Return how high over the vehicle the lowest surface is that was seen lately, None where nothing was."""
    oldest_ns = t_ns - round(_LATELY_S * 1e9)
    return next((over_m for seen_ns, over_m in watch.lowest if seen_ns >= oldest_ns), None)


def moved_up(watch: RangeWatch, up_m: float) -> RangeWatch:
    """Return the watch in a W that the drone has stepped up in by `up_m`, with all that it sees.

    Whether a reading stays the same is asked anew: the drone's own height has changed without its rising.
    """
    recent = tuple((t_ns, height_m + up_m) for t_ns, height_m in watch.recent)
    vehicle_up_m = None if watch.vehicle_up_m is None else watch.vehicle_up_m + up_m
    return replace(watch, same=None, recent=recent, vehicle_up_m=vehicle_up_m)


def _is_stuck(watch: RangeWatch, seen: RangeReading) -> bool:
    """Return whether the range finder says the same while the drone rises or sinks."""
    if watch.same is None or watch.same.own is None or seen.own is None:
        return False
    return abs(seen.own.position_enu_m[2] - watch.same.own.position_enu_m[2]) > _UNSEEN_M


def _is_alone(recent: tuple[tuple[int, float], ...]) -> bool:
    """Return whether the last surface does not agree with most, or too few were seen within a while."""
    (since_ns, _), (t_ns, here_m) = recent[0], recent[-1]
    if len(recent) < _AGREEING or (t_ns - since_ns) * 1e-9 > _AGREEING_S:
        return True
    return abs(here_m - float(np.median([height_m for _, height_m in recent]))) > _AGREEING_M


def beam_of(own: OwnState) -> Vector3 | None:
    """Return where the range finder looks in W, None of a drone that leans too far or whose attitude is old."""
    beam = rotate(own.orientation_wxyz, (0.0, 0.0, -1.0))
    return None if own.attitude_age_s > ATTITUDE_AGE_MAX_S or -beam[2] < _UPRIGHT_MIN else beam


def _surface_m(seen: RangeReading) -> float | None:
    """Return the height in W of what was seen, as of the point whose place is reported, None if that was not known."""
    beam = None if seen.own is None else beam_of(seen.own)
    return None if seen.own is None or beam is None else seen.own.position_enu_m[2] + seen.distance_m * beam[2]
