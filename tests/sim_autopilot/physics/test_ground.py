"""The ground goes along with a road that leads down, and stays down behind it: for forces, range finder and score."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.records import replace
from scenarios.scoring.touch import Box, touches
from scenarios.scoring.truth_log import truth_log
from sim_autopilot.core.data import Deck, Surface
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.physics.ground import CUTTING_M, PASSES_M, START_M, ground_height, ground_height_kernel
from sim_autopilot.plant.config import PlantConfig
from tests.scenarios.scoring.synthetic import STILL, TIMES_S, body
from tests.sim_autopilot.flights import at_rest, driving, flown, hovering

CONFIG = PlantConfig()
FAR_M = 200.0
"""From the start."""
LOW_M = 20.0
BOX = Box(roof_size_m=(4.0, 1.8), roof_height_m=1.5, pad_size_m=(1.5, 1.5))


def down_there(t_s: float) -> Deck:
    """A vehicle that stands beside the drone, `LOW_M` below the start."""
    deck = driving()(t_s)
    return replace(deck, position_enu_m=np.array([FAR_M + 5.0, 0.0, -LOW_M]))


PLACES = st.tuples(*4 * [st.floats(-1e4, 1e4)])


@given(PLACES, st.floats(-CUTTING_M, 1e3))
def test_roads_that_do_not_lead_down_leave_the_ground_flat(
    places: tuple[float, float, float, float], road_m: float
) -> None:
    assert ground_height(*places, road_m, road_m) == 0.0


@given(PLACES, st.floats(-1e3, 0.0))
def test_ground_is_in_a_cutting_above_the_road_but_where_the_drone_starts(
    places: tuple[float, float, float, float], road_m: float
) -> None:
    assert ground_height(*places, road_m, road_m) in {0.0, road_m + CUTTING_M}


@given(st.floats(-1e3, 0.0), st.floats(0.0, 1e3), st.floats(PASSES_M, 1e3))
def test_valley_that_the_vehicle_has_left_stays_as_low(low_m: float, rises_m: float, left_m: float) -> None:
    road_m = low_m + rises_m
    behind_m = ground_height(FAR_M, 0.0, FAR_M + left_m, 0.0, road_m, low_m)
    assert behind_m == ground_height(FAR_M, 0.0, FAR_M, 0.0, low_m, low_m)
    assert ground_height(FAR_M, 0.0, FAR_M, 0.0, road_m, low_m) == ground_height(FAR_M, 0.0, FAR_M, 0.0, road_m, road_m)


def test_ground_of_the_start_stays_until_the_road_leads_through_there() -> None:
    assert ground_height(0.5 * START_M, 0.0, 2.0 * PASSES_M, 0.0, -LOW_M, -LOW_M) == 0.0
    assert ground_height(0.5 * START_M, 0.0, 0.5 * PASSES_M, 0.0, -LOW_M, -LOW_M) == CUTTING_M - LOW_M


@given(st.tuples(*4 * [st.floats(-50.0, 50.0)]), st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_compiled_functions_have_the_same_ground(
    places: tuple[float, float, float, float], road_m: float, low_m: float
) -> None:
    assert ground_height_kernel(*places, road_m, low_m) == ground_height(*places, road_m, low_m)


def test_drone_stands_on_the_ground_beside_a_road_that_has_led_down() -> None:
    ground_m = ground_height(FAR_M, 0.0, FAR_M + 5.0, 0.0, -LOW_M, -LOW_M)
    assert ground_m == CUTTING_M - LOW_M
    stands = at_rest(CONFIG, (FAR_M, 0.0, ground_m + GEAR_HEIGHT_M))
    flight = flown(CONFIG, stands, lambda _: None, 5.0, deck_at=down_there)
    assert set(flight.surface) == {Surface.GROUND}
    assert np.abs(flight.position_m[200:] - flight.position_m[200]).max() < 1e-9


@pytest.mark.parametrize("above_m", [0.3, 3.0])
def test_drone_below_its_start_is_pushed_by_no_ground_that_it_is_above(above_m: float) -> None:
    high_m = CUTTING_M - LOW_M + GEAR_HEIGHT_M + above_m
    flight = flown(CONFIG, hovering(CONFIG, (FAR_M, 0.0, high_m)), lambda _: None, 0.1, deck_at=down_there)
    assert set(flight.surface) == {Surface.NONE}
    assert np.abs(flight.position_m[:, 2] - high_m).max() < 0.05


def test_waves_move_no_ground() -> None:
    deck = replace(down_there(0.0), is_afloat=True)
    flight = flown(CONFIG, at_rest(CONFIG, (FAR_M, 0.0, GEAR_HEIGHT_M)), lambda _: None, 1.0, deck_at=lambda _: deck)
    assert set(flight.surface) == {Surface.GROUND}
    assert np.abs(flight.position_m[:, 2] - GEAR_HEIGHT_M).max() < 0.01
    drone = [body(t_s, (FAR_M, 0.0, 1.0 + GEAR_HEIGHT_M), STILL) for t_s in TIMES_S]
    vehicle = [body(t_s, (FAR_M + 5.0, 0.0, -LOW_M), STILL) for t_s in TIMES_S]
    assert touches(truth_log(drone, vehicle, []), replace(BOX, is_afloat=True)).height_m.min() == pytest.approx(1.0)


@pytest.mark.parametrize(("above_m", "touches_it"), [(1.0, False), (-0.2, True)])
def test_score_counts_the_ground_where_it_is(above_m: float, *, touches_it: bool) -> None:
    place = (FAR_M, 0.0, CUTTING_M - LOW_M + GEAR_HEIGHT_M + above_m)
    drone = [body(t_s, place, STILL) for t_s in TIMES_S]
    vehicle = [body(t_s, (FAR_M + 5.0, 0.0, -LOW_M), STILL) for t_s in TIMES_S]
    found = touches(truth_log(drone, vehicle, []), BOX)
    assert found.any.all() == found.any.any() == touches_it
    assert found.height_m.min() == pytest.approx(above_m)


def test_score_counts_a_valley_after_the_vehicle_has_left_it() -> None:
    drone = [body(t_s, (FAR_M, 5.0, 1.0 - LOW_M), STILL) for t_s in TIMES_S]
    vehicle = [body(t_s, (FAR_M + 4.0 * PASSES_M * i, 0.0, -LOW_M / (1 + i)), STILL) for i, t_s in enumerate(TIMES_S)]
    assert not touches(truth_log(drone, vehicle, []), BOX).any.any()
