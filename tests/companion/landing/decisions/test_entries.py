"""What leads to the next phase, and what a moment of something else does not end."""

import pytest

from companion.core.reasons import Reason
from companion.landing.decisions.entries import update_held
from companion.landing.decisions.passing import why_not_chased
from companion.landing.state.memory import Held
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from tests.companion.facts import CONFIG, TICK_NS, decided, later, pad_at, progress, situation


def _waits(speeds_m_s: list[float]) -> tuple[Situation, Held]:
    """Return what is known after a wait beside a vehicle that seems so fast in each tick."""
    held: Held = {}
    now = situation()
    for ticks, speed_m_s in enumerate(speeds_m_s):
        now = later(situation(3.0, 2.0, pad=pad_at((speed_m_s, 0.0, 0.0))), ticks * TICK_NS)
        held = update_held(held, Phase.WAITING, now, CONFIG)
    return now, held


def _ticks(duration_s: float) -> int:
    return round(duration_s * 1e9 / TICK_NS)


@pytest.mark.parametrize(("fast_s", "is_flown_to"), [(0.4, True), (0.6, False)])
def test_standing_ends_where_driving_begins_and_by_no_jump_of_the_estimate(fast_s: float, *, is_flown_to: bool) -> None:
    """One that creeps at 0.25 m/s, which its estimate passes by a noise, would neither stand for long nor drive."""
    waits_s, before_s = CONFIG.chase.parked_wait_s, 3.0
    speeds = [0.25] * _ticks(before_s) + [0.35] * _ticks(fast_s)
    facts, held = _waits(speeds + [0.25] * (_ticks(waits_s) + 1 - len(speeds)))
    decision = decided(progress(Phase.WAITING, 0.0), facts, held)
    assert (decision is not None) is is_flown_to


def test_vehicle_that_stands_is_said_to_while_its_estimate_jumps() -> None:
    facts, held = _waits([0.25] * 100 + [0.35] * 5)
    cause = why_not_chased(held, facts, CONFIG)
    assert cause is not None
    assert cause.reason is Reason.VEHICLE_MAY_DEPART
