"""A sortie step by step: launch, stations, the way home, silence and the battery; the drone follows exactly."""

import math

import numpy as np
import pytest

from companion.core.data import Array
from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.messages import Command, Station, StationFrame
from link.records import replace
from tests.companion.world import CONFIG, GEAR_M, STATION, Flight, KnownVehicle, on_deck, reached

RADIUS_M = CONFIG.sortie.vehicle_radius_m + CONFIG.sortie.keep_out_margin_m
LOW = Station(offset_m=(5.0, -4.0, 1.0), frame=StationFrame.COURSE)


def offset_m(flight: Flight) -> Array:
    """Of the drone's feet from the pad's centre, in W; the vehicle drives east."""
    offset = np.array(flight.own.position_enu_m) - flight.vehicle.at(flight.own.t_ns) - np.array([0.0, 0.0, GEAR_M])
    return np.asarray(offset)


def at_station(station: Station) -> Flight:
    flight = reached(Phase.FOLLOW)
    flight.station = station
    flight.step(Command.FOLLOW)
    flight.run(12.0)
    return flight


@pytest.mark.slow
def test_launch_leads_over_a_quiet_deck_to_a_station_above_the_pad() -> None:
    flight = on_deck()
    reply = flight.step(Command.LAUNCH).reply
    assert reply is not None
    assert reply.accepted
    flight.run_until(Phase.FOLLOW)
    assert flight.history == [Phase.IDLE, Phase.ON_DECK, Phase.LIFT_OFF, Phase.FOLLOW]
    flight.run(6.0)
    assert offset_m(flight) == pytest.approx([0.0, 0.0, CONFIG.chase.height_m], abs=0.05)


def test_setpoint_on_the_deck_has_the_decks_velocity_and_stays_below_the_drone() -> None:
    flight = reached(Phase.ON_DECK)
    flight.vehicle = replace_velocity(flight, (3.0, -1.0, 0.2))
    setpoint = flight.step().setpoint
    assert setpoint is not None
    assert setpoint.velocity_enu_m_s == pytest.approx((3.0, -1.0, 0.2), abs=0.01)
    assert setpoint.position_enu_m[2] < flight.own.position_enu_m[2]


def replace_velocity(flight: Flight, velocity_enu_m_s: tuple[float, float, float]) -> KnownVehicle:
    return KnownVehicle(flight.vehicle.start_enu_m, velocity_enu_m_s)


def test_another_station_is_flown_to_from_the_place_on_the_way_and_not_from_where_the_drone_lags() -> None:
    flight = reached(Phase.FOLLOW)
    flight.run(10.0)
    memory = flight.memory
    assert memory.sortie.way is not None
    assert memory.model.reference is not None
    lagging_m = memory.model.reference.position_enu_m - np.array([0.5, 0.2, 0.0])
    lagging = replace(memory.model.reference, position_enu_m=lagging_m)
    flight.memory = replace(memory, model=replace(memory.model, reference=lagging, plan=None))
    ahead_m, left_m, up_m = flight.station.offset_m
    flight.station = Station(offset_m=(ahead_m + 0.01, left_m, up_m))
    flight.step(Command.FOLLOW)
    way = flight.memory.sortie.way
    assert way is not None
    assert way.station == flight.station
    assert way.place_m == pytest.approx(memory.sortie.way.place_m, abs=0.05)


def test_launch_beside_the_vehicle_is_refused() -> None:
    flight = Flight()
    flight.run(0.1)
    reply = flight.step(Command.LAUNCH).reply
    assert reply is not None
    assert reply.reason == Reason.NOT_ON_DECK.value


def test_hold_on_the_deck_switches_off_what_turns() -> None:
    flight = reached(Phase.ON_DECK)
    flight.step(Command.HOLD)
    flight.run_until(Phase.SECURED, limit_s=2.0)


