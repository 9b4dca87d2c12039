"""What a sortie may not do: override its operator, land unasked, brake on the deck, never come to its rally point."""

import math

import numpy as np
import pytest

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.core.reasons import Reason
from companion.landing.sortie.aims import rally_aim
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.sortie.memory import SortieMemory
from link.mavlink.dialect import mavlink
from link.messages import Command, Station
from link.records import replace
from tests.companion.world import CONFIG, GEAR_M, PAD_HEIGHT_M, Flight, KnownVehicle, on_deck, own_state, reached


def drain(flight: Flight) -> None:
    """Let the battery tell one percent a second, down to just above the reserve."""
    for share in (0.25, 0.24, 0.23, 0.22):
        flight.view = replace(flight.view, battery_share=share)
        flight.run(1.0)


def test_lift_off_whose_own_place_is_lost_is_not_called_off_by_an_old_word_of_standing() -> None:
    flight = on_deck()
    flight.step(Command.LAUNCH)
    flight.run_until(Phase.LIFT_OFF)
    flight.own_is_silent = True
    flight.view = replace(flight.view, landed=True)
    flight.run(3.0)
    assert flight.phase in {Phase.ABORT, Phase.HOLD}
    assert Phase.TOUCHDOWN not in flight.history


def test_launch_is_called_off_when_the_battery_is_found_empty_on_the_deck() -> None:
    flight = on_deck()
    flight.step(Command.LAUNCH)
    flight.view = replace(flight.view, battery_share=0.05)
    flight.run(3.0)
    assert flight.phase in {Phase.TOUCHDOWN, Phase.SECURED}
    assert flight.memory.progress.cause.reason in {Reason.BATTERY_LOW, Reason.MOTORS_OFF}


def test_drone_in_a_hold_comes_home_by_itself() -> None:
    flight = reached(Phase.FOLLOW)
    flight.step(Command.HOLD)
    flight.run_until(Phase.HOLD)
    drain(flight)
    assert Phase.RETURN in flight.history


@pytest.mark.parametrize("command", [Command.HOLD, Command.ABORT])
def test_operator_stops_a_drone_that_comes_home_by_itself(command: Command) -> None:
    flight = reached(Phase.FOLLOW)
    drain(flight)
    assert Phase.RETURN in flight.history
    flight.step(command)
    flight.run_until(Phase.HOLD)
    flight.run(3.0)
    assert flight.phase is Phase.HOLD


def far_from_home(*orders: Command) -> Flight:
    """A drone of a sortie with these orders, after a hold that the vehicle drives away from."""
    flight = reached(Phase.FOLLOW)
    for order in orders:
        flight.step(order)
        if order is Command.HOLD:
            flight.run_until(Phase.HOLD)
            flight.run(15.0)
    return flight


@pytest.mark.parametrize(
    ("orders", "phase"),
    [((Command.HOLD, Command.START), Phase.WAITING), ((Command.RETURN, Command.HOLD), Phase.HOLD)],
    ids=["waiting", "way home broken off"],
)
def test_drone_of_a_sortie_comes_home_from_where_an_operator_left_it(orders: tuple[Command], phase: Phase) -> None:
    flight = far_from_home(*orders)
    assert flight.phase is phase
    drain(flight)
    assert flight.history[-1] in {Phase.RETURN, Phase.CHASE}
    assert Phase.RETURN in flight.history[flight.history.index(phase) :]


def test_follow_is_refused_once_the_battery_calls_the_drone_home() -> None:
    flight = reached(Phase.FOLLOW)
    drain(flight)
    flight.run_until(Phase.RETURN, Phase.CHASE)
    flight.step(Command.HOLD)
    flight.run_until(Phase.HOLD)
    reply = flight.step(Command.FOLLOW).reply
    assert reply is not None
    assert reply.reason.startswith("comes home")
    assert flight.phase is Phase.HOLD


def test_return_is_not_advised_where_it_would_be_refused() -> None:
    flight = far_from_home(Command.RETURN, Command.HOLD)
    drain(flight)
    flight.step(Command.HOLD)
    flight.vehicle = KnownVehicle((2.0 * CONFIG.limits.range_max_m, 0.0, PAD_HEIGHT_M), (0.0, 0.0, 0.0))
    flight.run(3.0)
    assert flight.phase is Phase.HOLD
    assert flight.outputs is not None
    assert flight.outputs.status.reason_code == Reason.VEHICLE_OUT_OF_RANGE.name
    reply = flight.step(Command.RETURN).reply
    assert reply is not None
    assert not reply.accepted


def test_landing_of_a_drone_that_held_before_may_be_retried() -> None:
    flight = reached(Phase.FOLLOW)
    flight.step(Command.HOLD)
    flight.run_until(Phase.HOLD)
    drain(flight)
    assert flight.memory.progress.may_retry


def silent(phase: Phase, leads_to: Phase) -> Flight:
    """A flight whose autopilot has fallen silent in `phase`, for as long as that takes to be noticed."""
    flight = reached(phase)
    flight.own_is_silent = True
    flight.run_until(leads_to, limit_s=3.0)
    return flight


