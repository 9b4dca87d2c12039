"""A drone that loses its model again and again: for how long, and whether it goes where the plans lead; pure numerics.

A path of limited jerk that is late swings about its setpoints, yet takes up the speeds that they ask for. A drone that
does not heed them goes on evenly, or stops.
"""

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from link.records import replace

LOST_FOR_S = 2.0
"""In which a drone that does not heed its setpoints is told from one that swings about them."""

_FOLLOWS_S = 1.0  # without being lost: the time constant of a position loop, 1 / K_p
_MOST = 0.5  # of what is asked for


class Losses(Struct, frozen=True, kw_only=True, eq=False):
    """The reports at which the model was put at a drone that had lost it, each within a second of the one before.

    Attributes:
        since_ns: monotonic time of the first.
        newest_ns: of the last.
        velocity_enu_m_s: (2,) horizontal velocity of the drone at the first.
        missed_m_s: (2,) sum of its velocities against the model at those after the first.
        asked_m_s: (2,) by how much the plans have changed its velocity from the first to the last, had it followed.
    """

    since_ns: int
    newest_ns: int
    velocity_enu_m_s: Array
    missed_m_s: Array
    asked_m_s: Array


def add_loss(losses: Losses | None, t_ns: int, velocity_enu_m_s: Array, from_model_m_s: Array) -> Losses:
    """Return the losses with one more.

    Args:
        losses: before, None of a drone that has followed so far.
        t_ns: monotonic time of the report.
        velocity_enu_m_s: (2,) horizontal velocity of the drone then.
        from_model_m_s: (2,) the same against the model.
    """
    if losses is None or not _goes_on(losses, t_ns):
        none = np.zeros(2)
        return Losses(since_ns=t_ns, newest_ns=t_ns, velocity_enu_m_s=velocity_enu_m_s, missed_m_s=none, asked_m_s=none)
    missed_m_s = losses.missed_m_s + from_model_m_s
    asked_m_s = velocity_enu_m_s - losses.velocity_enu_m_s - missed_m_s
    return replace(losses, newest_ns=t_ns, missed_m_s=missed_m_s, asked_m_s=asked_m_s)


def lost_for_s(losses: Losses | None, monotonic_ns: int) -> float:
    """Return for how long the drone has lost its model again and again.

    It is 0 of one that has followed for a second, or has made most of the changes of speed that were asked for.
    """
    if losses is None or _has_followed(losses, monotonic_ns) or _makes_most(losses):
        return 0.0
    return (monotonic_ns - losses.since_ns) * 1e-9


def _goes_on(losses: Losses, t_ns: int) -> bool:
    """Return whether a loss belongs to these; a drone that has made most of them for long is judged anew."""
    is_judged = (losses.newest_ns - losses.since_ns) * 1e-9 > LOST_FOR_S
    return not (_has_followed(losses, t_ns) or (is_judged and _makes_most(losses)))


def _has_followed(losses: Losses, monotonic_ns: int) -> bool:
    return (monotonic_ns - losses.newest_ns) * 1e-9 > _FOLLOWS_S


def _makes_most(losses: Losses) -> bool:
    return float(np.linalg.norm(losses.missed_m_s)) < (1.0 - _MOST) * float(np.linalg.norm(losses.asked_m_s))
