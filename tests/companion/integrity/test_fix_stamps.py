"""Fixes from the future: no landing on them is begun or goes on; a few early ones and late ones change nothing."""

import pytest

from companion.core.reasons import Reason
from companion.integrity.vehicle_data import FixStamps, update_fix_stamps
from companion.situation.phases import Phase
from link.messages import Command
from tests.companion.world import CONFIG, LANDING, START_NS, Flight, reached

AHEAD_S = 0.3
HOLD_S = CONFIG.integrity.fix_ahead_hold_s


@pytest.mark.slow
@pytest.mark.parametrize("phase", LANDING)
def test_landing_on_fixes_from_the_future_is_broken_off(phase: Phase) -> None:
    flight = reached(phase)
    flight.stamps_ahead_s = AHEAD_S
    flight.run_until(Phase.ABORT, limit_s=HOLD_S + 0.1)
    assert flight.reason is Reason.VEHICLE_CLOCK_AHEAD
    flight.run_until(Phase.HOLD)
    assert "0.30 s before their stamps" in flight.sentence


def test_landing_on_fixes_from_the_future_is_not_begun() -> None:
    flight = Flight(stamps_ahead_s=AHEAD_S)
    flight.run(HOLD_S + 0.1)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert "set its clock" in reply.reason
    assert flight.phase is Phase.IDLE


@pytest.mark.slow
@pytest.mark.parametrize("ahead_s", [-0.4, -0.1, 0.0, 0.9 * CONFIG.integrity.fix_ahead_max_s])
def test_late_fixes_and_clocks_that_err_a_little_are_landed_on(ahead_s: float) -> None:
    flight = Flight(stamps_ahead_s=ahead_s)
    flight.start_and_reach(Phase.SECURED)
    assert Phase.ABORT not in flight.history


def test_early_fixes_among_others_change_nothing() -> None:
    flight = reached(Phase.CHASE)
    for step in range(round(3.0 * HOLD_S / 0.02)):
        flight.stamps_ahead_s = AHEAD_S if step % 40 == 0 else -0.05
        flight.step()
        assert flight.phase is not Phase.ABORT


def test_age_is_that_of_the_step_which_took_the_fix_in() -> None:
    first = update_fix_stamps(FixStamps(), START_NS, START_NS + 200_000_000)
    assert first.age_on_arrival_s == pytest.approx(0.2)
    assert update_fix_stamps(first, START_NS, START_NS + 900_000_000) == first
    second = update_fix_stamps(first, START_NS + 500_000_000, START_NS + 400_000_000)
    assert second.age_on_arrival_s == pytest.approx(-0.1)
    assert update_fix_stamps(second, None, START_NS) == FixStamps()


def test_refused_fix_from_the_future_tells_by_how_much_it_came_early() -> None:
    known = update_fix_stamps(FixStamps(), START_NS, START_NS + 200_000_000)
    told = update_fix_stamps(known, START_NS, START_NS + 300_000_000, ahead_s=3.0)
    assert told == FixStamps(newest_ns=START_NS, age_on_arrival_s=-3.0)
