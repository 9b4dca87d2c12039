"""How long the battery lasts, from BATTERY_STATUS and how fast it has fallen; pure.

The share comes in whole percents. Between two changes of it the time tells the rate of use, over the last half
minute or more of this flight. What is left is taken for a percent less than told.
"""

import math

from msgspec import Struct

from link.records import replace

RESOLUTION = 0.01
"""Of BATTERY_STATUS, battery_remaining: MAVLink, common.xml."""
_SPAN_MIN_S = 30.0
"""No rate is taken over less: a dash takes two to three times a hover's power for some seconds, and the voltage that
sags under it has two percents told at once."""
_CHANGES_MAX = 8  # one in 12 s at 20 minutes' endurance: the rate of the last minute and a half


class BatteryWatch(Struct, frozen=True, kw_only=True):
    """The battery over a flight.

    Attributes:
        share: that was told last, 0 to 1; None before the first.
        changes: (monotonic ns, share) each time that it became less, oldest first.
    """

    share: float | None = None
    changes: tuple[tuple[int, float], ...] = ()


def update_battery(watch: BatteryWatch, share: float | None, monotonic_ns: int) -> BatteryWatch:
    """Return the watch after what is told now; a battery that has become fuller is another one."""
    if share is None or share == watch.share:
        return watch
    if watch.share is None or share > watch.share:
        return BatteryWatch(share=share)
    return replace(watch, share=share, changes=(*watch.changes, (monotonic_ns, share))[-_CHANGES_MAX:])


def use_per_s(watch: BatteryWatch) -> float | None:
    """Return the share that is used in a second, None until it has changed at two times."""
    if len(watch.changes) < 2:
        return None
    (first_ns, first), (last_ns, last) = watch.changes[0], watch.changes[-1]
    if last_ns <= first_ns:
        return None
    return (first - last) / max((last_ns - first_ns) * 1e-9, _SPAN_MIN_S)


def left_s(watch: BatteryWatch, reserve_share: float) -> float:
    """Return for how long the drone can fly before only the reserve is left; infinite while nothing tells.

    Without a rate all that can be said is whether the reserve is reached.
    """
    if watch.share is None:
        return math.inf
    usable = watch.share - RESOLUTION - reserve_share
    rate = use_per_s(watch)
    if rate is None:
        return math.inf if usable > 0.0 else 0.0
    return max(usable, 0.0) / rate
