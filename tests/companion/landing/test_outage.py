"""What an outage breaks off before the drone is near goes on after it: it costs no retry, and gets no more time."""

from collections.abc import Callable

import pytest

from companion.core.reasons import Cause, Reason
from companion.landing.decisions.entries import update_held
from companion.landing.state.memory import Held
from companion.situation.phases import Event, Phase
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    LONG_HEARD,
    NOW_NS,
    TICK_NS,
    at_time,
    changed,
    decided,
    drone_at,
    pad_at,
    progress,
    situation,
)
from tests.companion.world import Flight, reached

GOES_ON = Cause(Reason.HEARD_AGAIN)


def _chasing() -> Flight:
    """A flight that has a long way to its vehicle."""
    flight = reached(Phase.CHASE)
    x_m, y_m, z_m = flight.vehicle.start_enu_m
    flight.vehicle = replace(flight.vehicle, start_enu_m=(x_m - 1000.0, y_m + 30.0, z_m))
    return flight


def _own_is_late(flight: Flight) -> None:
    flight.own = replace(flight.own, t_ns=flight.t_ns - 10**9)
    flight.step()


def _own_attitude_is_late(flight: Flight) -> None:
    flight.own = replace(flight.own, attitude_age_s=CONFIG.abort.own_age_max_s + 0.1)
    flight.step()


def _vehicle_is_late(flight: Flight) -> None:
    flight.sends_fixes = False
    flight.run_until(Phase.ABORT, limit_s=CONFIG.abort.fix_age_max_s + 0.1)
    flight.sends_fixes = True


@pytest.mark.slow
@pytest.mark.parametrize(
    ("outage", "reason"),
    [
        (_own_is_late, Reason.OWN_POSITION_OLD),
        (_own_attitude_is_late, Reason.OWN_ATTITUDE_OLD),
        (_vehicle_is_late, Reason.VEHICLE_DATA_OLD),
    ],
)
@pytest.mark.parametrize(("phase", "retries"), [(Phase.CHASE, 0), (Phase.ALIGN, 1), (Phase.DESCEND, 1)])
def test_outage_costs_a_retry_only_where_the_drone_was_near(
    outage: Callable[[Flight], None], reason: Reason, phase: Phase, retries: int
) -> None:
    flight = _chasing() if phase is Phase.CHASE else reached(phase)
    outage(flight)
    assert (flight.phase, flight.reason) == (Phase.ABORT, reason)
    flight.run_until(Phase.CHASE)
    assert flight.memory.progress.retries == retries
    assert (flight.memory.progress.cause == GOES_ON) is (retries == 0)


@pytest.mark.slow
def test_chase_that_outages_break_off_again_and_again_takes_no_longer_than_any_other() -> None:
    chase = CONFIG.chase.model_copy(update={"time_limit_s": 12.0})
    flight = _chasing()
    flight.config = CONFIG.model_copy(update={"chase": chase})
    begun_ns = flight.memory.progress.since_ns
    while flight.memory.progress.retries == 0:
        assert flight.phase is Phase.CHASE
        assert flight.memory.progress.since_ns == begun_ns
        _own_is_late(flight)
        flight.run_until(Phase.CHASE)
        assert flight.monotonic_ns - begun_ns < 60e9
        flight.step()
        flight.run_until(Phase.CHASE)
    assert flight.sentence == f"retry 1 of {CONFIG.abort.retries_max}"
    assert flight.memory.progress.since_ns > begun_ns


def test_interrupted_approach_goes_on_without_a_retry_left() -> None:
    last = replace(progress(Phase.ABORT), retries=CONFIG.abort.retries_max, interrupted_ns=NOW_NS)
    assert decided(last, situation(CONFIG.abort.height_m), LONG_HEARD) == (Event.CLEAR, GOES_ON)


def test_interrupted_approach_ends_where_the_operator_or_the_vehicle_ends_it() -> None:
    high = situation(CONFIG.abort.height_m)
    interrupted = replace(progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1), interrupted_ns=NOW_NS)
    silent = changed(high, fix_age_s=CONFIG.abort.fix_age_max_s + 0.1)
    ended = decided(replace(interrupted, may_retry=False), high, {})
    assert ended == (Event.CLEAR_TO_HOLD, Cause(Reason.BROKEN_OFF))
    assert decided(interrupted, silent, {}) == (Event.CLEAR_TO_HOLD, Cause(Reason.NO_VEHICLE_DATA))


HIGH = situation(CONFIG.abort.height_m)
SILENT = {
    Reason.NO_VEHICLE_DATA: changed(HIGH, fix_age_s=CONFIG.abort.fix_age_max_s + 0.1),
    Reason.OWN_POSITION_OLD: replace(HIGH, drone=None),
    Reason.OWN_ATTITUDE_OLD: replace(
        HIGH, drone=replace(drone_at(CONFIG.abort.height_m, pad=pad_at()), attitude_known=False)
    ),
}


@pytest.mark.parametrize("silence", SILENT)
def test_climb_waits_for_who_is_silent_as_long_as_it_may(silence: Reason) -> None:
    facts, limit_s = SILENT[silence], CONFIG.abort.time_limit_s
    assert decided(progress(Phase.ABORT, limit_s - 0.1), facts, {}) is None
    assert decided(progress(Phase.ABORT, limit_s + 0.1), facts, {}) == (Event.CLEAR_TO_HOLD, Cause(silence))


@pytest.mark.parametrize(
    ("late_s", "reason", "values"),
    [(1.1, Reason.STAMPS_LATE, (1.1, CONFIG.abort.fix_age_max_s)), (-1.0, Reason.STAMPS_AHEAD, (1.0,))],
)
def test_vehicle_whose_stamps_are_wrong_is_not_said_to_send_nothing(
    late_s: float, reason: Reason, values: tuple[float, ...]
) -> None:
    silent = changed(SILENT[Reason.NO_VEHICLE_DATA], fix_age_on_arrival_s=late_s)
    climb = progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1)
    ended = decided(climb, silent, {reason: climb.since_ns})
    assert ended == (Event.CLEAR_TO_HOLD, Cause(reason, values))


def test_vehicle_that_is_heard_of_now_and_then_is_not_approached_again() -> None:
    """One fix each 1.3 s: never a second without a break, and one just in time for the end of the climb."""
    limit_s = CONFIG.abort.time_limit_s
    heard = {Reason.HEARD: NOW_NS - round(0.5e9 * CONFIG.abort.heard_hold_s)}
    assert decided(progress(Phase.ABORT, limit_s - 0.1), HIGH, heard) is None
    ended = decided(progress(Phase.ABORT, limit_s + 0.1), HIGH, heard)
    assert ended == (Event.CLEAR_TO_HOLD, Cause(Reason.HEARD_WITH_BREAKS))


@pytest.mark.parametrize("silence", SILENT)
def test_next_approach_begins_when_all_have_been_heard_without_a_break(silence: Reason) -> None:
    t_ns = NOW_NS
    held: Held = {}
    break_ns, hold_ns = NOW_NS + 5 * TICK_NS, round(1e9 * CONFIG.abort.heard_hold_s)
    while True:
        facts = at_time(SILENT[silence] if t_ns == break_ns else HIGH, t_ns)
        held = update_held(held, Phase.ABORT, facts, CONFIG)
        if decided(progress(Phase.ABORT), facts, held) is not None:
            break
        t_ns += TICK_NS
    assert t_ns == break_ns + TICK_NS + hold_ns
