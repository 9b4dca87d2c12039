"""Forged times of the autopilot in a flight: nothing that they do to the clocks ends the companion."""

from collections.abc import Callable

import pytest

from companion.situation.phases import Phase
from link.mavlink.clock_map import (
    UNIX_TIME_MAX_NS,
    UNIX_TIME_MIN_NS,
    ClockMap,
    RoundTrip,
    with_round_trip,
    with_system_time,
)
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep

S = 10**9
MS = 10**6
FORGED = 20
STEPS = 25  # from one to the next, 0.25 s: a real one comes each second, and together they make a steep line


def last_utc(boot_ms: int, _asked_ns: int) -> Message:
    return mavlink.MAVLink_system_time_message(UNIX_TIME_MAX_NS // 1000, boot_ms)


def first_utc(boot_ms: int, _asked_ns: int) -> Message:
    return mavlink.MAVLink_system_time_message(UNIX_TIME_MIN_NS // 1000 + 1, boot_ms)


def last_boot_time(_boot_ms: int, asked_ns: int) -> Message:
    return mavlink.MAVLink_timesync_message(tc1=UNIX_TIME_MIN_NS - 1, ts1=asked_ns)


def first_boot_time(_boot_ms: int, asked_ns: int) -> Message:
    return mavlink.MAVLink_timesync_message(tc1=1, ts1=asked_ns)


class Flight(Lockstep):
    """A landing whose companion publishes, and into whose link somebody else speaks."""

    def __init__(self) -> None:
        super().__init__(load_scenario("straight_5"), 1, publishes=True)
        self._forger = MavlinkCodec(1, 1)

    def fly_to(self, phase: Phase) -> None:
        """Fly until it is in `phase`."""
        while self.companion.phase is not phase:
            self.advance()

    def advance(self) -> None:
        """Make a step, and take what is published."""
        self.step()
        self.companion.take_publications()

    def forge(self, message: Callable[[int, int], Message]) -> None:
        """Speak as the autopilot, right after it."""
        clock = self.companion.autopilot.session.clock
        local_ns = clock.round_trips[-1].received_ns
        boot_ms = (clock.local_to_boot_ns(local_ns) or 0) // MS
        self.companion.receive_mavlink(self._forger.encode(message(boot_ms, local_ns)), local_ns)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("message", "phase"),
    [
        (last_utc, Phase.CHASE),
        (first_utc, Phase.DESCEND),
        (last_boot_time, Phase.DESCEND),
        (first_boot_time, Phase.CHASE),
    ],
)
def test_forged_times_among_real_ones_never_end_the_companion(
    message: Callable[[int, int], Message], phase: Phase
) -> None:
    flight = Flight()
    flight.fly_to(phase)
    for _ in range(FORGED):
        flight.forge(message)
        for _ in range(STEPS):
            flight.advance()
    assert flight.companion.outputs is not None


@pytest.mark.parametrize(("first_ns", "a_second_ns"), [(UNIX_TIME_MAX_NS - 20 * S, S), (UNIX_TIME_MIN_NS + 20 * S, -S)])
def test_line_through_accepted_times_never_tells_one_that_no_stamp_has_room_for(
    first_ns: int, a_second_ns: int
) -> None:
    clock = with_round_trip(ClockMap(), RoundTrip(S, S + 2 * MS, S + MS))
    for number in range(20):
        clock = with_system_time(clock, (1 + number) * S, first_ns + number * a_second_ns)
    told = [clock.local_to_utc_ns(10**17), clock.boot_to_utc_ns(10**17) or 0, clock.boot_to_utc_ns(-(10**17)) or 0]
    assert all(UNIX_TIME_MIN_NS <= one_ns <= UNIX_TIME_MAX_NS for one_ns in told)
