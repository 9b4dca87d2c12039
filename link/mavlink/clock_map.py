"""Three clocks in one: the companion's own (local), the autopilot's since it started (boot), and UTC.

Local to boot comes from TIMESYNC round trips, boot to UTC from the pairs in SYSTEM_TIME. The companion asks and stamps
by its own clock, whatever that shows, so the error of this clock cancels on the way from local over boot to UTC. Until
SYSTEM_TIME knows UTC, local time is taken for it.

A round trip bounds its own error: the answer was made between asking and hearing. Within a window the quickest round
trip sets the scale, and each other counts less by what it took longer. SYSTEM_TIME cuts boot time to whole milliseconds
and so do the messages whose stamps are mapped, so these cuts are left alone.
"""

import math
from collections.abc import Sequence
from statistics import pstdev
from typing import NamedTuple

from msgspec import Struct

from link.mavlink.clock_config import DEFAULT_CLOCK_CONFIG, ClockConfig
from link.mavlink.clock_line import ClockLine, ClockPair, fit_clock_line
from link.records import replace

# Before this (2009-02-13) a unix time is a clock that was never set, not a date; PX4 draws the line here too.
UNIX_TIME_MIN_NS = 1_234_567_890 * 10**9
# After this (2038-01-18) a stamp of ROS 2 has no room for it.
UNIX_TIME_MAX_NS = 2_147_400_000 * 10**9

# With fewer round trips the drift is a guess: a simulation at several times real time would look like endless steps.
_STEP_TRIPS_MIN = 5
_STEP_AGREE = 3  # readings in a row that tell of the same step before it is believed: one may be anybody's, or garbled
_SLOW_STDS_MAX = 5.0  # of UTC behind boot time: one quartz makes both, and no step is farther off than that


class RoundTrip(NamedTuple):
    """A TIMESYNC exchange: asked and heard by the local clock, answered by the boot clock."""

    sent_ns: int
    received_ns: int
    boot_ns: int

    @property
    def duration_ns(self) -> int:
        """How long it took."""
        return self.received_ns - self.sent_ns

    @property
    def middle_ns(self) -> int:
        """The local time at which the answer was most likely made."""
        return (self.sent_ns + self.received_ns) // 2


class ClockMap(Struct, frozen=True, kw_only=True):
    """What is known of the three clocks; empty as constructed.

    Attributes:
        round_trips: those that `local_to_boot` is made of.
        system_times: those that `boot_to_utc` is made of.
        local_to_boot: None before the first round trip.
        boot_to_utc: None before the first SYSTEM_TIME.
        one_way_s: how long a message is under way: half the median round trip, 0 while there was none.
        one_way_std_s: standard deviation of `one_way_s` if both ways are equally unsteady; 0 while it is unknown.
        doubted_trips: the newest, which tell of a step of the boot clock; not fitted yet.
        doubted_times: the newest, which tell of a step of UTC; not fitted yet.
    """

    round_trips: tuple[RoundTrip, ...] = ()
    system_times: tuple[ClockPair, ...] = ()
    local_to_boot: ClockLine | None = None
    boot_to_utc: ClockLine | None = None
    one_way_s: float = 0.0
    one_way_std_s: float = 0.0
    doubted_trips: tuple[RoundTrip, ...] = ()
    doubted_times: tuple[ClockPair, ...] = ()

    @property
    def is_utc_known(self) -> bool:
        """Whether UTC comes from the autopilot; otherwise local time stands for it."""
        return self.boot_to_utc is not None

    def local_to_boot_ns(self, local_ns: int) -> int | None:
        """Boot time at a local time, None before the first round trip."""
        return None if self.local_to_boot is None else self.local_to_boot.y_ns(local_ns)

    def boot_to_local_ns(self, boot_ns: int) -> int | None:
        """Local time at a boot time, None before the first round trip."""
        return None if self.local_to_boot is None else self.local_to_boot.x_ns(boot_ns)

    def boot_to_utc_ns(self, boot_ns: int) -> int | None:
        """UTC at a boot time, None when neither SYSTEM_TIME nor a round trip has come."""
        if self.boot_to_utc is None:
            return self.boot_to_local_ns(boot_ns)
        return _bounded(self.boot_to_utc.y_ns(boot_ns))

    def local_to_utc_ns(self, local_ns: int) -> int:
        """UTC at a local time; the local time itself until both ways are known."""
        if self.boot_to_utc is None or self.local_to_boot is None:
            return local_ns
        return _bounded(self.boot_to_utc.y_ns(self.local_to_boot.y_ns(local_ns)))

    def is_ahead(self, boot_ns: int, local_ns: int) -> bool:
        """Whether `boot_ns` is still to come at a local time, by more than both clocks can be apart."""
        now_ns, std_ns = self.local_to_boot_ns(local_ns), self.local_to_boot_std_ns(local_ns)
        if now_ns is None or std_ns is None:
            return False
        return boot_ns - now_ns > DEFAULT_CLOCK_CONFIG.step_ns + 5.0 * std_ns

    def local_to_boot_std_ns(self, local_ns: int) -> float | None:
        """Standard deviation of `local_to_boot_ns` by the scatter that the link is known for, None when unknown."""
        return None if self.local_to_boot is None else self.local_to_boot.std_ns(local_ns)


def utc_set_by_ns(before: ClockMap, after: ClockMap, local_ns: int) -> int:
    """By how much UTC was set from one map to the next; what became known of the boot clock does not count."""
    if after is before:
        return 0
    boot_ns = after.local_to_boot_ns(local_ns)
    if boot_ns is None or before.local_to_boot is None:
        return after.local_to_utc_ns(local_ns) - before.local_to_utc_ns(local_ns)
    return (after.boot_to_utc_ns(boot_ns) or 0) - (before.boot_to_utc_ns(boot_ns) or 0)


