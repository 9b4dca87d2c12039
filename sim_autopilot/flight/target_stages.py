"""PX4's precision landing: from stage to stage by what is seen of the landing target.

It goes to where it began or to the target at its own height, sinks once it has been over the target for 2 s, and lands
where it last saw it when that is lost near the ground. A target lost before is looked for from higher up, a few
times; then it lands where it is. Nothing is known of the target's motion: the place that is flown to is the last one
seen, so a drone trails behind a target that moves. Source: PX4 1.17, parameter reference PLD_* and the documentation
of its precision landing; its states and times.
"""

from dataclasses import dataclass
from enum import Enum
from math import hypot

from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.land_settings import TargetSettings
from sim_autopilot.flight.precision_landing import Target
from sim_autopilot.plant.snapshot import Snapshot

_STEADY_S = 2.0
"""At the start without a target, and over the target, before it goes on."""
_CLEAR_S = 0.5
"""Near the ground a target that was not seen for so long is lost."""
_SETTLES_S, _STOPS_WITHIN_M = 1.0, 1.0
"""Of a climb that ends because the target is seen."""


class Stage(Enum):
    """What the landing does."""

    START = "start"  # at a place, until the target is seen
    APPROACH = "approach"  # over the target, at its own height
    DESCEND = "descend"  # sinks, over the target
    FINAL = "final"  # sinks where the target was
    SEARCH = "search"  # climbs, until the target is seen
    FALLBACK = "fallback"  # lands without it


SINKING = frozenset({Stage.DESCEND, Stage.FINAL, Stage.FALLBACK})


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetLanding:
    """What the landing remembers.

    Attributes:
        stage: that it is in.
        began_ns: of the stage, since boot.
        place_enu_m: that it flies to, or sinks at.
        starts: how often it has begun.
        since_ns: when it reached the place, or saw the target in a search; None before.
        seen_ns: of the sighting that was used last.
    """

    stage: Stage
    began_ns: int
    place_enu_m: Vector3
    starts: int = 1
    since_ns: int | None = None
    seen_ns: int = -1


def begin_target_landing(place_enu_m: Vector3, boot_ns: int) -> TargetLanding:
    """Return the landing as it begins, at `place_enu_m`."""
    return TargetLanding(stage=Stage.START, began_ns=boot_ns, place_enu_m=place_enu_m)


def next_stage(  # noqa: PLR0917 (from where, to what, who, as told, above what, how near is there)
    landing: TargetLanding,
    target: Target | None,
    now: Snapshot,
    settings: TargetSettings,
    home_m: float,
    reached_m: float,
) -> TargetLanding:
    """Return the landing after a look at the target.

    Args:
        landing: as it was.
        target: as seen last.
        now: the drone.
        settings: what the PLD parameters amount to.
        home_m: height of home.
        reached_m: how near to a place is there.
    """
    sight = _Sight(landing, target, now, settings)
    match landing.stage:
        case Stage.START:
            landing = _start(landing, sight, now, settings, home_m, reached_m)
        case Stage.APPROACH:
            landing = _approach(landing, sight, now, settings)
        case Stage.DESCEND:
            landing = _descend(landing, sight, now, settings)
        case Stage.SEARCH:
            landing = _search(landing, sight, now, settings)
        case Stage.FINAL | Stage.FALLBACK:
            pass
    return landing if target is None else replace(landing, seen_ns=target.seen_ns)


class _Sight:
    """What is known of the target now."""

    def __init__(self, landing: TargetLanding, target: Target | None, now: Snapshot, settings: TargetSettings) -> None:
        self.age_s = float("inf") if target is None else (now.boot_ns - target.seen_ns) * 1e-9
        self.is_valid = self.age_s <= settings.lost_s
        self.is_new = self.is_valid and target is not None and target.seen_ns != landing.seen_ns
        place = now.position_enu_m if target is None else target.position_enu_m
        self.place = place
        off = (place[0] - now.position_enu_m[0], place[1] - now.position_enu_m[1])
        self.is_below = max(abs(off[0]), abs(off[1])) < settings.within_m
        self.is_low = self.is_valid and now.position_enu_m[2] - place[2] < settings.final_m


def _start(  # noqa: PLR0917 (as `next_stage`)
    landing: TargetLanding, sight: _Sight, now: Snapshot, settings: TargetSettings, home_m: float, reached_m: float
) -> TargetLanding:
    if sight.is_new:
        return _to(landing, Stage.APPROACH, now, now.position_enu_m)
    x, y, _ = landing.place_enu_m
    if hypot(x - now.position_enu_m[0], y - now.position_enu_m[1]) >= reached_m:
        return landing
    if settings.search_s <= 0.0:
        return _fall_back(landing, now)
    landing = _since(landing, now)
    if not _for(landing, now, _STEADY_S):
        return landing
    return _to(landing, Stage.SEARCH, now, (x, y, home_m + settings.search_m))


def _approach(landing: TargetLanding, sight: _Sight, now: Snapshot, settings: TargetSettings) -> TargetLanding:
    if sight.is_below and not sight.is_valid:
        return _start_again(landing, now, settings)
    if sight.is_new and sight.is_below:
        landing = _since(landing, now)
        if _for(landing, now, _STEADY_S):
            return _to(landing, Stage.DESCEND, now, sight.place)
    return replace(landing, place_enu_m=(sight.place[0], sight.place[1], landing.place_enu_m[2]))


def _descend(landing: TargetLanding, sight: _Sight, now: Snapshot, settings: TargetSettings) -> TargetLanding:
    if sight.is_low and sight.age_s >= _CLEAR_S:
        return _to(landing, Stage.FINAL, now, landing.place_enu_m)
    if not sight.is_valid:
        return _start_again(landing, now, settings)
    return replace(landing, place_enu_m=sight.place)


def _search(landing: TargetLanding, sight: _Sight, now: Snapshot, settings: TargetSettings) -> TargetLanding:
    if landing.since_ns is None and sight.is_new:
        x, y, z = landing.place_enu_m
        landing = replace(_since(landing, now), place_enu_m=(x, y, min(z, now.position_enu_m[2] + _STOPS_WITHIN_M)))
    if sight.is_new and _for(landing, now, _SETTLES_S):
        return _to(landing, Stage.APPROACH, now, now.position_enu_m)
    return _fall_back(landing, now) if (now.boot_ns - landing.began_ns) * 1e-9 > settings.search_s else landing


def _start_again(landing: TargetLanding, now: Snapshot, settings: TargetSettings) -> TargetLanding:
    if landing.starts > settings.searches_max:
        return _fall_back(landing, now)
    return replace(_to(landing, Stage.START, now, now.position_enu_m), starts=landing.starts + 1)


def _fall_back(landing: TargetLanding, now: Snapshot) -> TargetLanding:
    return _to(landing, Stage.FALLBACK, now, now.position_enu_m)


def _to(landing: TargetLanding, stage: Stage, now: Snapshot, place_enu_m: Vector3) -> TargetLanding:
    return replace(landing, stage=stage, began_ns=now.boot_ns, place_enu_m=place_enu_m, since_ns=None)


def _since(landing: TargetLanding, now: Snapshot) -> TargetLanding:
    return replace(landing, since_ns=now.boot_ns) if landing.since_ns is None else landing


def _for(landing: TargetLanding, now: Snapshot, duration_s: float) -> bool:
    return landing.since_ns is not None and (now.boot_ns - landing.since_ns) * 1e-9 > duration_s
