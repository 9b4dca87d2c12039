"""Answers to operators over every pair of command and phase."""

import itertools

import pytest

from companion.autopilots.driver import Receiver
from companion.core.reasons import Cause, Reason
from companion.landing.commands import answer
from companion.situation.phases import LANDING_PHASES, STATION_PHASES, Event, Phase, next_phase
from companion.situation.situation import Situation
from link.messages import Command, CommandReply, Order, Station
from link.records import replace
from tests.companion.facts import CONFIG, drone_at, pad_at, situation
from tests.companion.world import PAD_HEIGHT_M, SET_MODE, Flight, KnownVehicle, own_state

PAIRS = list(itertools.product(Command, Phase))
STATION = Station(offset_m=(-6.0, 2.0, 3.0))
STARTABLE = {Phase.FOLLOW, Phase.IDLE, Phase.SECURED, Phase.PILOT, Phase.HOLD}


def order(command: Command) -> Order:
    return Order(command=command, station=STATION if command is Command.FOLLOW else None)


@pytest.mark.parametrize(("command", "phase"), PAIRS)
def test_accepted_command_changes_the_phase_or_forbids_what_would_come_by_itself(
    command: Command, phase: Phase
) -> None:
    event, reply = answer(order(command), phase, situation(), CONFIG)
    if event is not None:
        assert reply.accepted
        assert next_phase(phase, event) is not phase or (phase, event) == (Phase.FOLLOW, Event.FOLLOW)
    elif reply.accepted:
        assert phase in (Phase.ABORT, Phase.HOLD)
    else:
        assert reply.reason


@pytest.mark.parametrize("phase", Phase)
@pytest.mark.parametrize("command", [Command.START, Command.START_ANYWAY])
def test_start_is_accepted_where_a_landing_can_begin_only(phase: Phase, command: Command) -> None:
    _, reply = answer(order(command), phase, situation(), CONFIG)
    assert reply.accepted == (phase in STARTABLE)


@pytest.mark.parametrize("phase", Phase)
@pytest.mark.parametrize("command", [Command.ABORT, Command.HOLD])
def test_landing_can_be_broken_off_until_contact(phase: Phase, command: Command) -> None:
    _, reply = answer(order(command), phase, situation(), CONFIG)
    breakable = (
        LANDING_PHASES
        | STATION_PHASES
        | {Phase.TAKEOFF, Phase.WAITING, Phase.ABORT, Phase.HOLD, Phase.ON_DECK, Phase.RALLY}
    )
    assert reply.accepted == (phase in breakable)


@pytest.mark.parametrize("command", [Command.ABORT, Command.HOLD])
def test_take_off_is_called_off_before_the_motors_turn_and_held_after(command: Command) -> None:
    facts = situation()
    on_the_ground = replace(facts, autopilot=replace(facts.autopilot, armed=False))
    assert answer(order(command), Phase.TAKEOFF, on_the_ground, CONFIG)[0] is Event.CALLED_OFF
    event, _ = answer(order(command), Phase.TAKEOFF, facts, CONFIG)
    assert event is not None
    assert next_phase(Phase.TAKEOFF, event) is Phase.HOLD


def test_start_says_how_to_compare_heights_once_the_autopilot_has_told_none_for_long() -> None:
    facts = situation()
    unplaced = replace(facts, autopilot=replace(facts.autopilot, receiver=Receiver()))
    _, reply = answer(order(Command.START), Phase.IDLE, unplaced, CONFIG, Cause(Reason.HEIGHTS_APART))
    assert reply == CommandReply(accepted=False, reason=Reason.HEIGHTS_APART.value)


def test_start_says_what_is_missing() -> None:
    facts = situation()
    view, drone = facts.autopilot, facts.drone
    assert drone is not None
    for missing, reason in (
        (replace(facts, autopilot=replace(view, link_up=False)), "no autopilot is connected"),
        (replace(facts, autopilot=replace(view, frame=None)), "the autopilot has no origin yet"),
        (replace(facts, autopilot=replace(view, receiver=Receiver())), "the autopilot has no origin yet"),
        (replace(facts, drone=None), "the autopilot reports no local position yet"),
        (replace(facts, drone=replace(drone, attitude_known=False)), "the autopilot's attitude is too old"),
        (
            replace(facts, autopilot=replace(view, failsafe=True)),
            "the autopilot is in a failsafe: the pilot has to change its mode first",
        ),
    ):
        event, reply = answer(order(Command.START), Phase.IDLE, missing, CONFIG)
        assert event is None
        assert reply.reason == reason


