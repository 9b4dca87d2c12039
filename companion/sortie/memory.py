"""The memory of a sortie, from its launch or first station until the drone is home, and how long its battery lasts.

BATTERY_STATUS has the share in whole percents. Between two new lows of it the time tells the rate of use, over the last
half minute or more of this flight; it also rises, where a voltage recovers that had sagged. A low above which all that
is told has stayed for half a minute was none: neither a sag nor a false report lasts so long. What is left is taken
for a percent less than told, and for less by what the rate has used since the last change, so that it also falls
where nothing tells it any more.
"""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from companion.core.reasons import Cause
from link.messages import Station, StationFrame
from link.records import replace

RESOLUTION = 0.01
"""Of BATTERY_STATUS, battery_remaining: MAVLink, common.xml."""
_SPAN_MIN_S = 30.0
"""No rate is taken over less: a dash takes two to three times a hover's power for some seconds, and the voltage that
sags under it has two percents told at once."""
_LOWS_MAX = 8  # one in 12 s at 20 minutes' endurance: the rate of the last minute and a half


class BatteryWatch(Struct, frozen=True, kw_only=True):
    """The battery over a flight.

    Attributes:
        share: that was told last, 0 to 1; None before the first.
        told_ns: when it changed last, monotonic.
        lows: (monotonic ns, share) each time that it became less than ever before, oldest first.
        above_ns: since when more than the last of them has been told, monotonic; None while it has not.
    """

    share: float | None = None
    told_ns: int = 0
    lows: tuple[tuple[int, float], ...] = ()
    above_ns: int | None = None


UNTOLD = BatteryWatch()
"""Before a flight."""


def update_battery(watch: BatteryWatch, share: float | None, monotonic_ns: int) -> BatteryWatch:
    """Return the watch after what is told now."""
    if share is None:
        return watch
    watch = _without_false_lows(watch, share, monotonic_ns)
    if share == watch.share:
        return watch
    told = replace(watch, share=share, told_ns=monotonic_ns)
    lowest = watch.lows[-1][1] if watch.lows else watch.share
    if lowest is None or share >= lowest:
        return told
    return replace(told, lows=(*watch.lows, (monotonic_ns, share))[-_LOWS_MAX:])


def _without_false_lows(watch: BatteryWatch, share: float, monotonic_ns: int) -> BatteryWatch:
    if not watch.lows or share <= watch.lows[-1][1]:
        return watch if watch.above_ns is None else replace(watch, above_ns=None)
    if watch.above_ns is None:
        return replace(watch, above_ns=monotonic_ns)
    if (monotonic_ns - watch.above_ns) * 1e-9 < _SPAN_MIN_S:
        return watch
    return replace(watch, lows=tuple(low for low in watch.lows if low[1] >= share), above_ns=None)


def use_per_s(watch: BatteryWatch) -> float | None:
    """Return the share that is used in a second, None until it has become less at two times."""
    if len(watch.lows) < 2:
        return None
    (first_ns, first), (last_ns, last) = watch.lows[0], watch.lows[-1]
    if last_ns <= first_ns:
        return None
    return (first - last) / max((last_ns - first_ns) * 1e-9, _SPAN_MIN_S)


def left_s(watch: BatteryWatch, reserve_share: float, monotonic_ns: int) -> float:
    """Return for how long from now the drone can fly before only the reserve is left; infinite while nothing tells.

    Without a rate all that can be said is whether the reserve is reached.
    """
    if watch.share is None:
        return math.inf
    rate = use_per_s(watch)
    if rate is None:
        return math.inf if watch.share - RESOLUTION > reserve_share else 0.0
    used = rate * (monotonic_ns - watch.told_ns) * 1e-9
    return max(watch.share - max(RESOLUTION, used) - reserve_share, 0.0) / rate


class Way(Struct, frozen=True, kw_only=True, eq=False):
    """The way to a station.

    Attributes:
        station: that was ordered.
        frame: that it is laid in: the station's, or north where the vehicle turns too fast for a place so far from it.
        end_m: (3,) at its end in the station's frame, farther out or higher where the vehicle's place is vague.
        place_m: (3,) on it, ahead, left and up of the pad's centre, where the drone is to be now.
        at_ns: when that was so, monotonic.
    """

    station: Station
    frame: StationFrame
    end_m: Array
    place_m: Array
    at_ns: int


class SortieMemory(Struct, frozen=True, kw_only=True, eq=False):
    """A sortie.

    Attributes:
        is_out: one is under way.
        station: that is kept, or was last.
        way: to the station; None while none is kept.
        ahead_rad: where ahead was when it could be told, from East counter-clockwise.
        was_due: the battery has called the drone home since an operator sent it out.
        stays_out: an operator has stopped it after that, so that it does not set out by itself.
        follows: the drone is to stay out beside the vehicle; otherwise it is on its way home, or lands.
        place_enu_m: (3,) where a silent vehicle is looked for; None while it is heard.
        found_since_ns: since when a vehicle that was silent is heard again, monotonic; None while it is not.
        quiet_since_ns: since when the deck is quiet, monotonic; None while it is not.
        idles_since_ns: since when the motors turn on the deck, monotonic; None while they do not.
        battery: over the flight.
        warning: what the pilot is told of the way home, None while there is time.
    """

    is_out: bool = False
    station: Station | None = None
    way: Way | None = None
    ahead_rad: float = 0.0
    was_due: bool = False
    stays_out: bool = False
    follows: bool = False
    place_enu_m: Array | None = None
    found_since_ns: int | None = None
    quiet_since_ns: int | None = None
    idles_since_ns: int | None = None
    battery: BatteryWatch = UNTOLD
    warning: Cause | None = None


def move_sortie(sortie: SortieMemory, by_enu_m: Array) -> SortieMemory:
    """Return the sortie in a frame that has moved by as much (3,)."""
    if sortie.place_enu_m is None:
        return sortie
    return replace(sortie, place_enu_m=np.asarray(sortie.place_enu_m + by_enu_m))
