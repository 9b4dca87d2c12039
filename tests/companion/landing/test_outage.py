"""What an outage breaks off before the drone is near goes on after it: it costs no retry, and gets no more time."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from companion.landing.conditions import update_held
from companion.landing.decisions import decide
from companion.situation.phases import Event, Phase
from companion.situation.situation import approach
from tests.companion.facts import CONFIG, LONG_HEARD, NOW_NS, TICK_NS, drone_at, pad_at, progress, situation
from tests.companion.world import Flight, reached

GOES_ON = "heard again: the same approach goes on"


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
        (_own_is_late, "own position too old"),
        (_own_attitude_is_late, "own attitude too old"),
        (_vehicle_is_late, "vehicle data too old"),
    ],
)
@pytest.mark.parametrize(("phase", "retries"), [(Phase.CHASE, 0), (Phase.ALIGN, 1), (Phase.DESCEND, 1)])
def test_outage_costs_a_retry_only_where_the_drone_was_near(
    outage: Callable[[Flight], None], reason: str, phase: Phase, retries: int
) -> None:
    flight = _chasing() if phase is Phase.CHASE else reached(phase)
    outage(flight)
    assert (flight.phase, flight.memory.reason) == (Phase.ABORT, reason)
    flight.run_until(Phase.CHASE)
    assert flight.memory.retries == retries
    assert (flight.memory.reason == GOES_ON) is (retries == 0)


@pytest.mark.slow
def test_chase_that_outages_break_off_again_and_again_takes_no_longer_than_any_other() -> None:
    chase = CONFIG.chase.model_copy(update={"time_limit_s": 12.0})
    flight = _chasing()
    flight.config = CONFIG.model_copy(update={"chase": chase})
    begun_ns = flight.memory.phase_since_ns
    while flight.memory.retries == 0:
        assert flight.phase is Phase.CHASE
        assert flight.memory.phase_since_ns == begun_ns
        _own_is_late(flight)
        flight.run_until(Phase.CHASE)
        assert flight.t_ns - begun_ns < 60e9
        flight.step()
        flight.run_until(Phase.CHASE)
    assert flight.memory.reason == f"retry 1 of {CONFIG.abort.retries_max}"
    assert flight.memory.phase_since_ns > begun_ns


def test_interrupted_approach_goes_on_without_a_retry_left() -> None:
    last = replace(progress(Phase.ABORT), retries=CONFIG.abort.retries_max, is_interrupted=True)
    assert decide(last, situation(CONFIG.abort.height_m), LONG_HEARD, CONFIG) == (Event.CLEAR, GOES_ON)


def test_interrupted_approach_ends_where_the_operator_or_the_vehicle_ends_it() -> None:
    high = situation(CONFIG.abort.height_m)
    interrupted = replace(progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1), is_interrupted=True)
    silent = replace(high, fix_age_s=CONFIG.abort.fix_age_max_s + 0.1)
    ended = decide(replace(interrupted, may_retry=False), high, {}, CONFIG)
    assert ended == (Event.CLEAR_TO_HOLD, "broken off by the operator")
    assert decide(interrupted, silent, {}, CONFIG) == (Event.CLEAR_TO_HOLD, "no vehicle data")


HIGH = situation(CONFIG.abort.height_m)
SILENT = {
    "no vehicle data": replace(HIGH, fix_age_s=CONFIG.abort.fix_age_max_s + 0.1),
    "own position too old": replace(HIGH, drone=None),
    "own attitude too old": replace(
        HIGH, drone=replace(drone_at(CONFIG.abort.height_m, pad=pad_at()), attitude_known=False)
    ),
}


@pytest.mark.parametrize("silence", SILENT)
def test_climb_waits_for_who_is_silent_as_long_as_it_may(silence: str) -> None:
    facts, limit_s = SILENT[silence], CONFIG.abort.time_limit_s
    assert decide(progress(Phase.ABORT, limit_s - 0.1), facts, {}, CONFIG) is None
    assert decide(progress(Phase.ABORT, limit_s + 0.1), facts, {}, CONFIG) == (Event.CLEAR_TO_HOLD, silence)


def test_vehicle_that_is_heard_of_now_and_then_is_not_approached_again() -> None:
    """One fix each 1.3 s: never a second without a break, and one just in time for the end of the climb."""
    limit_s = CONFIG.abort.time_limit_s
    heard = {"heard": NOW_NS - round(0.5e9 * CONFIG.abort.heard_hold_s)}
    assert decide(progress(Phase.ABORT, limit_s - 0.1), HIGH, heard, CONFIG) is None
    ended = decide(progress(Phase.ABORT, limit_s + 0.1), HIGH, heard, CONFIG)
    assert ended == (Event.CLEAR_TO_HOLD, "vehicle or autopilot heard of with breaks only")


@pytest.mark.parametrize("silence", SILENT)
def test_next_approach_begins_when_all_have_been_heard_without_a_break(silence: str) -> None:
    t_ns = NOW_NS
    held: dict[str, int] = {}
    break_ns, hold_ns = NOW_NS + 5 * TICK_NS, round(1e9 * CONFIG.abort.heard_hold_s)
    while True:
        facts = replace(SILENT[silence] if t_ns == break_ns else HIGH, t_ns=t_ns)
        held = update_held(held, Phase.ABORT, facts, approach(facts), CONFIG)
        if decide(progress(Phase.ABORT), facts, held, CONFIG) is not None:
            break
        t_ns += TICK_NS
    assert t_ns == break_ns + TICK_NS + hold_ns
