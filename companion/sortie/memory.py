"""The memory of a sortie, from its launch or first station until the drone is home; pure."""

import numpy as np
from msgspec import Struct, field

from companion.core.data import Array
from companion.core.reasons import Cause
from companion.sortie.energy import BatteryWatch
from link.messages import Station
from link.records import replace


class Way(Struct, frozen=True, kw_only=True, eq=False):
    """The way to a station.

    Attributes:
        station: at its end.
        place_m: (3,) on it, ahead, left and up of the pad's centre, where the drone is to be now.
        at_ns: when that was so, monotonic.
    """

    station: Station
    place_m: Array
    at_ns: int


class SortieMemory(Struct, frozen=True, kw_only=True, eq=False):
    """A sortie.

    Attributes:
        is_out: one is under way.
        station: that is kept, or was last.
        way: to the station; None while none is kept.
        ahead_rad: where ahead was when it could be told, from East counter-clockwise.
        follows: the drone is to stay out beside the vehicle; otherwise it is on its way home, or lands.
        place_enu_m: (3,) where a silent vehicle is looked for; None while it is heard.
        found_since_ns: since when a vehicle that was silent is heard again, monotonic; None while it is not.
        quiet_since_ns: since when the deck is quiet, monotonic; None while it is not.
        battery: over the flight.
        warning: what the pilot is told of the way home, None while there is time.
    """

    is_out: bool = False
    station: Station | None = None
    way: Way | None = None
    ahead_rad: float = 0.0
    follows: bool = False
    place_enu_m: Array | None = None
    found_since_ns: int | None = None
    quiet_since_ns: int | None = None
    battery: BatteryWatch = field(default_factory=BatteryWatch)
    warning: Cause | None = None


def move_sortie(sortie: SortieMemory, by_enu_m: Array) -> SortieMemory:
    """Return the sortie in a frame that has moved by as much (3,)."""
    if sortie.place_enu_m is None:
        return sortie
    return replace(sortie, place_enu_m=np.asarray(sortie.place_enu_m + by_enu_m))
