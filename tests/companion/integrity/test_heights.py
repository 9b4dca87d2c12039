"""Heights that cannot be: a road far off the ground beside it, a roof as high as the hover, less room than told."""

import numpy as np
import pytest

from companion.config.companion import SilentVehicleConfig
from companion.core.reasons import Reason, sentence
from companion.integrity.heights import is_road_elsewhere, is_seen_too_near, update_ground
from companion.landing.decisions.feasibility import OBSTACLES, obstacle
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from companion.vehicle.pad import PadMounting, PadPath
from link.messages import Command
from link.records import replace
from tests.companion.facts import CONFIG, GEAR_M, PAD_ENU_M, changed, drone_at, pad_at, situation
from tests.companion.world import PAD, PAD_HEIGHT_M, Flight, KnownVehicle


def near(sunk_m: float, away_m: float, pad: PadPath | None = None) -> Situation:
    """A vehicle whose road is told to be `sunk_m` below ground that is `away_m` from it."""
    pad = replace(pad_at() if pad is None else pad, height_m=PAD_HEIGHT_M)
    return changed(situation(pad=pad), ground_enu_m=PAD_ENU_M + np.array([0.0, away_m, sunk_m - PAD_HEIGHT_M]))


@pytest.mark.parametrize(
    ("sunk_m", "away_m", "expected"),
    [
        (30.0, 10.0, True),
        (4.0, 10.0, True),
        (-30.0, 25.0, True),
        (2.1, 10.0, False),  # a bank beside the road
        (-3.1, 25.0, False),  # a steep street
        (30.0, 31.0, False),
    ],
)
def test_road_far_off_the_ground_beside_it_is_no_hill(sunk_m: float, away_m: float, expected: bool) -> None:
    assert bool(is_road_elsewhere(None, Phase.WAITING, near(sunk_m, away_m), CONFIG)) is expected


def test_height_that_is_told_vaguely_may_be_farther_off() -> None:
    vague = replace(pad_at(std_m=3.0), is_coarse=True)
    assert not is_road_elsewhere(False, Phase.WAITING, near(6.0, 10.0, vague), CONFIG)
    assert is_road_elsewhere(False, Phase.WAITING, near(30.0, 10.0, vague), CONFIG)


def coarse_pad(up_std_m: float) -> PadPath:
    """A pad that poor receivers place, and less and less well in the future."""
    stds_m = np.outer([1.0, 2.0, 3.0, 4.0, 5.0], [9.0, 9.0, up_std_m])
    return replace(pad_at(), is_coarse=True, position_std_m=stds_m)


def test_height_of_poor_receivers_may_be_off_the_ground_by_two_deviations_and_the_slope() -> None:
    allowed_m = 2.0 * 3.0 + 10.0 * CONFIG.integrity.ground_slope_max
    assert not is_road_elsewhere(False, Phase.WAITING, near(allowed_m - 0.01, 10.0, coarse_pad(3.0)), CONFIG)
    assert is_road_elsewhere(False, Phase.WAITING, near(allowed_m + 0.01, 10.0, coarse_pad(3.0)), CONFIG)


def test_deck_of_a_ship_may_be_far_below_the_ground_beside_it() -> None:
    facts = near(30.0, 10.0, replace(pad_at(), mounting=PadMounting(is_afloat=True)))
    assert not is_road_elsewhere(False, Phase.WAITING, facts, CONFIG)


@pytest.mark.parametrize(("phase", "is_known"), [(Phase.ALIGN, False), (Phase.ABORT, False), (Phase.IDLE, True)])
def test_ground_is_not_known_after_an_outage_in_flight(phase: Phase, *, is_known: bool) -> None:
    silent = replace(situation(), drone=None)
    assert (update_ground(PAD_ENU_M, phase, silent) is not None) is is_known
    assert update_ground(PAD_ENU_M, phase, situation()) is not None


def test_in_flight_it_is_not_forgotten_of_a_vehicle_that_leaves() -> None:
    far = near(3.3, 28.0)
    assert not is_road_elsewhere(False, Phase.WAITING, far, CONFIG)
    assert is_road_elsewhere(True, Phase.WAITING, far, CONFIG)
    assert not is_road_elsewhere(True, Phase.IDLE, far, CONFIG)
    assert not is_road_elsewhere(True, Phase.WAITING, near(0.5, 10.0), CONFIG)


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.DESCEND, Phase.ABORT, Phase.HOLD])
def test_vehicle_that_is_followed_since_it_was_on_the_ground_may_climb_where_it_likes(phase: Phase) -> None:
    """As on the ramp of a garage, round and round above where the drone took off."""
    above = near(-6.0, 10.0)
    assert is_road_elsewhere(False, phase, above, CONFIG) is False
    assert is_road_elsewhere(None, phase, above, CONFIG) is True
    assert is_road_elsewhere(False, phase, near(6.0, 10.0), CONFIG) is True
    assert is_road_elsewhere(False, Phase.WAITING, above, CONFIG) is True


