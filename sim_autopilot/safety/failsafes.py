"""The failsafes that do not come from setpoints: battery, ground station, fence; each acts once, when it begins."""

from msgspec import Struct

from link.records import replace
from sim_autopilot.core.modes import Event
from sim_autopilot.core.settings import FailsafeSettings
from sim_autopilot.missions.fence import Fence, is_allowed, is_near_home


class Watch(Struct, frozen=True, kw_only=True):
    """What was noticed: the battery's level (0 is good), a fence left, since when the station is lost, whether acted.

    `station_ns` is when a ground station was last heard, None before the first; `companion_ns` when a companion was;
    `sticks_lost_ns` since when it holds because the sticks were let go of.
    """

    level: int = 0
    outside: bool = False
    station_ns: int | None = None
    companion_ns: int | None = None
    lost_ns: int | None = None
    acted: bool = False
    sticks_lost_ns: int | None = None

    @property
    def waits(self) -> bool:
        """Whether it holds before it does what a loss leads to."""
        return self.sticks_lost_ns is not None or (self.lost_ns is not None and not self.acted)


NOTHING_NOTICED = Watch()


def watch_battery(watch: Watch, charge: float, settings: FailsafeSettings) -> tuple[Watch, Event | None]:
    """Return what the battery's `charge`, a share of its capacity, leads to."""
    level = sum(charge <= threshold for threshold in settings.battery_levels)
    if level <= watch.level:
        return watch if level == watch.level else replace(watch, level=level), None
    return replace(watch, level=level), settings.battery_events[level - 1]


def watch_fence(
    watch: Watch,
    fence: Fence,
    position_enu_m: tuple[float, float, float],
    home_enu_m: tuple[float, float, float],
    settings: FailsafeSettings,
) -> tuple[Watch, Event | None]:
    """Return what being at `position_enu_m` leads to."""
    near = is_near_home(position_enu_m, home_enu_m, settings.reach_m, settings.height_m)
    outside = not (near and (not settings.areas_count or is_allowed(fence, position_enu_m)))
    if outside == watch.outside:
        return watch, None
    return replace(watch, outside=outside), settings.fence_event if outside else None


def watch_station(watch: Watch, boot_ns: int, settings: FailsafeSettings) -> tuple[Watch, Event | None]:
    """Return what a silent ground station leads to: a hold first, and then the rest."""
    if watch.station_ns is None or settings.station_event is None:
        return watch, None
    if (boot_ns - watch.station_ns) * 1e-9 <= settings.station_lost_s:
        return (watch if watch.lost_ns is None else replace(watch, lost_ns=None, acted=False)), None
    if watch.lost_ns is None and settings.hold_s is None:
        return replace(watch, lost_ns=boot_ns, acted=True), settings.station_event
    if watch.lost_ns is None:
        return replace(watch, lost_ns=boot_ns), Event.FAILSAFE_HOLD
    if watch.acted or settings.hold_s is None or (boot_ns - watch.lost_ns) * 1e-9 < settings.hold_s:
        return watch, None
    return replace(watch, acted=True), settings.station_event