@pytest.mark.parametrize("silent_s", [0.0, CONFIG.abort.time_limit_s - 0.3, CONFIG.abort.time_limit_s + 2.0])
def test_drone_that_lost_its_own_place_beside_the_vehicle_goes_back_there_and_does_not_land(silent_s: float) -> None:
    flight = silent(Phase.FOLLOW, Phase.ABORT)
    flight.run(silent_s)
    flight.own_is_silent = False
    flight.run_until(Phase.FOLLOW, Phase.CHASE, limit_s=60.0)
    assert flight.history[-3:] == [Phase.ABORT, Phase.HOLD, Phase.FOLLOW]
    assert flight.reason is Reason.HEARD_AGAIN


@pytest.mark.parametrize("silent_s", [2.0, CONFIG.abort.time_limit_s + 2.0])
def test_lift_off_that_a_silent_vehicle_broke_off_goes_on_to_the_station_once_that_is_heard(silent_s: float) -> None:
    flight = reached(Phase.LIFT_OFF)
    flight.sends_fixes = False
    flight.run_until(Phase.ABORT, limit_s=3.0)
    assert flight.reason is Reason.VEHICLE_DATA_OLD
    flight.run(silent_s)
    flight.sends_fixes = True
    flight.run_until(Phase.FOLLOW, limit_s=20.0)
    assert (flight.history[-3:], flight.reason) == ([Phase.ABORT, Phase.HOLD, Phase.FOLLOW], Reason.HEARD_AGAIN)


def lands_without_data(phase: Phase, silent_s: float) -> Flight:
    """A sortie whose vehicle has been silent from this phase of its landing on, and that holds because of it."""
    flight = reached(Phase.FOLLOW)
    flight.step(Command.RETURN)
    flight.run_until(phase, limit_s=30.0)
    flight.sends_fixes = False
    flight.run_until(Phase.ABORT, limit_s=3.0)
    flight.run(silent_s)
    flight.sends_fixes = silent_s < CONFIG.abort.time_limit_s
    flight.run_until(Phase.HOLD, limit_s=3.0)
    return flight


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN, Phase.DESCEND])
@pytest.mark.parametrize(
    ("longer_s", "reason"), [(0.1, Reason.NO_VEHICLE_DATA), (-0.3, Reason.HEARD_WITH_BREAKS)], ids=["silent", "late"]
)
def test_landing_of_a_sortie_that_a_silent_vehicle_broke_off_goes_on_once_that_is_heard(
    phase: Phase, longer_s: float, reason: Reason
) -> None:
    flight = lands_without_data(phase, CONFIG.abort.time_limit_s + longer_s)
    assert flight.reason is reason
    flight.sends_fixes = True
    flight.run_until(Phase.RETURN, limit_s=5.0)
    assert flight.reason is Reason.HEARD_AGAIN


def test_last_landing_of_a_sortie_that_a_silent_vehicle_broke_off_is_the_last() -> None:
    flight = lands_without_data(Phase.CHASE, CONFIG.abort.time_limit_s + 0.1)
    progress = replace(flight.memory.progress, retries=CONFIG.abort.retries_max)
    flight.memory = replace(flight.memory, progress=progress)
    flight.sends_fixes = True
    flight.run(5.0)
    assert flight.phase is Phase.HOLD


def test_way_home_goes_on_after_an_outage_of_the_autopilots_link() -> None:
    flight = silent(Phase.RETURN, Phase.HOLD)
    flight.run(2.0)
    assert flight.phase is Phase.HOLD
    flight.own_is_silent = False
    flight.run(0.5 * CONFIG.abort.heard_hold_s)
    assert flight.phase is Phase.HOLD
    flight.run_until(Phase.RETURN, limit_s=2.0)


@pytest.mark.parametrize("command", [Command.HOLD, Command.ABORT])
def test_hold_that_was_ordered_after_an_outage_stays_one(command: Command) -> None:
    flight = silent(Phase.RETURN, Phase.HOLD)
    flight.step(command)
    flight.own_is_silent = False
    flight.run(5.0)
    assert flight.phase is Phase.HOLD
    assert flight.reason in (Reason.OPERATOR_HOLDS, Reason.OPERATOR_ABORTS)


def test_start_from_a_hold_begins_a_landing_that_knows_no_station() -> None:
    flight = reached(Phase.FOLLOW)
    flight.step(Command.ABORT)
    flight.run_until(Phase.HOLD)
    flight.step(Command.START)
    flight.vehicle = KnownVehicle((flight.own.position_enu_m[0] + 2.0, 0.0, PAD_HEIGHT_M), (0.0, 0.0, 0.0))
    flight.run_until(Phase.CHASE)
    assert flight.memory.sortie.station is None


def used_up(flight: Flight) -> Flight:
    """Let all retries of the flight before be used up."""
    progress = replace(flight.memory.progress, retries=CONFIG.abort.retries_max)
    flight.memory = replace(flight.memory, progress=progress)
    return flight