def test_without_known_ground_nothing_is_said() -> None:
    assert is_road_elsewhere(None, Phase.WAITING, changed(near(30.0, 10.0), ground_enu_m=None), CONFIG) is None


def test_ground_is_where_the_drone_stands_and_stays_in_flight() -> None:
    facts = situation(-1.5, 8.0)
    assert facts.drone is not None
    standing = replace(facts, autopilot=replace(facts.autopilot, armed=False, landed=True))
    ground = update_ground(None, Phase.IDLE, standing)
    assert ground is not None
    np.testing.assert_allclose(ground, facts.drone.position_enu_m - np.array([0.0, 0.0, GEAR_M]))
    assert update_ground(ground, Phase.WAITING, situation(4.0, 20.0)) is ground


@pytest.mark.parametrize(("armed", "landed"), [(False, None), (False, False), (True, True)])
def test_drone_stands_when_its_motors_are_off_or_its_autopilot_says_so(armed: bool, landed: bool | None) -> None:
    facts = situation(-1.5, 8.0)
    assert facts.drone is not None
    ground = update_ground(
        None, Phase.IDLE, replace(facts, autopilot=replace(facts.autopilot, armed=armed, landed=landed))
    )
    assert ground is not None
    assert ground[2] == pytest.approx(facts.drone.position_enu_m[2] - GEAR_M)


def test_ground_that_is_known_stays_while_the_range_finder_sees_nothing() -> None:
    assert update_ground(PAD_ENU_M, Phase.PILOT, situation(3.5, 8.0)) is PAD_ENU_M


def test_ground_of_a_drone_in_the_air_is_what_its_range_finder_sees() -> None:
    facts = changed(situation(3.5, 8.0), range_height_m=5.0)
    assert facts.drone is not None
    ground = update_ground(None, Phase.PILOT, facts)
    assert ground is not None
    assert ground[2] == pytest.approx(facts.drone.position_enu_m[2] - GEAR_M - 5.0)
    assert update_ground(None, Phase.PILOT, changed(facts, range_height_m=None)) is None


def test_roof_that_the_drone_stands_on_is_no_ground() -> None:
    facts = situation(0.0, 0.2)
    standing = replace(facts, autopilot=replace(facts.autopilot, armed=False, landed=True))
    assert update_ground(None, Phase.IDLE, standing) is None


@pytest.mark.parametrize(
    ("seen_m", "beside_m", "expected"),
    [(1.5, 0.0, False), (1.2, 0.0, False), (1.0, 0.0, True), (0.6, 8.0, False), (0.2, 8.0, True), (3.0, 8.0, False)],
)
def test_what_is_seen_nearer_than_the_pad_is_no_room(seen_m: float, beside_m: float, expected: bool) -> None:
    facts = changed(situation(1.5, beside_m), range_height_m=seen_m)
    assert is_seen_too_near(facts, CONFIG) is expected


@pytest.mark.parametrize(
    ("up_std_m", "allowed_m"), [(0.1, 0.7), (0.6, 1.2)], ids=["what poor receivers differ by", "two deviations"]
)
def test_pad_of_poor_receivers_may_be_nearer_than_told(up_std_m: float, allowed_m: float) -> None:
    for seen_m, expected in ((1.5 - allowed_m + 0.01, False), (1.5 - allowed_m - 0.01, True)):
        facts = changed(situation(1.5, pad=coarse_pad(up_std_m)), range_height_m=seen_m)
        assert is_seen_too_near(facts, CONFIG) is expected


@pytest.mark.parametrize(("lean_degrees", "expected"), [(0.0, True), (23.0, True), (24.0, False)])
def test_reading_of_a_drone_that_leans_far_says_nothing(lean_degrees: float, *, expected: bool) -> None:
    lean = float(np.sin(np.radians(lean_degrees)))
    facts = changed(situation(1.5), range_height_m=0.5)
    facts = replace(facts, drone=replace(drone_at(1.5, pad=pad_at()), lean=lean))
    assert is_seen_too_near(facts, CONFIG) is expected


def test_nothing_is_too_near_where_place_or_reading_are_not_known() -> None:
    facts = changed(situation(1.5), range_height_m=0.5)
    for unknown in (changed(facts, range_height_m=None), replace(facts, drone=None), replace(facts, pad=None)):
        assert is_seen_too_near(unknown, CONFIG) is False


def _refused(flight: Flight) -> str:
    flight.run(CONFIG.chase.driving_hold_s + 0.2)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert flight.phase is Phase.IDLE
    return reply.reason


