"""Whole flights of the step against an exact vehicle and an exact autopilot: the way of a landing."""

import numpy as np
import pytest

from companion.core.reasons import Reason
from companion.situation.phases import LANDING_PHASES, Phase
from link.messages import Command, PadGeometry
from link.records import replace
from tests.companion.world import (
    CONFIG,
    DISARM,
    GEAR_M,
    IMPATIENT,
    PAD_HEIGHT_M,
    SET_MODE,
    Flight,
    KnownVehicle,
    own_state,
    reached,
)

ORDER = (
    Phase.IDLE,
    Phase.TAKEOFF,
    Phase.WAITING,
    Phase.CHASE,
    Phase.ALIGN,
    Phase.DESCEND,
    Phase.TOUCHDOWN,
    Phase.SECURED,
)
LEVER = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.8, 0.3, 0.0))


def test_landing_goes_through_its_phases_once_and_ends_with_motors_off() -> None:
    flight = Flight()
    flight.start_and_reach(Phase.SECURED)
    assert tuple(flight.history) == ORDER
    assert not flight.view.armed
    assert flight.step().setpoint is None
    assert flight.told(DISARM)[-1][0] is Phase.TOUCHDOWN


def test_start_is_refused_without_what_a_flight_needs() -> None:
    flight = Flight()
    good = flight.view
    for view, reason in (
        (replace(good, link_up=False), "no autopilot is connected"),
        (replace(good, frame=None), "the autopilot has no origin yet"),
        (replace(good, failsafe=True), "the autopilot is in a failsafe: the pilot has to change its mode first"),
    ):
        flight.view = view
        reply = flight.step(Command.START).reply
        assert reply is not None
        assert not reply.accepted
        assert reply.reason == reason
    assert flight.phase is Phase.IDLE


def test_setpoints_flow_before_the_mode_is_asked_for() -> None:
    flight = Flight()
    flight.run(0.1)
    flight.step(Command.START)
    while not flight.commands:
        assert flight.step().setpoint is not None
    assert flight.commands[0][1] == SET_MODE


def test_start_in_the_air_waits_where_the_drone_is() -> None:
    flight = Flight()
    flight.own = own_state(flight.t_ns, (1.0, 2.0, 9.0))
    flight.view = replace(flight.view, armed=True, landed=False)
    flight.start_and_reach(Phase.WAITING)
    flight.run(1.0)
    np.testing.assert_allclose(flight.own.position_enu_m, (1.0, 2.0, 9.0), atol=1e-6)
    assert not flight.told(DISARM)


def test_drone_that_waits_lower_than_the_pad_does_not_chase() -> None:
    low = CONFIG.takeoff.model_copy(update={"waiting_height_m": 1.0})
    flight = Flight(config=CONFIG.model_copy(update={"takeoff": low}))
    flight.own = own_state(flight.t_ns, (1.0, 0.4, 1.0))
    flight.view = replace(flight.view, armed=True, landed=False)
    flight.start_and_reach(Phase.WAITING)
    flight.run(8.0)
    assert flight.phase is Phase.WAITING


def test_hold_stays_where_it_is() -> None:
    flight = reached(Phase.HOLD)
    flight.run(3.0)
    place = flight.own.position_enu_m
    flight.run(5.0)
    np.testing.assert_allclose(flight.own.position_enu_m, place, atol=0.02)


@pytest.mark.slow
def test_retries_end_in_a_hold_and_a_new_start_has_them_all_again() -> None:
    flight = Flight()
    flight.start_and_reach(Phase.WAITING)
    for _ in range(2):
        before = len(flight.history)
        flight.run_until(Phase.CHASE)
        for retry in range(CONFIG.abort.retries_max + 1):
            flight.run_until(Phase.ALIGN)
            flight.own = replace(flight.own, t_ns=flight.t_ns - 10**9)
            flight.step()
            assert flight.reason is Reason.OWN_POSITION_OLD
            flight.run_until(Phase.CHASE, Phase.HOLD)
            assert flight.phase is (Phase.CHASE if retry < CONFIG.abort.retries_max else Phase.HOLD)
        assert flight.reason is Reason.NO_RETRY_LEFT
        assert flight.history[before:].count(Phase.ABORT) == CONFIG.abort.retries_max + 1
        flight.vehicle = replace(flight.vehicle, start_enu_m=_behind(flight, 20.0))
        flight.step(Command.START)