def test_launch_counts_approaches_anew() -> None:
    flight = used_up(on_deck())
    flight.step(Command.LAUNCH)
    assert flight.phase is Phase.ON_DECK
    assert flight.memory.progress.retries == 0


def test_return_counts_approaches_anew() -> None:
    flight = reached(Phase.HOLD)
    flight.run(15.0)  # the vehicle drives away
    used_up(flight).step(Command.RETURN)
    assert flight.phase is Phase.RETURN
    assert flight.memory.progress.retries == 0


def test_arducopter_takes_setpoints_from_its_own_take_off_with_the_decks_velocity() -> None:
    flight = reached(Phase.LIFT_OFF)
    flight.driver = ArduPilotDriver()
    flight.refuses = frozenset({mavlink.MAV_CMD_NAV_TAKEOFF})
    flight.vehicle = KnownVehicle(flight.vehicle.start_enu_m, (6.0, -1.0, 0.0))
    flight.view = replace(flight.view, landed=True)

    def ride() -> None:
        x, y, z = flight.vehicle.at(flight.t_ns).tolist()
        flight.own = own_state(flight.t_ns, (x, y, z + GEAR_M), flight.vehicle.velocity_enu_m_s)

    for _ in range(5):
        ride()
        assert flight.step().setpoint is None
    flight.view = replace(flight.view, landed=False, taking_off=True)
    ride()
    setpoint = flight.step().setpoint
    assert setpoint is not None
    assert setpoint.velocity_enu_m_s is not None
    assert setpoint.velocity_enu_m_s[:2] == pytest.approx((6.0, -1.0), abs=0.1)


def test_touchdown_stays_down_while_nobody_knows_the_pad() -> None:
    flight = reached(Phase.ON_DECK)
    flight.view = replace(flight.view, armed=True)
    flight.step(Command.HOLD)
    assert flight.phase is Phase.TOUCHDOWN
    flight.memory = replace(flight.memory, vehicle=replace(flight.memory.vehicle, estimator=None))
    flight.sends_fixes = False
    flight.own_is_silent = False
    heights = []
    for _ in range(45):
        setpoint = flight.step().setpoint
        assert setpoint is not None
        heights.append(setpoint.position_enu_m[2])
    assert max(heights) < PAD_HEIGHT_M + GEAR_M + 0.1


def test_lift_off_that_loses_the_vehicle_on_its_deck_switches_the_motors_off() -> None:
    flight = reached(Phase.LIFT_OFF)
    flight.view = replace(flight.view, landed=True)
    flight.memory = replace(flight.memory, vehicle=replace(flight.memory.vehicle, estimator=None))
    flight.sends_fixes = False
    flight.step()
    assert flight.phase is Phase.TOUCHDOWN


def test_vehicle_that_outruns_a_drone_of_unknown_battery_is_no_warning() -> None:
    flight = reached(Phase.FOLLOW)
    flight.step(Command.HOLD)
    flight.run_until(Phase.HOLD)
    flight.vehicle = KnownVehicle((400.0, 0.0, PAD_HEIGHT_M), (40.0, 0.0, 0.0))
    texts = [one.text for one in flight.run(1.0)]
    assert flight.memory.sortie.warning is None
    assert not any("nan" in text for text in texts if text is not None)


@pytest.mark.parametrize("height_m", [8.0, 29.0, 60.0])
def test_rally_point_is_reached_from_any_height(height_m: float) -> None:
    sortie = SortieMemory(is_out=True, place_enu_m=np.array([50.0, 10.0, 30.0]))
    anchor, rally = np.array([0.0, 0.0, 30.0]), np.array([200.0, -40.0, height_m])
    here = np.array([50.0, 10.0, 30.0])
    for _ in range(2000):
        reference = ReferenceState(position_enu_m=here, velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.zeros(3))
        way = rally_aim(sortie, anchor, reference, rally).target.position_enu_m[0] - here
        here = here + way * min(1.0 / max(math.hypot(*way.tolist()), 1e-9), 1.0)
    assert here == pytest.approx(rally, abs=0.01)


def test_drone_with_a_rally_point_goes_there_when_no_place_was_forecast() -> None:
    reference = ReferenceState(
        position_enu_m=np.array([0.0, 0.0, 30.0]), velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.zeros(3)
    )
    rally = np.array([200.0, -40.0, 40.0])
    aim = rally_aim(SortieMemory(is_out=True), np.array([0.0, 0.0, 30.0]), reference, rally)
    assert aim.target.position_enu_m[0] == pytest.approx(rally)


def test_station_beside_a_vehicle_out_of_range_is_refused() -> None:
    flight = reached(Phase.HOLD)
    flight.vehicle = KnownVehicle((2.0 * CONFIG.limits.range_max_m, 0.0, PAD_HEIGHT_M), (0.0, 0.0, 0.0))
    flight.station = Station(offset_m=(-6.0, 2.0, 3.0))
    reply = flight.step(Command.FOLLOW).reply
    assert reply is not None
    assert not reply.accepted
