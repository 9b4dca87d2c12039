"""A sortie's bounds: on what it lands, how long it comes home, how far it looks, what a vague place keeps it out of."""

import math

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.core.data import Rival
from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.messages import Command, PadGeometry, Station, StationFrame
from link.records import replace
from tests.companion.world import CONFIG, GEAR_M, PAD_HEIGHT_M, Flight, KnownVehicle, configured, reached

LOW = Station(offset_m=(1.0, 5.0, 1.0), frame=StationFrame.COURSE)


def with_config(flight: Flight, config: CompanionConfig) -> Flight:
    flight.config = config
    return flight


def low_on_battery(flight: Flight) -> Flight:
    flight.view = replace(flight.view, battery_share=0.15)
    return flight


@pytest.mark.parametrize(
    ("rival", "pad_m", "reason"),
    [(Rival(drone="other", is_this_drone=False), 1.5, Reason.VEHICLE_TAKEN), (None, 0.3, Reason.PAD_TOO_SMALL)],
)
def test_drone_that_comes_home_stays_above_what_it_cannot_land_on_and_says_why(
    rival: Rival | None, pad_m: float, reason: Reason
) -> None:
    flight = low_on_battery(reached(Phase.RETURN))
    flight.rival = rival
    flight.pad = PadGeometry(size_m=(pad_m, pad_m), height_m=PAD_HEIGHT_M, antenna_to_pad_m=(0.0, 0.0, 0.0))
    flight.run(14.0)
    assert flight.phase is Phase.RETURN
    above = np.array(flight.own.position_enu_m) - flight.vehicle.at(flight.own.t_ns) - np.array([0.0, 0.0, GEAR_M])
    assert above == pytest.approx([0.0, 0.0, CONFIG.chase.height_m], abs=0.3)
    assert flight.outputs is not None
    assert flight.outputs.status.reason_code == reason.name


@pytest.mark.parametrize("std_m", [0.9, 1.4])
def test_drone_comes_home_to_a_vehicle_whose_place_is_vague(std_m: float) -> None:
    flight = reached(Phase.RETURN)
    flight.vehicle = KnownVehicle(flight.vehicle.start_enu_m, flight.vehicle.velocity_enu_m_s, std_m=std_m)
    flight.run_until(Phase.CHASE, limit_s=20.0)
    above = np.array(flight.own.position_enu_m) - flight.vehicle.at(flight.own.t_ns)
    assert np.hypot(*above[:2]) <= CONFIG.chase.passing_distance_m + 3.0 * std_m
    assert above[2] > CONFIG.abort.near_height_m


def test_way_home_that_takes_too_long_ends_in_a_hold_that_lasts() -> None:
    flight = with_config(reached(Phase.RETURN), configured({"sortie": {"return_time_limit_s": 1.0}}))
    flight.run_until(Phase.HOLD, limit_s=2.0)
    assert flight.reason is Reason.RETURN_TOO_LONG
    low_on_battery(flight).run(2.0)
    assert flight.phase is Phase.HOLD


@pytest.mark.parametrize("command", [Command.FOLLOW, Command.RETURN])
def test_order_is_refused_while_another_mode_flies(command: Command) -> None:
    flight = reached(Phase.HOLD)
    flight.memory = replace(flight.memory, control=replace(flight.memory.control, was_in_control=False))
    flight.view = replace(flight.view, in_control=False)
    reply = flight.step(command).reply
    assert reply is not None
    assert reply.reason == f"the companion does not fly the drone: start it first, then {command.value}"
    assert flight.phase is Phase.HOLD


def test_silent_vehicle_is_looked_for_within_the_range() -> None:
    flight = with_config(reached(Phase.FOLLOW), configured({"limits": {"range_max_m": 10.0}}))
    flight.vehicle = KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (12.0, 0.0, 0.0))
    flight.sends_fixes = False
    flight.run_until(Phase.RALLY)
    model, place = flight.memory.model.reference, flight.memory.sortie.place_enu_m
    assert model is not None
    assert place is not None
    assert math.hypot(*(place - model.position_enu_m)[:2].tolist()) <= 10.0 + 0.5  # since then it has flown on


FAR_RALLY = configured(
    {"sortie": {"rally_point_deg_m": [48.0, 8.0, 30.0], "expect_s": 8.0}}
)  # the origin is at 47.6 degrees north


