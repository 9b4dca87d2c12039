"""Whether the vehicle's fixes come from the future, late or too rarely, and whether their stamps have stepped; pure.

The age of a fix, as it comes, is the link's delay plus the difference of the two clocks. The delay changes from fix to
fix. When a clock is set, the vehicle's or the one that the autopilot's UTC comes from, all later fixes are older, or
younger, by as much. It shows once all fixes of the last second, four at least, are older than any of the seconds
before, or all are younger. The pad is then believed elsewhere on the vehicle's way, and nobody knows which of the two
times was right. A link that became slower makes fixes older, too, but puts none of them elsewhere on that way.
"""

from itertools import pairwise
from typing import NamedTuple

from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.core.data import FIXED_STD_MAX_M
from companion.core.reasons import Cause, Reason
from companion.integrity.way import WayError
from companion.situation.situation import Situation
from companion.vehicle.pad_reach import cone_radius_at_pad_m
from link.records import replace

_RECENT_NS = 1_000_000_000
_KEPT_NS = 10_000_000_000
_KNOWN_NS = 60_000_000_000  # after which nobody remembers another clock
_RECENT_MIN, _EARLIER_MIN = 4, 10  # fixes
_REFINED_S = 0.05  # by which the map to UTC may be refined at once

_OF_STAMPS = frozenset({Reason.STAMPS_AHEAD, Reason.STAMPS_LATE, Reason.FIXES_RARE})
_OF_CLOCK = 0.5  # share of a step of the ages by which the places step along the way as well, or the link is slower


class Arrival(NamedTuple):
    """A fix as it came.

    Attributes:
        at_ns: when it came, monotonic.
        age_s: how old it was then, by its stamp.
        ahead_s: of where it was expected on the vehicle's way, as `WayError` has it; None where that is not known.
    """

    at_ns: int
    age_s: float
    ahead_s: float | None = None


Ages = tuple[Arrival, ...]
"""Oldest first."""


class FixStamps(Struct, frozen=True, kw_only=True):
    """The newest accepted fix, and how old those of the last seconds were when they came.

    Attributes:
        newest_ns: when the newest accepted fix was taken, by its own stamp; None before the first.
        age_on_arrival_s: of that fix, or of one that was refused since then, when it came; not negative if both clocks
            are right.
        ages: the fixes of the last seconds; after a step, those before it.
        recent: the newest fixes, after a step; empty where there was none.
        stepped_s: by how much fixes are older since a clock was set, negative if younger; 0 where none was set.
        stepped_ns: when the step was found, monotonic.
    """

    newest_ns: int | None = None
    age_on_arrival_s: float | None = None
    ages: Ages = ()
    recent: Ages = ()
    stepped_s: float = 0.0
    stepped_ns: int = 0

    @property
    def apart_s(self) -> float | None:
        """How far the newest fixes are apart by their stamps: the least of three times, for some may have been lost."""
        taken_s = [one.at_ns * 1e-9 - one.age_s for one in (self.recent or self.ages)[-4:]]
        return min((after - before for before, after in pairwise(taken_s)), default=None)


def update_fix_stamps(
    stamps: FixStamps,
    newest_ns: int | None,
    t_ns: int,
    monotonic_ns: int,
    *,
    refused_age_s: float | None = None,
    way: WayError | None = None,
) -> FixStamps:
    """Return the stamps with the newest fix as it is known at `t_ns`.

    Args:
        stamps: so far.
        newest_ns: stamp of the newest accepted fix.
        t_ns: now, UTC.
        monotonic_ns: now, for spans of time.
        refused_age_s: of another one when it came, by its stamp too far ahead or too old to be accepted; None if none
            was.
        way: how it differs from what was expected; None where that is not known.
    """
    if refused_age_s is not None:
        return replace(stamps, newest_ns=newest_ns, age_on_arrival_s=refused_age_s)
    if newest_ns == stamps.newest_ns:
        return stamps
    if newest_ns is None:
        return FixStamps()
    age_s = (t_ns - newest_ns) * 1e-9
    arrival = Arrival(monotonic_ns, age_s, None if way is None else way.ahead_s)
    return _compare(replace(stamps, newest_ns=newest_ns, age_on_arrival_s=age_s), arrival)


def is_step_of_stamps(stamps: FixStamps, age_s: float, way: WayError | None) -> bool:
    """Return whether a fix puts the vehicle elsewhere by its stamp alone.

    Its age differs from that of the fix before it by the time in which the vehicle drives so far, within what fixed
    phases err.

    Args:
        stamps: before it.
        age_s: of the fix as it came.
        way: how the fix differs from what was expected.
    """
    if way is None or stamps.age_on_arrival_s is None:
        return False
    along_m = abs(way.ahead_s) * way.speed_m_s
    unexplained_m = abs(way.ahead_s - (age_s - stamps.age_on_arrival_s)) * way.speed_m_s
    return max(unexplained_m, way.across_m) <= 2.0 * FIXED_STD_MAX_M < along_m


