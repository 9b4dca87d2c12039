import pytest

from sim_autopilot.core.modes import ASK_FOR, FAILSAFES, LATCHED, TRANSITIONS, Event, Mode, Modes, react


def expected(mode: Mode, event: Event) -> Mode:
    """What PX4 does, said once more in words rather than as a table."""
    for wanted, ask in ASK_FOR.items():
        if event is ask:
            return wanted
    if event is Event.TAKEOFF_COMPLETE:
        return Mode.HOLD if mode is Mode.TAKEOFF else mode
    if event is Event.SETPOINTS_BACK:
        return Mode.OFFBOARD if mode in FAILSAFES.values() else mode
    if event in LATCHED:
        ladder = [Mode.HOLD, Mode.BRAKE, Mode.SMART_RTL, Mode.RTL, Mode.LAND]
        lowest = ladder.index(LATCHED[event])
        safer = ladder[lowest:] + [Mode.PRECISION_LAND] * (lowest >= ladder.index(Mode.SMART_RTL))
        return mode if mode in safer else ladder[lowest]
    if event not in FAILSAFES:
        return mode  # FAILSAFE_TERMINATE stops the motors instead
    return FAILSAFES[event] if mode is Mode.OFFBOARD else mode


@pytest.mark.parametrize("event", Event)
def test_every_mode_and_event_leads_where_px4_goes(event: Event) -> None:
    for mode in Mode:
        intended = Mode.OFFBOARD if event is Event.SETPOINTS_BACK else mode
        assert react(Modes(mode=mode, intended=intended), event).mode is expected(mode, event)


@pytest.mark.parametrize("event", Event)
def test_only_failsafes_part_the_mode_from_the_intended_one(event: Event) -> None:
    for mode in Mode:
        after = react(Modes(mode=mode, intended=mode), event)
        acts = event in FAILSAFES and mode is Mode.OFFBOARD
        assert after.failsafe == (acts or (event in LATCHED and (mode, event) in TRANSITIONS))
        assert after.intended is (after.mode if not after.failsafe else mode)


@pytest.mark.parametrize("event", LATCHED)
def test_setpoints_do_not_end_a_latched_failsafe_and_the_operator_does(event: Event) -> None:
    failed = react(Modes(mode=Mode.OFFBOARD, intended=Mode.OFFBOARD), event)
    assert react(failed, Event.SETPOINTS_BACK) == failed
    assert react(failed, Event.ASK_HOLD) == Modes(mode=Mode.HOLD, intended=Mode.HOLD)


@pytest.mark.parametrize("lost", FAILSAFES)
def test_setpoints_that_come_back_end_a_failsafe(lost: Event) -> None:
    flying = Modes(mode=Mode.OFFBOARD, intended=Mode.OFFBOARD)
    assert react(react(flying, lost), Event.SETPOINTS_BACK) == flying


@pytest.mark.parametrize("mode", [mode for mode in Mode if mode is not Mode.OFFBOARD])
def test_setpoints_do_not_take_over_from_a_mode_that_was_asked_for(mode: Mode) -> None:
    chosen = Modes(mode=mode, intended=mode)
    assert react(chosen, Event.SETPOINTS_BACK) == chosen


def test_a_mode_asked_for_in_a_failsafe_is_not_taken_back_by_setpoints() -> None:
    lost = react(Modes(mode=Mode.OFFBOARD, intended=Mode.OFFBOARD), Event.LOST_TO_HOLD)
    held = react(lost, Event.ASK_HOLD)
    assert react(held, Event.SETPOINTS_BACK) == Modes(mode=Mode.HOLD, intended=Mode.HOLD)


def test_every_mode_can_be_reached() -> None:
    assert set(TRANSITIONS.values()) == set(Mode)