def _bounded(utc_ns: int) -> int:
    """A time on a fitted line as one that a stamp has room for: the line leaves the bounds that its pairs keep to."""
    return min(max(utc_ns, UNIX_TIME_MIN_NS), UNIX_TIME_MAX_NS)


def with_round_trip(clock: ClockMap, trip: RoundTrip, config: ClockConfig = DEFAULT_CLOCK_CONFIG) -> ClockMap:
    """Learns from a TIMESYNC exchange.

    Args:
        clock: what was known.
        trip: the exchange; one that ends before it began is passed over.
        config: how clocks are followed.

    Returns:
        What is known now.
    """
    if trip.duration_ns < 0:
        return clock
    line, trips = clock.local_to_boot, clock.round_trips
    news: tuple[RoundTrip, ...] = (trip,)
    if len(trips) >= _STEP_TRIPS_MIN and _is_step(line, trip.middle_ns, trip.boot_ns, trip.duration_ns / 2, config):
        news = (*clock.doubted_trips, trip)[-_STEP_AGREE:]
        if not _agree([ClockPair(one.middle_ns, one.boot_ns, one.duration_ns / 2) for one in news], config):
            return replace(clock, doubted_trips=news)
        trips = ()
    oldest_ns = trip.middle_ns - config.window_ns
    trips = (*(one for one in trips if one.middle_ns >= oldest_ns), *news)[-config.pairs_max :]
    durations_ns = sorted(one.duration_ns for one in trips)
    return replace(
        clock,
        round_trips=trips,
        doubted_trips=(),
        local_to_boot=_fit(_pairs(trips, config), line, config),
        one_way_s=0.5e-9 * durations_ns[len(durations_ns) // 2],
        one_way_std_s=1e-9 * pstdev(durations_ns) * math.sqrt(0.5),
    )


def with_system_time(
    clock: ClockMap, boot_ns: int, unix_ns: int, config: ClockConfig = DEFAULT_CLOCK_CONFIG
) -> ClockMap:
    """Learns from a SYSTEM_TIME message.

    Args:
        clock: what was known.
        boot_ns: its time since boot.
        unix_ns: its UTC; passed over before `UNIX_TIME_MIN_NS` (0 is the usual "unknown") and after `UNIX_TIME_MAX_NS`.
            One that stands still, or runs backwards or slower than boot time, is no UTC: that known goes on, lest the
            time of whoever follows it stop. One that runs faster is the computer's, of a simulation that falls behind.
        config: how clocks are followed.

    Returns:
        What is known now.
    """
    if not UNIX_TIME_MIN_NS <= unix_ns <= UNIX_TIME_MAX_NS:
        return clock
    line, pairs = clock.boot_to_utc, clock.system_times
    news: tuple[ClockPair, ...] = (ClockPair(boot_ns, unix_ns, config.system_time_std_ns),)
    if _is_step(line, boot_ns, unix_ns, config.system_time_std_ns, config):
        news = (*clock.doubted_times, *news)[-_STEP_AGREE:]
        if not _agree(news, config):
            return replace(clock, doubted_times=news)
        pairs = ()
    oldest_ns = boot_ns - config.window_ns
    pairs = (*(one for one in pairs if one.x_ns >= oldest_ns), *news)[-config.pairs_max :]
    fitted = _fit(pairs, line, config)
    if fitted.drift < -_SLOW_STDS_MAX * config.drift_std:
        return replace(clock, doubted_times=news)
    return replace(clock, system_times=pairs, doubted_times=(), boot_to_utc=fitted)


def _pairs(trips: tuple[RoundTrip, ...], config: ClockConfig) -> list[ClockPair]:
    durations_ns = sorted(trip.duration_ns for trip in trips)
    quickest_ns, median_ns = durations_ns[0], durations_ns[len(durations_ns) // 2]
    spread_ns = config.spread_share * (median_ns - quickest_ns)
    # The time beyond the quickest was spent on either way: the middle is off by up to half of it.
    return [
        ClockPair(
            trip.middle_ns,
            trip.boot_ns,
            math.hypot(config.round_trip_std_ns, (trip.duration_ns - quickest_ns) / 2 + spread_ns),
        )
        for trip in trips
    ]


def _fit(pairs: Sequence[ClockPair], previous: ClockLine | None, config: ClockConfig) -> ClockLine:
    """The line through the pairs; a single one, after a step, keeps the drift of before."""
    drift = previous.drift if previous is not None and len(pairs) == 1 else 0.0
    return fit_clock_line(pairs, drift, config.drift_std)


def _is_step(line: ClockLine | None, x_ns: int, y_ns: int, bound_ns: float, config: ClockConfig) -> bool:
    if line is None:
        return False
    allowed_ns = bound_ns + 5.0 * line.std_ns(x_ns) + config.step_ns
    return abs(line.y_ns(x_ns) - y_ns) > allowed_ns


def _agree(news: Sequence[ClockPair], config: ClockConfig) -> bool:
    """Whether enough readings lie on one line, whatever its rate, so that they tell of the same step."""
    if len(news) < _STEP_AGREE:
        return False
    first, second, third = news
    if not first.x_ns < second.x_ns < third.x_ns:
        return False
    share = (third.x_ns - first.x_ns) / (second.x_ns - first.x_ns)
    off_ns = abs(third.y_ns - first.y_ns - share * (second.y_ns - first.y_ns))
    return off_ns <= config.step_ns + 2.0 * share * max(one.std_ns for one in news)
