"""The range finder looks along the body's axis, not straight down: what it measures grows with the lean."""

from math import cos, radians, sin, tan

import numpy as np
import pytest

from link.messages import Quaternion
from link.records import replace
from sim_autopilot.core.data import Deck
from sim_autopilot.core.range_finder import RangeErrors, RangeFinderModel
from sim_autopilot.physics.ground import ground_height
from sim_autopilot.telemetry.range_finder import distance_sensor
from tests.sim_autopilot.pilot import START_NS, Pilot, px4

EXACT = RangeFinderModel()
ROOF_M = 1.5
HALF_LENGTH_M = 2.25


def rolled(angle_deg: float) -> Quaternion:
    """Leaning to the right, so that the axis downwards points to the left, north here."""
    half = 0.5 * radians(angle_deg)
    return (cos(half), sin(half), 0.0, 0.0)


def distance_m(
    height_m: float,
    lean_deg: float,
    deck: Deck | None,
    beside_m: float = 0.0,
    *,
    error_m: float = 0.0,
    model: RangeFinderModel = EXACT,
) -> float:
    """What a range finder `height_m` above the road tells."""
    pilot = Pilot()
    memory = pilot.node.memory
    state = replace(
        memory.plant.state,
        t_ns=START_NS,
        position_enu_m=np.array([0.0, beside_m, height_m]),
        orientation_wxyz=np.array(rolled(lean_deg)),
    )
    world = replace(memory.world, deck=deck, range_error_m=error_m)
    memory = replace(memory, plant=replace(memory.plant, state=state), world=world)
    return float(distance_sensor(memory, px4(range_finder=model)).current_distance) / 100.0


def a_deck() -> Deck:
    return Deck(
        t_ns=START_NS,
        position_enu_m=np.zeros(3),
        orientation_wxyz=np.array([1.0, 0.0, 0.0, 0.0]),
        velocity_enu_m_s=np.zeros(3),
        angular_velocity_enu_rad_s=np.zeros(3),
        roof_size_m=(2.0 * HALF_LENGTH_M, 2.0),
        roof_height_m=ROOF_M,
    )


@pytest.mark.parametrize("lean_deg", [0.0, 12.0, 27.0])
def test_ground_is_farther_along_a_leaning_axis(lean_deg: float) -> None:
    assert distance_m(8.0, lean_deg, None) == pytest.approx(8.0 / cos(radians(lean_deg)), abs=0.01)


@pytest.mark.parametrize("lean_deg", [0.0, 8.0])
def test_roof_below_is_seen_along_the_axis(lean_deg: float) -> None:
    assert distance_m(6.0, lean_deg, a_deck()) == pytest.approx((6.0 - ROOF_M) / cos(radians(lean_deg)), abs=0.01)


def test_a_drone_over_the_roof_that_leans_far_looks_past_it() -> None:
    lean_deg = 25.0
    assert (6.0 - ROOF_M) * tan(radians(lean_deg)) > 1.0
    assert distance_m(6.0, lean_deg, a_deck()) == pytest.approx(6.0 / cos(radians(lean_deg)), abs=0.01)


def test_a_drone_beside_the_roof_that_leans_away_from_it_sees_it() -> None:
    side_m = [1.4 * side for side in (1.0, -1.0)]
    seen = {round(distance_m(6.0, 20.0, a_deck(), beside_m), 1) for beside_m in side_m}
    assert seen == {round((6.0 - ROOF_M) / cos(radians(20.0)), 1), round(6.0 / cos(radians(20.0)), 1)}


@pytest.mark.parametrize(("height_m", "told_m"), [(0.1, 0.2), (6.0, 6.05), (20.0, 12.0)])
def test_reading_is_off_by_its_error_and_stays_within_its_range(height_m: float, told_m: float) -> None:
    model = RangeFinderModel(min_m=0.2, max_m=12.0)
    assert distance_m(height_m, 0.0, None, error_m=0.05, model=model) == pytest.approx(told_m)


def test_errors_are_as_large_as_configured_and_the_seeds_own() -> None:
    errors = RangeErrors(RangeFinderModel(seed=1, white_std_m=0.03))
    many = [errors.advance() for _ in range(5000)]
    assert np.std(many) == pytest.approx(0.03, rel=0.05)
    assert many[0] == RangeErrors(RangeFinderModel(seed=1, white_std_m=0.03)).advance()
    assert many[0] != RangeErrors(RangeFinderModel(seed=2, white_std_m=0.03)).advance()
    assert RangeErrors(EXACT).advance() == 0.0


def test_nothing_is_seen_upside_down() -> None:
    assert distance_m(6.0, 120.0, None) == pytest.approx(100.0)


def test_ground_beside_a_road_that_leads_down_is_as_low() -> None:
    low_m, away_m = 20.0, 200.0
    deck = replace(a_deck(), position_enu_m=np.array([5.0, away_m, -low_m]))
    expected_m = 6.0 - ground_height(0.0, away_m, 5.0, away_m, -low_m, -low_m)
    model = RangeFinderModel(max_m=100.0)
    assert expected_m > low_m
    assert distance_m(6.0, 0.0, deck, away_m, model=model) == pytest.approx(expected_m, abs=0.01)


def test_valley_is_as_far_below_once_the_vehicle_has_left_it() -> None:
    low_m, away_m = 20.0, 200.0

    def leaves(t_ns: int) -> Deck:
        passed_s = (t_ns - START_NS) * 1e-9
        place = (away_m + 1e3 * passed_s, 0.0, min(0.0, 1e2 * passed_s - low_m))
        return replace(a_deck(), t_ns=t_ns, position_enu_m=np.array(place))

    pilot = Pilot(px4(range_finder=RangeFinderModel(max_m=100.0)), leaves)
    pilot.run(0.5)
    deck = pilot.node.memory.world.deck
    assert deck is not None
    assert deck.position_enu_m[2] == 0.0
    expected_m = 6.0 - ground_height(0.0, away_m, away_m + 500.0, 0.0, 0.0, -low_m)
    assert distance_m(6.0, 0.0, deck, away_m, model=RangeFinderModel(max_m=100.0)) == pytest.approx(expected_m, abs=0.2)
