"""A drone that loses its model again and again: for how long, and whether it goes where the plans lead; pure numerics.

A path of limited jerk that is late swings about its setpoints and is off them by decimetres, yet leads where they do.
One that does not heed them goes on evenly, or stops.
"""

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from companion.planning.guidance import ReferenceState
from link.records import replace

LOST_FOR_S = 2.0
"""In which a drone that does not heed its setpoints is told from one that swings about them."""

_FOLLOWS_S = 1.0  # without being lost: the time constant of a position loop, 1 / K_p
_MOST = 0.5  # of the way that is asked for


class Losses(Struct, frozen=True, kw_only=True, eq=False):
    """The reports at which the model was put at a drone that had lost it, each within a second of the one before.

    Attributes:
        since_ns: monotonic time of the first.
        newest_ns: of the last.
        place_enu_m: (2,) horizontal place of the drone at the first.
        velocity_enu_m_s: (2,) its velocity then.
        missed_m: (2,) sum of the ways from the model to the drone at those after the first.
        asked_m: (2,) how far the plans have led beyond an even flight from the first to the last.
    """

    since_ns: int
    newest_ns: int
    place_enu_m: Array
    velocity_enu_m_s: Array
    missed_m: Array
    asked_m: Array


def add_loss(losses: Losses | None, t_ns: int, drone: ReferenceState, from_model_m: Array) -> Losses:
    """Return the losses with one more.

    Args:
        losses: before, None of a drone that has followed so far.
        t_ns: monotonic time of the report.
        drone: how it moves then.
        from_model_m: (2,) horizontal way from the model to it.
    """
    place_m = drone.position_enu_m[:2]
    if losses is None or not _goes_on(losses, t_ns):
        none = np.zeros(2)
        velocity_m_s = drone.velocity_enu_m_s[:2]
        return Losses(
            since_ns=t_ns,
            newest_ns=t_ns,
            place_enu_m=place_m,
            velocity_enu_m_s=velocity_m_s,
            missed_m=none,
            asked_m=none,
        )
    missed_m = losses.missed_m + from_model_m
    evenly_m = losses.place_enu_m + (t_ns - losses.since_ns) * 1e-9 * losses.velocity_enu_m_s
    return replace(losses, newest_ns=t_ns, missed_m=missed_m, asked_m=place_m - evenly_m - missed_m)


def move_losses(losses: Losses | None, by_enu_m: Array) -> Losses | None:
    """Return the losses in a frame in which all places are moved by (3,)."""
    return None if losses is None else replace(losses, place_enu_m=losses.place_enu_m + by_enu_m[:2])


def lost_for_s(losses: Losses | None, monotonic_ns: int) -> float:
    """Return for how long the drone has lost its model again and again.

    It is 0 of one that has followed for a second, or has made most of the way that was asked for meanwhile.
    """
    if losses is None or _has_followed(losses, monotonic_ns) or _makes_most(losses):
        return 0.0
    return (monotonic_ns - losses.since_ns) * 1e-9


def _goes_on(losses: Losses, t_ns: int) -> bool:
    """Return whether a loss belongs to these; a drone that has made most of the way for long is judged anew."""
    is_judged = (losses.newest_ns - losses.since_ns) * 1e-9 > LOST_FOR_S
    return not (_has_followed(losses, t_ns) or (is_judged and _makes_most(losses)))


def _has_followed(losses: Losses, monotonic_ns: int) -> bool:
    return (monotonic_ns - losses.newest_ns) * 1e-9 > _FOLLOWS_S


def _makes_most(losses: Losses) -> bool:
    return float(np.linalg.norm(losses.missed_m)) < (1.0 - _MOST) * float(np.linalg.norm(losses.asked_m))
