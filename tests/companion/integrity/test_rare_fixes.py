"""Fixes that come too rarely: each gets too old to count before the next one, and that is what the drone says."""

import pytest

from companion.core.reasons import Reason
from companion.integrity.stamps import FixStamps, are_fixes_rare, update_fix_stamps
from companion.situation.phases import Phase
from link.messages import Command
from tests.companion.facts import changed, situation
from tests.companion.world import CONFIG, PAD_HEIGHT_M, START_NS, STEP_NS, Flight, KnownVehicle

EVERY = round(1e9 / STEP_NS)
"""Steps between two fixes of 1 Hz."""


def run_at_1_hz(flight: Flight, duration_s: float) -> None:
    for step in range(round(duration_s * EVERY)):
        flight.sends_fixes = step % EVERY == 0
        flight.step()


def heard_at(*taken_s: float) -> FixStamps:
    stamps = FixStamps()
    for one_s in taken_s:
        taken_ns = START_NS + round(one_s * 1e9)
        stamps = update_fix_stamps(stamps, taken_ns, taken_ns + 50_000_000, taken_ns + 50_000_000)
    return stamps


@pytest.mark.parametrize(
    ("taken_s", "apart_s"),
    [
        ((), None),
        ((0.0,), None),
        ((0.0, 1.0), 1.0),
        ((0.0, 0.2, 3.0, 6.0), 0.2),
        ((0.0, 0.2, 3.2, 6.2, 9.2), 3.0),
        ((0.0, 1.0, 2.1), 1.0),
        ((0.0, 30.0), None),
    ],
)
def test_fixes_are_as_far_apart_as_the_nearest_of_the_last_four(
    taken_s: tuple[float, ...], apart_s: float | None
) -> None:
    assert heard_at(*taken_s).apart_s == (None if apart_s is None else pytest.approx(apart_s, abs=1e-6))


@pytest.mark.parametrize(
    ("apart_s", "late_s", "rare"),
    [
        (None, 0.2, False),
        (0.2, 0.2, False),
        (0.5, 0.4, False),
        (1.0, 0.05, True),
        (0.5, 0.6, True),
        (0.99, -0.3, False),
    ],
)
def test_fixes_are_rare_once_one_is_too_old_before_the_next(
    apart_s: float | None, late_s: float, *, rare: bool
) -> None:
    facts = changed(situation(), fixes_apart_s=apart_s, fix_age_on_arrival_s=late_s)
    assert are_fixes_rare(facts, CONFIG) is rare


def test_no_landing_is_begun_on_a_vehicle_of_1_hz_and_the_answer_says_why() -> None:
    flight = Flight(stamps_ahead_s=-0.05)
    run_at_1_hz(flight, 4.0)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert "fixes come 1.00 s apart and 0.05 s after their stamps" in reply.reason


def test_drone_that_waits_says_why_it_will_not_land() -> None:
    flight = Flight(vehicle=KnownVehicle((-80.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0)), stamps_ahead_s=-0.05)
    flight.start_and_reach(Phase.WAITING)
    run_at_1_hz(flight, 12.0)
    assert flight.phase is Phase.WAITING
    assert flight.outputs is not None
    assert flight.outputs.status.reason_code == Reason.FIXES_RARE.name


def test_drone_whose_chase_they_have_ended_says_why_it_makes_no_other() -> None:
    flight = Flight(stamps_ahead_s=-0.05)
    flight.start_and_reach(Phase.WAITING)
    run_at_1_hz(flight, 12.0)
    assert Phase.ABORT in flight.history
    assert (flight.phase, flight.reason) == (Phase.HOLD, Reason.FIXES_RARE)
