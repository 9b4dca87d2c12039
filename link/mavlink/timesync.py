"""Asks the autopilot what time it is, answers when it asks, and keeps the clock map.

Source: MAVLink time synchronization protocol v2, https://mavlink.io/en/services/timesync.html.
"""

from link.mavlink.answers import Answers, with_answer
from link.mavlink.clock_config import ClockConfig
from link.mavlink.clock_map import UNIX_TIME_MIN_NS, ClockMap, RoundTrip, with_round_trip, with_system_time
from link.mavlink.dialect import Message, mavlink
from link.mavlink.shared_id import SharedIdWatch
from link.mavlink.timer import Timer

_FAST_PERIOD_NS = 100_000_000
_FAST_COUNT = 20  # so many are asked so quickly at first, 2 s worth
_PERIOD_NS = 500_000_000
_OFTEN_PERIOD_NS = 20_000_000  # as often as setpoints are sent
_CLOCK = ClockConfig()
_MS_NS = 1_000_000
_BOOT_TURN_NS = (1 << 32) * _MS_NS
_COUNTS_ON_NS = 600 * 10**9  # longer than a link is silent in a flight, and far less than the 50 days
_ASKED_MAX = 64  # questions under way; older ones are lost


def boot_time_ns(message: Message, now_ns: int | None) -> int:
    """The time since boot that a message tells, 0 when it does not.

    Most messages have 32 bits of milliseconds for it, which begin anew after 50 days; TIMESYNC has 64 bits. All are
    taken by what 32 bits have room for, and where the clock runs over that they count on. The message gets this time.

    Args:
        message: any; that of an autopilot which has just started tells less than `now_ns`, and is left alone.
        now_ns: what the boot clock shows now, None before the first round trip.
    """
    if message.get_msgId() == mavlink.MAVLINK_MSG_ID_TIMESYNC:
        if not _is_boot_time(message.tc1):
            return 0
        message.tc1 = _counted_on(message.tc1, now_ns)
        return int(message.tc1)
    told_ms = getattr(message, "time_boot_ms", 0)
    if not told_ms:
        return 0
    message.time_boot_ms = _counted_on(told_ms * _MS_NS, now_ns) // _MS_NS
    return int(message.time_boot_ms) * _MS_NS


def _counted_on(told_ns: int, now_ns: int | None) -> int:
    boot_ns = told_ns % _BOOT_TURN_NS
    if now_ns is None:
        return boot_ns
    counted_ns = boot_ns + round((now_ns - boot_ns) / _BOOT_TURN_NS) * _BOOT_TURN_NS
    return counted_ns if abs(counted_ns - now_ns) < _COUNTS_ON_NS else boot_ns


def _is_boot_time(tc1_ns: int) -> bool:
    """Whether a TIMESYNC answer is a time since boot, not a date or a question: the protocol allows all three."""
    return 0 < tc1_ns < UNIX_TIME_MIN_NS


class ClockSync:
    """The exchange of times with the autopilot.

    Args:
        takes_own_utc: UTC is what the local clock shows, not what SYSTEM_TIME tells.

    Attributes:
        clock: what is known of the clocks.
        round_trips: answers used.
        answers: how the questions are answered.
        asks_often: to know from instant to instant that the autopilot hears. Of these answers the clocks learn nothing.
    """

    def __init__(self, *, takes_own_utc: bool = False) -> None:
        self._takes_own_utc = takes_own_utc
        self.clock = ClockMap()
        self.round_trips = 0
        self.answers = Answers()
        self.asks_often = False
        self._often = Timer(_OFTEN_PERIOD_NS)
        self._timer = Timer(_FAST_PERIOD_NS)
        self._fast_left = _FAST_COUNT
        self._asked_ns: dict[int, bool] = {}  # and whether the clocks learn of it
        self.shared_id = SharedIdWatch()
        """Hears every TIMESYNC of the autopilot's address, those of a clock that is not followed as well."""

    def poll(self, t_ns: int) -> Message | None:
        """The next question, when it is time for one."""
        is_learned = self._timer.is_due(t_ns)
        if not is_learned and not (self.asks_often and self._often.is_due(t_ns)):
            return None
        self._asked_ns[t_ns] = is_learned
        if len(self._asked_ns) > _ASKED_MAX:
            del self._asked_ns[next(iter(self._asked_ns))]
        if is_learned:
            self._fast_left -= 1
            if self._fast_left == 0:
                self._timer.period_ns = _PERIOD_NS
            self.shared_id.ask(t_ns)
        return mavlink.MAVLink_timesync_message(tc1=0, ts1=t_ns)

    def hear(self, message: Message, t_ns: int) -> Message | None:
        """Takes any message; returns the answer to one that asks for the time."""
        if message.get_msgId() == mavlink.MAVLINK_MSG_ID_TIMESYNC:
            return self.timesync(message, t_ns)
        if message.get_msgId() == mavlink.MAVLINK_MSG_ID_SYSTEM_TIME:
            self.system_time(message)
        return None

    def timesync(self, message: Message, t_ns: int) -> Message | None:
        """Takes a TIMESYNC: an answer to us is learned from, a question gets the answer returned here."""
        if message.tc1 == 0:
            return mavlink.MAVLink_timesync_message(tc1=max(t_ns, 1), ts1=message.ts1)  # 0 would be a question
        if message.ts1 in self._asked_ns and _is_boot_time(message.tc1):
            self.answers = with_answer(self.answers, message.ts1, t_ns)
            if self._asked_ns.pop(message.ts1):
                self.round_trips += 1
                self.clock = with_round_trip(self.clock, RoundTrip(message.ts1, t_ns, message.tc1), _CLOCK)
        return None

    def system_time(self, message: Message) -> None:
        """Takes a SYSTEM_TIME."""
        boot_ns = message.time_boot_ms * 1_000_000
        unix_ns = self.clock.boot_to_local_ns(boot_ns) if self._takes_own_utc else message.time_unix_usec * 1000
        if unix_ns is not None:
            self.clock = with_system_time(self.clock, boot_ns, unix_ns, _CLOCK)

    def start_over(self) -> None:
        """Forgets everything, as after a restart; answers to earlier questions count no more."""
        self.clock = ClockMap()
        self.answers = Answers()
        self._asked_ns.clear()
        self._fast_left = _FAST_COUNT
        self._timer = Timer(_FAST_PERIOD_NS)
