"""Which messages are due: each stream has an interval, kept exactly on average on the step's time grid."""

from collections.abc import Iterable, Mapping

from msgspec import Struct

from link.units import NS_PER_S


class Stream(Struct, frozen=True, kw_only=True):
    """A message that can be sent unasked: `rate_hz` by default (0 is off), from `from_s` after boot on.

    A `fixed` one keeps its rate: another one is refused.
    """

    message_id: int
    rate_hz: float = 0.0
    from_s: float = 0.0
    fixed: bool = False


class Streams(Struct, frozen=True, kw_only=True):
    """The streams that run, by message id, in nanoseconds since boot; the mappings are never written in place."""

    interval_ns: Mapping[int, int]
    next_ns: Mapping[int, int]


def default_streams(streams: Iterable[Stream], rates_hz: Mapping[int, float] | None = None) -> Streams:
    """Return the streams as they are at boot.

    Args:
        streams: that there are.
        rates_hz: of a link that has rates of its own, by message id; None for the streams' own.
    """
    rates = {one.message_id: one.rate_hz if rates_hz is None else rates_hz.get(one.message_id, 0.0) for one in streams}
    running = {message_id: rate_hz for message_id, rate_hz in rates.items() if rate_hz > 0.0}
    return Streams(
        interval_ns={message_id: round(NS_PER_S / rate_hz) for message_id, rate_hz in running.items()},
        next_ns=dict.fromkeys(running, 0),
    )


def shortest_interval_ns(streams: Streams) -> int | None:
    """Return the interval of the fastest stream, None when none runs."""
    return min(streams.interval_ns.values(), default=None)


def with_interval(streams: Streams, message_id: int, interval_ns: int | None, boot_ns: int) -> Streams:
    """Return the streams with `message_id` every `interval_ns` from now on, or stopped where that is None."""
    intervals, following = dict(streams.interval_ns), dict(streams.next_ns)
    if interval_ns is None:
        intervals.pop(message_id, None)
        following.pop(message_id, None)
    else:
        intervals[message_id] = interval_ns
        following[message_id] = boot_ns
    return Streams(interval_ns=intervals, next_ns=following)


def due_messages(streams: Streams, boot_ns: int) -> tuple[Streams, list[int]]:
    """Return the ids whose time has come by `boot_ns`, each at most once, and the streams with their next times.

    A next time follows from the last one, not from now, so an interval that is no multiple of the step is kept on
    average; after a stall longer than an interval the missed messages are not made up for.
    """
    due = [message_id for message_id, next_ns in streams.next_ns.items() if next_ns <= boot_ns]
    if not due:
        return streams, due
    following = dict(streams.next_ns)
    for message_id in due:
        interval_ns = streams.interval_ns[message_id]
        next_ns = following[message_id] + interval_ns
        following[message_id] = next_ns if next_ns > boot_ns - interval_ns else boot_ns + interval_ns
    return Streams(interval_ns=streams.interval_ns, next_ns=following), due
