"""What a drone beside a vehicle does whose stamps step, that outruns it, or whose deck it may have left."""

import pytest

from companion.core.reasons import Reason
from companion.landing.sortie.riding import has_not_left_deck
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.facts import changed, drone_at, pad_at, situation
from tests.companion.world import CONFIG, START_NS, Flight, KnownVehicle, reached

SIDE_M_S = 6.0  # a step of 0.3 s is 1.8 m then


def drive_on(flight: Flight, speed_m_s: float) -> None:
    """Let the vehicle drive on at another speed from where it is."""
    x, y, z = flight.vehicle.at(flight.t_ns).tolist()
    driven_m = speed_m_s * (flight.t_ns - START_NS) * 1e-9
    flight.vehicle = KnownVehicle((x - driven_m, y, z), (speed_m_s, 0.0, 0.0))


def test_station_is_left_upwards_once_the_vehicles_stamps_have_stepped() -> None:
    flight = reached(Phase.FOLLOW)
    drive_on(flight, SIDE_M_S)
    flight.run(10.0)
    assert flight.phase is Phase.FOLLOW
    flight.stamps_ahead_s = -0.3
    flight.run_until(Phase.ABORT, limit_s=2.0)
    assert flight.reason is Reason.STAMPS_STEPPED
    flight.run_until(Phase.HOLD)
    assert Phase.RALLY not in flight.history


def test_vehicle_whose_clock_is_ahead_is_not_found_while_it_is() -> None:
    flight = reached(Phase.FOLLOW)
    flight.stamps_ahead_s = 1.0
    flight.run_until(Phase.RALLY)
    flight.run(5.0)
    assert flight.history[-1] is Phase.RALLY
    assert flight.history.count(Phase.RALLY) == 1
    flight.stamps_ahead_s = 0.0
    flight.run_until(Phase.FOLLOW, limit_s=CONFIG.abort.heard_hold_s + 3.0)


def test_vehicle_that_outruns_the_drone_is_let_go_and_said_so() -> None:
    flight = reached(Phase.FOLLOW)
    drive_on(flight, CONFIG.limits.speed_max_m_s + 5.0)
    flight.run_until(Phase.RALLY, limit_s=CONFIG.chase.driving_hold_s + 1.0)
    assert flight.reason is Reason.VEHICLE_OUTRUNS
    flight.run(3.0)
    assert flight.phase is Phase.RALLY
    assert flight.memory.sortie.warning is None


@pytest.mark.parametrize(
    ("landed", "range_height_m", "stands"),
    [(True, None, True), (False, 0.01, False), (None, None, False), (None, 0.01, True), (None, 0.3, False)],
)
def test_autopilot_that_does_not_say_that_it_stands_needs_a_range_finder_that_sees_the_deck(
    landed: bool | None,
    range_height_m: float | None,
    *,
    stands: bool,
) -> None:
    facts = changed(situation(), drone=drone_at(0.1, 0.0, pad=pad_at()), range_height_m=range_height_m)
    facts = replace(facts, autopilot=replace(facts.autopilot, landed=landed))
    assert has_not_left_deck(facts, CONFIG) is stands


@pytest.mark.parametrize(("landed", "leads_to"), [(True, Phase.TOUCHDOWN), (None, Phase.ABORT)])
def test_abort_in_a_lift_off_asks_no_drone_to_disarm_that_may_fly(landed: bool | None, leads_to: Phase) -> None:
    flight = reached(Phase.LIFT_OFF)
    flight.view = replace(flight.view, landed=landed)
    flight.step(Command.ABORT)
    assert flight.phase is leads_to