@pytest.mark.parametrize("frame", [StationFrame.VEHICLE, StationFrame.COURSE, StationFrame.NORTH])
def test_station_looks_ahead_as_its_frame_does(frame: StationFrame) -> None:
    flight = at_station(Station(offset_m=(-6.0, 2.0, 3.0), frame=frame))
    angle = {StationFrame.VEHICLE: 0.3, StationFrame.COURSE: 0.0, StationFrame.NORTH: 0.5 * math.pi}[frame]
    c, s = math.cos(angle), math.sin(angle)
    assert offset_m(flight) == pytest.approx([-6.0 * c - 2.0 * s, -6.0 * s + 2.0 * c, 3.0], abs=0.05)


@pytest.mark.slow
def test_a_change_of_station_flies_round_the_vehicle() -> None:
    flight = at_station(Station(offset_m=(-5.0, 4.0, 1.0), frame=StationFrame.COURSE))
    flight.station = LOW
    flight.step(Command.FOLLOW)
    nearest_m = math.inf
    for _ in range(600):
        flight.step()
        x, y, height_m = offset_m(flight).tolist()
        if height_m < CONFIG.descent.alignment.height_m:
            nearest_m = min(nearest_m, math.hypot(x, y))
    assert nearest_m > RADIUS_M - 0.5 * CONFIG.sortie.keep_out_margin_m
    assert offset_m(flight) == pytest.approx(LOW.offset_m, abs=0.05)


@pytest.mark.parametrize(
    ("offset", "reason"),
    [((1.0, 2.0, 0.5), Reason.STATION_IN_VEHICLE), ((150.0, 2.0, 5.0), Reason.STATION_TOO_FAR)],
)
def test_a_station_where_no_drone_may_be_is_refused(offset: tuple[float, float, float], reason: Reason) -> None:
    flight = reached(Phase.FOLLOW)
    flight.station = Station(offset_m=offset)
    reply = flight.step(Command.FOLLOW).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason.split("{")[0].startswith(reason.value.split("{")[0].strip())
    assert flight.memory.sortie.station == STATION


def test_start_from_a_low_station_climbs_before_it_lands() -> None:
    flight = at_station(LOW)
    flight.step(Command.START)
    assert flight.phase is Phase.RETURN
    flight.run_until(Phase.SECURED)
    assert Phase.ABORT not in flight.history


def test_abort_beside_the_vehicle_climbs_there_and_holds() -> None:
    flight = at_station(LOW)
    flight.step(Command.ABORT)
    flight.run_until(Phase.HOLD)
    x, y, height_m = offset_m(flight).tolist()
    assert math.hypot(x, y) > RADIUS_M - 0.5
    assert height_m > 0.7 * CONFIG.abort.height_m


def test_drone_comes_home_from_where_it_was_left() -> None:
    flight = reached(Phase.RETURN)
    assert math.hypot(*offset_m(flight)[:2].tolist()) > 30.0
    flight.run_until(Phase.SECURED)
    assert flight.history[-6:] == [
        Phase.RETURN,
        Phase.CHASE,
        Phase.ALIGN,
        Phase.DESCEND,
        Phase.TOUCHDOWN,
        Phase.SECURED,
    ]


def test_silent_vehicle_is_looked_for_ahead_and_followed_again() -> None:
    flight = reached(Phase.RALLY)
    place = flight.memory.sortie.place_enu_m
    assert place is not None
    assert place[0] > flight.vehicle.at(flight.t_ns)[0]
    flight.run(10.0)
    assert np.array(flight.own.position_enu_m) == pytest.approx(place, abs=0.3)
    flight.sends_fixes = True
    flight.run_until(Phase.FOLLOW, limit_s=3.0)


@pytest.mark.slow
def test_drone_comes_home_by_itself_before_the_reserve_is_needed() -> None:
    flight = at_station(STATION)
    texts: list[str] = []
    share = 0.5
    while flight.phase is Phase.FOLLOW:
        share -= 0.01
        flight.view = replace(flight.view, battery_share=share)
        texts += [one.text for one in flight.run(1.0) if one.text is not None]
    told = "".join(texts)
    assert "the way home has to begin" in told
    assert "comes home: the battery lasts" in told
    assert share > CONFIG.limits.battery_min_share
