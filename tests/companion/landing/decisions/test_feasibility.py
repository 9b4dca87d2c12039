"""What cannot be landed on is refused with its numbers, once, and not chased."""

from dataclasses import dataclass

import pytest

from companion.config.companion import CompanionConfig
from companion.core.data import Array, Forecast
from companion.core.reasons import Cause, Reason, sentence
from companion.landing.decisions.aborts import ABORTS
from companion.landing.decisions.feasibility import OBSTACLES
from companion.landing.steering.following_height import chase_floor_m
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.world import CONFIG, GEAR_M, PAD, PAD_HEIGHT_M, START_NS, Flight, KnownVehicle, own_state

ROOF_M = CONFIG.takeoff.waiting_height_m  # as high as the drone hovers: no chase begins there


@dataclass(frozen=True)
class VagueVehicle(KnownVehicle):
    """One whose fixes are coarse, so that its pad has to be seen."""

    def forecast(self, memory: int | None, t_ns: int, offset_s: Array) -> Forecast | None:
        known = super().forecast(memory, t_ns, offset_s)
        return None if known is None else replace(known, is_coarse=True)


def passing_at(roof_m: float, height_std_m: float) -> Flight:
    vehicle = VagueVehicle((-60.0, 0.4, roof_m), (4.0, 0.0, 0.0), std_m=height_std_m)
    return Flight(vehicle=vehicle, pad=replace(PAD, height_m=roof_m))


@pytest.mark.parametrize("lower_m", [0.1, 2.0])
def test_drone_climbs_to_look_at_a_pad_whose_height_is_vague(lower_m: float) -> None:
    flight = passing_at(ROOF_M - lower_m, height_std_m=1.45)
    flight.start_and_reach(Phase.CHASE)
    assert flight.own.position_enu_m[2] - flight.vehicle.at(flight.t_ns)[2] - GEAR_M >= chase_floor_m(CONFIG)


@pytest.mark.parametrize("roof_m", [ROOF_M - 0.1, ROOF_M + 2.0])
def test_drone_that_waits_makes_room_for_a_roof_that_is_too_high(roof_m: float) -> None:
    flight = passing_at(roof_m, height_std_m=0.05)
    flight.start_and_reach(Phase.CHASE)
    assert flight.own.position_enu_m[2] - roof_m - GEAR_M >= chase_floor_m(CONFIG)


def test_roof_that_is_higher_than_the_drone_climbs_is_not_chased() -> None:
    flight = passing_at(2.0 * CONFIG.takeoff.waiting_height_m, height_std_m=0.05)
    flight.start_and_reach(Phase.WAITING)
    outputs = flight.run(15.0)
    assert Phase.CHASE not in flight.history
    assert Reason.ROOF_TOO_HIGH.name in {one.status.reason_code for one in outputs}


@pytest.mark.parametrize("roof_m", [PAD_HEIGHT_M, ROOF_M - 1.0])
@pytest.mark.parametrize("height_m", [0.4, 2.2, ROOF_M + 0.1, ROOF_M + 0.7])
def test_start_in_the_air_is_accepted_where_the_drone_will_wait_high_enough(height_m: float, roof_m: float) -> None:
    flight = Flight(vehicle=KnownVehicle((-12.0, 0.7, roof_m), (0.0, 0.0, 0.0)), pad=replace(PAD, height_m=roof_m))
    flight.own = own_state(START_NS, (0.0, 0.0, height_m + GEAR_M))
    flight.view = replace(flight.view, armed=True, landed=False)
    flight.run(CONFIG.chase.driving_hold_s + 0.1)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert reply.accepted is (max(height_m, ROOF_M) - roof_m > chase_floor_m(CONFIG))
    waits_enu_m = flight.memory.places.waiting_point_enu_m
    if reply.accepted:
        assert waits_enu_m is not None
        assert waits_enu_m[2] - roof_m - GEAR_M > chase_floor_m(CONFIG)


FAST = KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (14.2, 0.0, 0.0))


def limited(**limits: float) -> CompanionConfig:
    return CONFIG.model_copy(update={"limits": CONFIG.limits.model_copy(update=limits)})


def test_start_is_refused_with_the_numbers() -> None:
    flight = Flight(vehicle=FAST, config=limited(speed_max_m_s=12.0))
    flight.run(CONFIG.chase.driving_hold_s + 0.1)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason.startswith("vehicle at 14.2 m/s needs 16.3 m/s, the limit is 12.0: raise limits.speed_max_m_s")
    assert flight.commands == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("config", "battery_share", "told"),
    [
        (limited(speed_max_m_s=12.0), None, "needs 16.3 m/s"),
        (limited(range_max_m=100.0), None, "goes 213 m in 15 s, limits.range_max_m is 100"),
        (CONFIG, 0.15, "battery at 15 %"),
    ],
)
def test_vehicle_out_of_reach_is_told_once_and_let_go(
    config: CompanionConfig, battery_share: float | None, told: str
) -> None:
    flight = Flight(vehicle=replace(FAST, start_enu_m=(-200.0, 0.4, PAD_HEIGHT_M)), config=config)
    flight.sends_fixes = False
    flight.start_and_reach(Phase.WAITING)
    flight.sends_fixes = True
    flight.view = replace(flight.view, battery_share=battery_share)
    outputs = flight.run(16.0)
    assert flight.phase is Phase.WAITING
    assert Phase.CHASE not in flight.history
    assert len([one.text for one in outputs if one.text is not None and told in one.text]) == 1
    assert told in outputs[100].status.reason


def test_waiting_drone_that_does_not_know_where_it_is_says_so_and_goes_on_once_it_does() -> None:
    flight = Flight(vehicle=replace(FAST, start_enu_m=(-200.0, 0.4, PAD_HEIGHT_M)))
    flight.sends_fixes = False
    flight.start_and_reach(Phase.WAITING)
    flight.own_is_silent = True
    *_, lost = flight.run(CONFIG.abort.own_age_max_s + 0.2)
    assert flight.phase is Phase.WAITING
    assert lost.status.reason == sentence(Cause(Reason.OWN_POSITION_OLD))
    flight.own_is_silent = False
    *_, found = flight.run(0.2)
    assert found.status.reason != lost.status.reason


def test_vehicle_that_slows_down_is_chased_after_all() -> None:
    flight = Flight(vehicle=FAST, config=limited(speed_max_m_s=12.0))
    flight.sends_fixes = False
    flight.start_and_reach(Phase.WAITING)
    flight.sends_fixes = True
    flight.run(1.0)
    x, y, _ = flight.own.position_enu_m
    flight.vehicle = KnownVehicle((x - 8.0 - 4.0 * (flight.t_ns - START_NS) * 1e-9, y, PAD_HEIGHT_M), (4.0, 0.0, 0.0))
    flight.run_until(Phase.CHASE, limit_s=5.0)


def test_what_makes_a_landing_impossible_is_no_reason_to_break_one_off() -> None:
    # Held under one name, it would begin the climb of an abort anew in every step.
    before = {(obstacle.reason, phase) for obstacle in OBSTACLES for phase in obstacle.phases}
    assert not before & {(test.reason, phase) for test in ABORTS for phase in test.phases}