def test_station_is_refused_with_a_rally_point_out_of_range() -> None:
    flight = with_config(reached(Phase.HOLD), FAR_RALLY)
    reply = flight.step(Command.FOLLOW).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason.startswith("sortie.rally_point_deg_m is ")


def test_no_rally_point_out_of_range_is_flown_to() -> None:
    flight = with_config(reached(Phase.RALLY), FAR_RALLY)
    flight.run(FAR_RALLY.sortie.expect_s + 0.1)
    place = flight.memory.sortie.place_enu_m
    assert place is not None
    assert flight.memory.model.reference is not None
    assert flight.memory.model.reference.position_enu_m == pytest.approx(place, abs=0.3)


def station_of(std_m: float, apart_std_m: float, frames: str) -> list[float]:
    flight = with_config(reached(Phase.FOLLOW), configured({"integrity": {"receiver_frames": frames}}))
    start_enu_m, velocity_enu_m_s = flight.vehicle.start_enu_m, flight.vehicle.velocity_enu_m_s
    flight.vehicle = KnownVehicle(start_enu_m, velocity_enu_m_s, std_m=std_m, apart_std_m=apart_std_m)
    flight.station = LOW
    flight.step(Command.FOLLOW)
    flight.run(10.0)
    offset = np.array(flight.own.position_enu_m) - flight.vehicle.at(flight.own.t_ns) - np.array([0.0, 0.0, GEAR_M])
    x, y, height_m = offset.tolist()
    assert flight.outputs is not None
    told = flight.outputs.status.station_offset_m
    assert told is not None
    assert [math.hypot(*told[:2]), told[2]] == pytest.approx([math.hypot(x, y), height_m], abs=0.1)
    return [math.hypot(x, y), height_m]


@pytest.mark.parametrize(
    ("apart_std_m", "frames", "vague_m"), [(math.inf, "one", 1.0), (0.8, "one", 0.6), (0.8, "apart", 1.0)]
)
def test_station_is_kept_farther_out_and_higher_by_what_is_vague_of_the_vehicles_place_in_the_frame_that_counts(
    apart_std_m: float, frames: str, vague_m: float
) -> None:
    sortie = CONFIG.sortie
    least_m = sortie.vehicle_radius_m + sortie.keep_out_margin_m + sortie.keep_out_stds * vague_m
    lowest_m = sortie.ground_clearance_m - PAD_HEIGHT_M + sortie.keep_out_stds * vague_m
    kept = station_of(1.0, apart_std_m, frames)
    assert kept == pytest.approx([max(least_m, math.hypot(*LOW.offset_m[:2])), max(lowest_m, LOW.offset_m[2])], abs=0.1)


def test_drone_that_does_not_follow_its_setpoints_leaves_its_station() -> None:
    flight = reached(Phase.FOLLOW)
    flight.run(2.0)
    flight.config = configured({"abort": {"tracking_stds_max": 0.5}})
    x, y, z = flight.own.position_enu_m
    for _ in range(150):
        flight.own = replace(flight.own, position_enu_m=(x, y, z), velocity_enu_m_s=(0.0, 0.0, 0.0))
        flight.step()
    assert Phase.ABORT in flight.history
    assert flight.memory.progress.cause.reason is Reason.SETPOINT_NOT_FOLLOWED


def test_nothing_pulls_a_drone_back_to_where_its_deck_was() -> None:
    flight = reached(Phase.ON_DECK)
    vehicle = KnownVehicle(flight.vehicle.start_enu_m, (6.0, -1.0, 0.0))
    flight.vehicle = vehicle
    for _ in range(100):
        x, y, z = vehicle.at(flight.t_ns).tolist()
        flight.own = replace(
            flight.own, t_ns=flight.t_ns, position_enu_m=(x, y, z + GEAR_M), velocity_enu_m_s=vehicle.velocity_enu_m_s
        )
        setpoint = flight.step().setpoint
    assert setpoint is not None
    assert setpoint.velocity_enu_m_s is not None
    assert setpoint.acceleration_enu_m_s2 is not None
    assert setpoint.velocity_enu_m_s[:2] == pytest.approx((6.0, -1.0), abs=0.01)
    assert setpoint.acceleration_enu_m_s2[:2] == pytest.approx((0.0, 0.0), abs=0.05)
