"""A take-off from a vehicle that drives off before the drone has lifted off."""

import numpy as np
import pytest

from companion.autopilots.driver import DriverMemory
from companion.autopilots.messages import TOLD_S, arm
from companion.core.reasons import Reason
from companion.landing.decisions.events import decide
from companion.landing.sortie.riding import CARRIED_OFF, call_off, rides_along
from companion.landing.state.memory import ControlMemory
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation
from link.messages import Command
from link.records import replace
from tests.companion.facts import CONFIG, IN_CONTROL, NOW_NS, changed, pad_at, progress, situation
from tests.companion.world import DISARM, GEAR_M, START_NS, KnownVehicle, on_deck, own_state

VAGUE_M = 2.0
LONG_HELD = {Reason.RIDES_ALONG: NOW_NS - round(1e9 * CONFIG.chase.driving_hold_s)}


def carried(
    speed_m_s: float,
    own_m_s: float,
    *,
    armed: bool,
    landed: bool | None = True,
    std_m: float = 0.05,
    range_m: float | None = None,
) -> Situation:
    """A drone that stands at the pad's height and moves at `own_m_s` while the vehicle drives."""
    facts = situation(0.1, 0.3, pad_at((speed_m_s, 0.0, 0.0), std_m=std_m))
    assert facts.drone is not None
    drone = replace(facts.drone, velocity_enu_m_s=np.array([own_m_s, 0.0, 0.0]))
    facts = changed(facts, range_height_m=range_m)
    return replace(facts, drone=drone, autopilot=replace(facts.autopilot, armed=armed, landed=landed))


@pytest.mark.parametrize(
    ("facts", "is_off"),
    [
        (carried(1.5, 1.4, armed=True), True),
        (carried(1.5, 1.4, armed=False, landed=None), True),
        (carried(0.1, 0.1, armed=True), False),  # it stands
        (carried(1.5, 1.4, armed=True, landed=False), False),  # it has lifted off
        (carried(1.5, 1.4, armed=True, landed=False, range_m=0.01), True),  # its motors speed up
        (carried(1.5, 1.4, armed=True, landed=None), False),  # it may have
        (carried(1.5, 0.05, armed=True), False),  # it stands on the ground beside it
        (carried(1.5, 0.05, armed=False, std_m=VAGUE_M), False),
    ],
)
def test_drone_is_carried_off_that_stands_and_moves_with_the_vehicle(facts: Situation, *, is_off: bool) -> None:
    assert CARRIED_OFF.is_true(facts, CONFIG) is is_off


@pytest.mark.parametrize(
    ("facts", "rides"),
    [
        (carried(5.0, 4.9, armed=True, landed=False), True),  # a companion died as it touched: the motors turn on
        (carried(5.0, 4.9, armed=False), True),
        (carried(5.0, 4.9, armed=True, landed=False, range_m=0.02), True),
        (carried(5.0, 4.9, armed=True, landed=False, range_m=0.3), False),  # it flies along
        (carried(5.0, 0.1, armed=True, landed=False), False),  # the vehicle passes below a drone that hovers
        (carried(0.1, 0.1, armed=True, landed=False), False),  # it stands
    ],
)
def test_start_finds_a_drone_on_a_driving_roof_even_if_its_autopilot_says_that_it_flies(
    facts: Situation, *, rides: bool
) -> None:
    assert rides_along(facts, CONFIG) is rides


@pytest.mark.parametrize(("armed", "event"), [(True, Event.CARRIED_OFF), (False, Event.CALLED_OFF)])
def test_take_off_of_a_drone_that_is_carried_off_for_long_enough_is_called_off(event: Event, *, armed: bool) -> None:
    facts = carried(1.5, 1.4, armed=armed)
    decision = call_off(LONG_HELD, IN_CONTROL, facts, CONFIG)
    assert decision is not None
    assert (decision[0], decision[1].reason) == (event, Reason.RIDES_ALONG)
    assert call_off({Reason.RIDES_ALONG: NOW_NS}, IN_CONTROL, facts, CONFIG) is None


ARMING = [(0.0, True), (0.9 * TOLD_S, True), (TOLD_S, False)]


def asked_to_arm(ago_s: float) -> ControlMemory:
    return ControlMemory(driver=DriverMemory(asked_ns={arm(armed=True): NOW_NS - round(ago_s * 1e9)}))


@pytest.mark.parametrize(("ago_s", "may_turn"), ARMING)
def test_motors_that_were_just_asked_for_are_stopped_as_if_they_turned(ago_s: float, *, may_turn: bool) -> None:
    decision = call_off(LONG_HELD, asked_to_arm(ago_s), carried(1.5, 1.4, armed=False), CONFIG)
    assert decision is not None
    assert decision[0] is (Event.CARRIED_OFF if may_turn else Event.CALLED_OFF)


@pytest.mark.parametrize(("ago_s", "may_turn"), ARMING)
def test_motors_that_were_just_asked_for_are_not_taken_for_off(ago_s: float, *, may_turn: bool) -> None:
    now = progress(Phase.TOUCHDOWN, 0.1)
    decision = decide(now, asked_to_arm(ago_s), carried(0.1, 0.1, armed=False), CONFIG)
    assert (decision is None) is may_turn
    assert decision is None or decision[0] is Event.MOTORS_OFF


def test_take_off_ends_on_the_vehicle_that_drives_off_with_the_motors_off() -> None:
    flight = on_deck()
    flight.step(Command.START)
    drives = False
    while flight.phase is Phase.TAKEOFF and flight.t_ns < START_NS + 5_000_000_000:
        if flight.view.armed and not drives:
            x, y, z = flight.vehicle.start_enu_m
            flight.vehicle = KnownVehicle((x - 3.0 * (flight.t_ns - START_NS) * 1e-9, y, z), (3.0, 0.0, 0.0))
            drives = True
        x, y, z = flight.vehicle.at(flight.t_ns).tolist()
        flight.own = own_state(flight.t_ns, (x, y, z + GEAR_M), flight.vehicle.velocity_enu_m_s)
        flight.view = replace(flight.view, landed=True)
        flight.step()
    assert drives
    assert (flight.phase, flight.reason) == (Phase.TOUCHDOWN, Reason.RIDES_ALONG)
    assert flight.told(DISARM)[-1][2] == 0.0
    flight.run(TOLD_S)
    assert (flight.phase, flight.reason) == (Phase.IDLE, Reason.RIDES_ALONG)