def _behind(flight: Flight, distance_m: float) -> tuple[float, float, float]:
    """Where the vehicle started if it is now `distance_m` before the waiting point."""
    assert flight.memory.places.waiting_point_enu_m is not None
    x, y, z = flight.vehicle.start_enu_m
    ahead_m = flight.memory.places.waiting_point_enu_m[0] - distance_m - flight.vehicle.at(flight.t_ns)[0]
    return (x + float(ahead_m), y, z)


@pytest.mark.slow
@pytest.mark.parametrize("end", [Phase.SECURED, Phase.PILOT, Phase.HOLD])
def test_second_flight_is_like_the_first(end: Phase) -> None:
    flight = Flight()
    if end is Phase.SECURED:
        flight.start_and_reach(Phase.SECURED)
    else:
        flight.start_and_reach(Phase.WAITING)
        if end is Phase.PILOT:
            flight.view = replace(flight.view, in_control=False)
            flight.step()
        else:
            flight.step(Command.HOLD)
    flight.run(3.0)
    flight.vehicle = replace(flight.vehicle, start_enu_m=(flight.own.position_enu_m[0] - 60.0, 0.4, PAD_HEIGHT_M))
    flight.vehicle = replace(flight.vehicle, start_enu_m=_behind(flight, 60.0))
    if end is Phase.SECURED:
        flight.view = replace(flight.view, in_control=False, landed=True)
    before = len(flight.history)
    flight.step(Command.START)
    flight.run_until(Phase.SECURED)
    expected = ORDER[2:] if end is Phase.HOLD else ORDER[1:]
    assert tuple(flight.history[before:]) == expected
    assert flight.memory.progress.retries == 0


def test_motors_that_the_autopilot_itself_switches_off_on_the_pad_end_the_landing() -> None:
    flight = reached(Phase.TOUCHDOWN)
    flight.view = replace(flight.view, armed=False, in_control=False)
    flight.step()
    assert flight.phase is Phase.SECURED


@pytest.mark.slow
def test_unknown_heading_with_a_lever_arm_keeps_the_drone_above_the_height_of_alignment() -> None:
    flight = Flight(
        vehicle=KnownVehicle((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0), yaw_rad=None), pad=LEVER, config=IMPATIENT
    )
    flight.start_and_reach(Phase.CHASE)
    lowest_m = np.inf
    while flight.phase is not Phase.HOLD:
        outputs = flight.step()
        if flight.phase in LANDING_PHASES:
            lowest_m = min(lowest_m, flight.own.position_enu_m[2] - GEAR_M - PAD_HEIGHT_M)
            assert outputs.status.reason == "vehicle heading unknown"
    assert lowest_m > 0.9 * CONFIG.descent.alignment.height_m
    assert flight.reason is Reason.HEADING_UNKNOWN
    assert Phase.DESCEND not in flight.history


@pytest.mark.slow
def test_heading_that_becomes_known_lets_the_landing_go_on() -> None:
    flight = Flight(
        vehicle=KnownVehicle((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0), yaw_rad=None), pad=LEVER, config=IMPATIENT
    )
    flight.start_and_reach(Phase.ALIGN)
    flight.run(2.0)
    assert flight.history[-1] is Phase.ALIGN
    flight.vehicle = replace(flight.vehicle, yaw_rad=0.0)
    flight.run_until(Phase.DESCEND)
    flight.vehicle = replace(flight.vehicle, yaw_rad=None)
    flight.step()
    assert flight.phase is Phase.ABORT
    assert flight.reason is Reason.HEADING_UNKNOWN


@pytest.mark.slow
def test_vehicle_that_stands_with_an_unknown_heading_is_waited_for() -> None:
    flight = Flight(
        vehicle=KnownVehicle((5.0, 0.4, PAD_HEIGHT_M), (0.0, 0.0, 0.0), yaw_rad=None), pad=LEVER, config=IMPATIENT
    )
    flight.start_and_reach(Phase.WAITING)
    outputs = flight.run(IMPATIENT.chase.parked_wait_s + 5.0)[-1]
    assert flight.phase is Phase.WAITING
    assert outputs.status.reason == "vehicle heading unknown"