def _on(beside_m: float, height_m: float, *, speed_m_s: float, armed: bool) -> Situation:
    """A drone at rest somewhere about the pad of a vehicle."""
    pad = pad_at((speed_m_s, 0.0, 0.0))
    facts = situation(pad=pad)
    view = replace(facts.autopilot, armed=armed, landed=not armed)
    return replace(facts, drone=drone_at(height_m, beside_m, pad=pad), autopilot=view)


@pytest.mark.parametrize("phase", [Phase.SECURED, Phase.IDLE, Phase.PILOT])
def test_start_on_the_roof_of_a_vehicle_that_drives_is_refused(phase: Phase) -> None:
    event, reply = answer(order(Command.START), phase, _on(0.3, 0.0, speed_m_s=5.0, armed=False), CONFIG)
    assert event is None
    told = "the drone stands on the vehicle, which drives at 5.0 m/s: stop it, or launch with the motors off"
    assert reply.reason == told


@pytest.mark.parametrize(
    "facts",
    [
        _on(0.3, 0.0, speed_m_s=0.0, armed=False),
        _on(8.0, 0.0, speed_m_s=5.0, armed=False),
        _on(2.0, -1.5, speed_m_s=5.0, armed=False),
        _on(0.3, 0.5, speed_m_s=5.0, armed=True),
    ],
    ids=["standing vehicle", "beside it", "on the road", "in the air"],
)
def test_start_anywhere_else_is_not(facts: Situation) -> None:
    assert answer(order(Command.START), Phase.IDLE, facts, CONFIG)[1].accepted


def test_control_that_was_never_given_is_asked_for_again_by_the_next_start() -> None:
    """A pilot hovers; start, and hold before the autopilot has changed its mode."""
    flight = Flight(vehicle=KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (2.0, 0.0, 0.0)), refuses=frozenset({SET_MODE}))
    flight.view = replace(flight.view, armed=True, landed=False)
    flight.own = own_state(flight.t_ns, (0.0, 0.0, 6.5))
    flight.run(0.1)
    flight.step(Command.START)
    flight.run(0.3)
    flight.step(Command.HOLD)
    assert (flight.phase, flight.view.in_control) == (Phase.HOLD, False)
    flight.refuses = frozenset()
    flight.commands.clear()
    assert flight.step(Command.START).reply == CommandReply(accepted=True, reason="")
    assert flight.phase is Phase.TAKEOFF
    flight.run_until(Phase.WAITING, limit_s=5.0)
    assert flight.told(SET_MODE)
    assert flight.view.in_control


def test_drone_that_holds_under_control_waits_where_it_hovers_after_a_start() -> None:
    flight = Flight(vehicle=KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (2.0, 0.0, 0.0)))
    flight.start_and_reach(Phase.WAITING)
    flight.step(Command.HOLD)
    flight.step(Command.START)
    assert flight.history[-3:] == [Phase.WAITING, Phase.HOLD, Phase.WAITING]


def test_drone_whose_autopilot_does_not_say_that_it_flies_climbs_no_higher_by_each_start() -> None:
    flight = Flight(vehicle=KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (0.0, 0.0, 0.0)))
    flight.start_and_reach(Phase.WAITING)
    flight.run(3.0)
    assert flight.own is not None
    waits_m = float(flight.own.position_enu_m[2])
    for _ in range(2):
        flight.step(Command.HOLD)
        flight.view = replace(flight.view, landed=None)
        flight.step(Command.START)
        flight.run(4.0)
    assert flight.own.position_enu_m[2] == pytest.approx(waits_m, abs=0.2)


def test_drone_that_holds_too_low_climbs_to_wait_after_a_start() -> None:
    flight = Flight(vehicle=KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (0.0, 0.0, 0.0)))
    flight.start_and_reach(Phase.TAKEOFF)
    flight.run(1.0)
    flight.step(Command.HOLD)
    assert flight.own is not None
    held_m = float(flight.own.position_enu_m[2])
    flight.step(Command.START)
    flight.run(8.0)
    assert flight.phase is Phase.WAITING
    assert flight.own.position_enu_m[2] > held_m + 1.0
    assert flight.own.position_enu_m[2] == pytest.approx(CONFIG.takeoff.waiting_height_m, abs=0.3)