def _compare(stamps: FixStamps, newest: Arrival) -> FixStamps:
    """Return the stamps after a fix has come: those before a step stay until it is over, or long ago."""
    now_ns = newest.at_ns
    if stamps.stepped_s and now_ns - stamps.stepped_ns > _KNOWN_NS:
        stamps = replace(stamps, ages=stamps.recent, recent=(), stepped_s=0.0)
    if stamps.stepped_s:
        recent = _newest((*stamps.recent, newest), now_ns)
        return replace(stamps, recent=recent, stepped_s=_step_s(stamps.ages, recent))
    ages = tuple(one for one in (*stamps.ages, newest) if one.at_ns > now_ns - _KEPT_NS)
    recent = _newest(ages, now_ns)
    earlier = ages[: len(ages) - len(recent)]
    stepped_s = _step_s(earlier, recent)
    if not _is_of_clock(stepped_s, ages[-len(recent) - _RECENT_MIN :]):
        return replace(stamps, ages=ages, recent=())
    return replace(stamps, ages=earlier, recent=recent, stepped_s=stepped_s, stepped_ns=now_ns)


def _newest(ages: Ages, now_ns: int) -> Ages:
    """Return the ages of the last second, and of no fewer fixes than something is said of."""
    return ages[-max(sum(one.at_ns > now_ns - _RECENT_NS for one in ages), _RECENT_MIN) :]


def _step_s(earlier: Ages, recent: Ages) -> float:
    """Return by how much all recent fixes are older than any before, negative if younger; 0 where they are not."""
    if len(recent) < _RECENT_MIN or len(earlier) < _EARLIER_MIN:
        return 0.0
    before, now = [one.age_s for one in earlier], [one.age_s for one in recent]
    if min(now) - max(before) > _REFINED_S:
        return min(now) - max(before)
    return max(now) - min(before) if min(before) - max(now) > _REFINED_S else 0.0


def _is_of_clock(stepped_s: float, ages: Ages) -> bool:
    """Return whether ages that have stepped did so by a clock: unless all places are where they were expected.

    An estimate that has gone along with the step expects the next fixes where they come. So the first of them decides,
    and those before it, for a link's jitter hides the step in the ages at first.

    Args:
        stepped_s: by how much they have stepped; 0 where they have not.
        ages: of those since the step, and of some before it.
    """
    off_min_s = _OF_CLOCK * abs(stepped_s)
    return stepped_s != 0.0 and any(one.ahead_s is None or abs(one.ahead_s) > off_min_s for one in ages)


def named_by_stamps(obstacle: Cause | None) -> Cause | None:
    """Return the obstacle that says why fixes which come count for none: by their stamps they are old, or refused."""
    return obstacle if obstacle is not None and obstacle.reason in _OF_STAMPS else None


def is_stamped_ahead(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the newest fix came before it was taken: the vehicle's clock, or ours, is wrong."""
    age_s = s.vehicle.fix_age_on_arrival_s
    return age_s is not None and age_s < -c.integrity.fix_ahead_max_s


def tell_stamped_ahead(s: Situation, _: CompanionConfig) -> Cause:
    """Return by how much that clock is ahead."""
    return Cause(Reason.STAMPS_AHEAD, (-(s.vehicle.fix_age_on_arrival_s or 0.0),))


def are_stamps_late(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the newest fix was too old to count as it came."""
    age_s = s.vehicle.fix_age_on_arrival_s
    return age_s is not None and age_s > c.abort.fix_age_max_s


def tell_stamped_late(s: Situation, c: CompanionConfig) -> Cause:
    """Return how old it was."""
    return Cause(Reason.STAMPS_LATE, (s.vehicle.fix_age_on_arrival_s or 0.0, c.abort.fix_age_max_s))


def are_fixes_rare(s: Situation, c: CompanionConfig) -> bool:
    """Return whether each fix gets too old to count before the next one comes."""
    return sum(_pace_s(s)) > c.abort.fix_age_max_s


def tell_rare(s: Situation, c: CompanionConfig) -> Cause:
    """Return how far the fixes are apart, and how old as they come."""
    return Cause(Reason.FIXES_RARE, (*_pace_s(s), c.abort.fix_age_max_s))


def _pace_s(s: Situation) -> tuple[float, float]:
    return s.vehicle.fixes_apart_s or 0.0, max(s.vehicle.fix_age_on_arrival_s or 0.0, 0.0)


def have_stamps_stepped(s: Situation, c: CompanionConfig) -> bool:
    """Return whether a step of the stamps puts the pad off by more than S2 allows, and nothing sees where it is."""
    if s.pad is None or s.pad.frame_offset.is_confirmed or is_stamped_ahead(s, c):
        return False
    off_m = abs(s.vehicle.stamps_stepped_s) * s.pad.ground_speed_m_s
    return off_m > cone_radius_at_pad_m(s.pad.half_width_m, c)
