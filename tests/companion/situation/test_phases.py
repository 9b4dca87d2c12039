"""The table of transitions, over every pair of phase and event."""

import itertools

import pytest

from companion.situation.phases import (
    FLYING_PHASES,
    LANDING_PHASES,
    TRANSITIONS,
    Event,
    Phase,
    mermaid_diagram,
    next_phase,
)

PAIRS = list(itertools.product(Phase, Event))


@pytest.mark.parametrize("phase", Phase)
def test_every_event_leads_to_the_listed_phase_or_stays(phase: Phase) -> None:
    assert {event: next_phase(phase, event) for event in Event} == {
        event: TRANSITIONS.get((phase, event), phase) for event in Event
    }


@pytest.mark.parametrize("phase", [phase for phase in Phase if phase in FLYING_PHASES])
def test_pilot_gets_command_from_every_flying_phase(phase: Phase) -> None:
    assert next_phase(phase, Event.PILOT_TOOK_OVER) is Phase.PILOT


@pytest.mark.parametrize("phase", [phase for phase in Phase if phase in LANDING_PHASES])
@pytest.mark.parametrize("event", [Event.UNSAFE, Event.ABORT, Event.TIME_LIMIT, Event.HOLD])
def test_every_landing_phase_can_be_broken_off(phase: Phase, event: Event) -> None:
    assert next_phase(phase, event) is Phase.ABORT


def test_only_a_start_or_a_launch_leads_out_of_the_phases_that_fly_nothing() -> None:
    for phase, event in PAIRS:
        if phase not in FLYING_PHASES and next_phase(phase, event) is not phase:
            assert event in (Event.START, Event.LAUNCH)


def test_motors_are_never_taken_for_off_without_a_contact_first() -> None:
    sources = {phase for (phase, _), target in TRANSITIONS.items() if target is Phase.SECURED}
    assert sources == {Phase.TOUCHDOWN}
    before = {phase: event for (phase, event), target in TRANSITIONS.items() if target is Phase.TOUCHDOWN}
    assert set(before) == {Phase.DESCEND, Phase.ON_DECK, Phase.LIFT_OFF, Phase.TAKEOFF, Phase.ABORT}
    assert before[Phase.TAKEOFF] is Event.CARRIED_OFF  # likewise
    assert before[Phase.ABORT] is Event.CALLED_OFF
    assert before[Phase.LIFT_OFF] is Event.CALLED_OFF  # that only a drone which stands on the deck still is given


def test_every_phase_can_be_reached_from_idle() -> None:
    reached = {Phase.IDLE}
    for _ in Phase:
        reached |= {target for (phase, _), target in TRANSITIONS.items() if phase in reached}
    assert reached == set(Phase)


def test_diagram_has_one_arrow_for_each_transition() -> None:
    arrows = [line for line in mermaid_diagram().splitlines() if "-->" in line and "[*]" not in line]
    assert len(arrows) == len(TRANSITIONS)
