"""A companion that ends in flight: the autopilot is to hover, but low above the pad the drone climbs or lands first."""

import pytest

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.px4 import Px4Driver
from companion.runtime.start_and_handover import LEAVE_MAX_S
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.world import CONFIG, DISARM, FLYING, SET_MODE, UTC_AHEAD_NS, Flight, on_deck, reached

ON_VEHICLE = frozenset({Phase.TOUCHDOWN, Phase.ON_DECK, Phase.LIFT_OFF})
LOITER = 4.0, 3.0  # PX4's main and sub mode, the second and third parameter of the command


def _modes(flight: Flight) -> int:
    return len(flight.told(SET_MODE))


@pytest.mark.slow
@pytest.mark.parametrize("phase", [phase for phase in FLYING if phase not in ON_VEHICLE])
def test_companion_that_ends_in_the_air_lets_the_autopilot_hover(phase: Phase) -> None:
    flight = reached(phase)
    flight.leaving, modes = True, _modes(flight)
    commands = flight.step().commands
    assert [(one.command, one.parameters[1:3]) for one in commands] == [(SET_MODE, LOITER)]
    assert _modes(flight) == modes + 1


@pytest.mark.slow
def test_companion_that_ends_on_the_pad_switches_the_motors_off_first() -> None:
    flight = reached(Phase.TOUCHDOWN)
    flight.leaving = True
    flight.run_until(Phase.SECURED, limit_s=0.6)
    assert not flight.view.armed
    assert Phase.TOUCHDOWN not in [phase for phase, *_ in flight.told(SET_MODE)]


def low_above_pad(height_m: float) -> Flight:
    """A descent that has come so low."""
    flight = reached(Phase.DESCEND)
    while flight.phase is Phase.DESCEND and height_above_pad_m(flight) > height_m:
        flight.step()
    assert flight.phase is Phase.DESCEND
    return flight


def height_above_pad_m(flight: Flight) -> float:
    told_m = flight.step().status.height_above_pad_m
    assert told_m is not None
    return told_m


@pytest.mark.slow
def test_companion_that_ends_low_above_the_pad_climbs_before_the_autopilot_hovers() -> None:
    flight = low_above_pad(0.6)
    flight.leaving, modes = True, _modes(flight)
    while _modes(flight) == modes:
        height_m = height_above_pad_m(flight)
        assert flight.phase is Phase.ABORT
    assert height_m > CONFIG.descent.wait.height_m


def test_companion_that_ends_as_it_lifts_off_climbs_clear_of_the_deck_before_the_autopilot_hovers() -> None:
    flight = reached(Phase.LIFT_OFF)
    flight.leaving, modes, begun_ns = True, _modes(flight), flight.monotonic_ns
    while _modes(flight) == modes:
        height_m = height_above_pad_m(flight)
        assert (flight.monotonic_ns - begun_ns) * 1e-9 < LEAVE_MAX_S
    assert height_m > CONFIG.descent.wait.height_m


@pytest.mark.slow
def test_companion_that_ends_below_the_commit_height_lands_first() -> None:
    flight = low_above_pad(0.2)
    flight.leaving, modes = True, _modes(flight)
    flight.run_until(Phase.SECURED, limit_s=LEAVE_MAX_S)
    assert not flight.view.armed
    assert Phase.ABORT not in flight.history[-3:]
    assert {phase for phase, *_ in flight.told(SET_MODE)[modes:]} <= {Phase.SECURED}


def armed_on_ground() -> Flight:
    """A drone whose motors turn and that has not lifted off, by its autopilot's word."""
    flight = reached(Phase.TAKEOFF)
    flight.view = replace(flight.view, landed=True)
    flight.refuses_plain_disarm = False
    return flight


@pytest.mark.parametrize("driver", [Px4Driver(), ArduPilotDriver()])
def test_companion_that_ends_before_the_lift_off_switches_the_motors_off_plainly(driver: Driver) -> None:
    flight = armed_on_ground()
    flight.driver, flight.leaving, modes = driver, True, _modes(flight)
    orders = len(flight.told(DISARM))
    flight.step()
    assert [one[2:] for one in flight.told(DISARM)[orders:]] == [(0.0, 0.0)]
    assert not flight.view.armed
    assert _modes(flight) == modes


def test_companion_that_ends_before_the_lift_off_lets_an_autopilot_hover_that_refuses_to_disarm() -> None:
    flight = armed_on_ground()
    flight.refuses, flight.leaving, modes = frozenset({DISARM}), True, _modes(flight)
    while _modes(flight) == modes:
        flight.view = replace(flight.view, landed=True)
        flight.step()
        assert flight.monotonic_ns - flight.memory.progress.since_ns < 2e9
    assert [force for *_, force in flight.told(DISARM)[1:]] == [0.0]


def test_companion_that_ends_on_the_pad_does_not_wait_for_a_disarm_that_never_comes() -> None:
    flight = reached(Phase.TOUCHDOWN)
    flight.refuses, flight.leaving, modes = frozenset({DISARM}), True, _modes(flight)
    begun_ns = flight.memory.progress.since_ns + UTC_AHEAD_NS
    while _modes(flight) == modes:
        flight.step()
        assert flight.monotonic_ns - begun_ns < 1.2e9
    assert flight.view.armed


def armed_on_deck() -> Flight:
    """A drone whose motors turn while it still stands on the deck."""
    flight = on_deck()
    flight.refuses_plain_disarm = False
    flight.step(Command.LAUNCH)
    while not flight.view.armed:
        flight.step()
    return flight


def test_companion_that_ends_while_the_drone_stands_on_the_deck_switches_the_motors_off() -> None:
    flight = armed_on_deck()
    assert flight.history[-1] is Phase.ON_DECK
    flight.leaving, modes = True, _modes(flight)
    flight.run_until(Phase.SECURED, limit_s=0.6)
    assert not flight.view.armed
    assert Phase.TOUCHDOWN not in [phase for phase, *_ in flight.told(SET_MODE)[modes:]]
