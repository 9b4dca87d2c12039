"""The drone's attitude at the time of a frame, from the companion's reports."""

from bisect import bisect_left

from msgspec import Struct

from link.frames.rotations import normalized
from link.messages import Quaternion

GAP_MAX_NS = 150_000_000
"""As the companion itself: a drone that turns at 0.5 rad/s is then 4 degrees off."""

_HISTORY = 32  # a second and more of what the companion tells


class Attitude(Struct, frozen=True, kw_only=True):
    """q_WB at `t_ns` (UTC)."""

    t_ns: int
    orientation_wxyz: Quaternion


def with_attitude(history: tuple[Attitude, ...], attitude: Attitude) -> tuple[Attitude, ...]:
    """Return the history, oldest first, with an attitude that is told; it begins anew where the clock was set back."""
    if not history or attitude.t_ns < history[-1].t_ns:
        return (attitude,)
    if attitude.t_ns == history[-1].t_ns:  # of a step of the companion without a new state of the drone
        return history
    return (*history[1 - _HISTORY :], attitude)


def attitude_at(history: tuple[Attitude, ...], t_ns: int) -> Quaternion | None:
    """Return q_WB at `t_ns` between two attitudes, or the nearest one, None where none is near enough.

    Args:
        history: oldest first.
        t_ns: UTC.
    """
    after = bisect_left(history, t_ns, key=lambda one: one.t_ns)
    near = history[max(after - 1, 0) : after + 1]
    if not near or min(abs(one.t_ns - t_ns) for one in near) > GAP_MAX_NS:
        return None
    if len(near) == 1 or t_ns <= near[0].t_ns or near[1].t_ns == near[0].t_ns:
        return near[-1].orientation_wxyz if t_ns > near[-1].t_ns else near[0].orientation_wxyz
    share = (t_ns - near[0].t_ns) / (near[1].t_ns - near[0].t_ns)
    a, b = near[0].orientation_wxyz, near[1].orientation_wxyz
    sign = 1.0 if sum(x * y for x, y in zip(a, b, strict=True)) >= 0.0 else -1.0
    w, x, y, z = ((1.0 - share) * p + share * sign * q for p, q in zip(a, b, strict=True))
    return normalized((w, x, y, z))