def test_start_beside_a_vehicle_with_other_altitudes_is_refused_with_the_numbers() -> None:
    flight = Flight(vehicle=KnownVehicle((-12.0, 0.0, PAD_HEIGHT_M - 30.0), (0.0, 0.0, 0.0)))
    assert _refused(flight) == (
        "the vehicle's road is said to be 30.0 m below the ground 12 m from it: "
        "let drone and vehicle tell altitudes of one kind"
    )


def test_ground_that_an_outage_has_taken_is_not_told_in_numbers() -> None:
    facts = changed(near(30.0, 10.0), ground_enu_m=None, is_road_elsewhere=True)
    held = {one.reason: 0 for one in OBSTACLES if one.is_true(facts, CONFIG)}
    told = obstacle(held, facts, CONFIG)
    assert told is not None
    assert sentence(told).endswith("land, mend its altitude, start again")


@pytest.mark.parametrize("ground_is_known", [True, False])
def test_vehicle_that_is_only_seen_is_told_without_altitudes_that_it_does_not_tell(ground_is_known: bool) -> None:
    facts = changed(near(30.0, 10.0), is_road_elsewhere=True)
    facts = facts if ground_is_known else changed(facts, ground_enu_m=None)
    silent = CONFIG.model_copy(update={"silent_vehicle": SilentVehicleConfig()})
    told = obstacle({one.reason: 0 for one in OBSTACLES if one.is_true(facts, silent)}, facts, silent)
    assert told is not None
    assert told.reason is Reason.ROAD_ELSEWHERE
    assert "altitude" not in sentence(told)
    assert "the board's size, the camera's calibration or silent_vehicle.pad_height_m" in sentence(told)


@pytest.mark.slow
def test_vehicle_with_other_altitudes_that_comes_near_is_not_chased() -> None:
    flight = Flight(vehicle=KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M - 4.0), (4.0, 0.0, 0.0)))
    flight.start_and_reach(Phase.WAITING)
    outputs = flight.run(20.0)
    assert Phase.CHASE not in flight.history
    assert any("4.0 m below the ground" in (one.text or "") for one in outputs)


def test_start_beside_a_roof_that_is_too_high_says_how_much_higher_to_wait() -> None:
    flight = Flight(vehicle=KnownVehicle((-12.0, 0.0, 4.0), (0.0, 0.0, 0.0)), pad=replace(PAD, height_m=4.0))
    assert _refused(flight) == (
        "waiting 1.0 m above the pad, 1.2 m are needed: raise takeoff.waiting_height_m by 0.2 m or hover higher"
    )


@pytest.mark.parametrize(
    ("above_waiting_m", "advice"),
    [(0.06, "raise takeoff.waiting_height_m by 0.1 m or hover higher"), (0.2, "hover 0.1 m higher")],
)
def test_heights_that_are_told_differ_by_what_they_are_to_be_raised(above_waiting_m: float, advice: str) -> None:
    """Waiting 1.16 m above a pad is not to be told as the 1.2 m that are needed."""
    facts = situation(1.16)
    assert facts.drone is not None
    feet_m = float(facts.drone.position_enu_m[2]) - facts.feet_offset_m
    ground = np.array([0.0, 0.0, feet_m - above_waiting_m - CONFIG.takeoff.waiting_height_m])
    facts = changed(facts, armed=True, landed=False, ground_enu_m=ground)
    told = obstacle({one.reason: 0 for one in OBSTACLES if one.is_true(facts, CONFIG)}, facts, CONFIG)
    assert told is not None
    assert sentence(told) == f"waiting 1.1 m above the pad, 1.2 m are needed: {advice}"


@pytest.mark.slow
def test_drone_that_cannot_climb_over_a_roof_says_so_while_it_waits() -> None:
    roof_m = 2.0 * CONFIG.takeoff.waiting_height_m
    flight = Flight(vehicle=KnownVehicle((-400.0, 0.0, roof_m), (8.0, 0.0, 0.0)), pad=replace(PAD, height_m=roof_m))
    flight.start_and_reach(Phase.WAITING)
    flight.run(47.0)
    assert flight.outputs is not None
    assert "raise takeoff.waiting_height_m" in flight.outputs.status.reason


@pytest.mark.slow
def test_start_in_a_hold_waits_where_the_drone_hovers() -> None:
    flight = Flight()
    flight.start_and_reach(Phase.ALIGN)
    flight.step(Command.ABORT)
    flight.run_until(Phase.HOLD)
    flight.run(5.0)
    before = np.array(flight.own.position_enu_m)
    flight.vehicle = KnownVehicle((500.0, 0.0, PAD_HEIGHT_M), (0.0, 0.0, 0.0))
    flight.step(Command.START)
    flight.run(8.0)
    assert flight.phase is Phase.WAITING
    assert float(np.linalg.norm(np.array(flight.own.position_enu_m) - before)) < 0.1
    assert float(np.linalg.norm(before[:2])) > 3.0
