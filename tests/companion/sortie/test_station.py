"""Ways to a station lead round the vehicle and arrive; laws over drawn starts and stations."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from companion.core.data import Array
from companion.sortie.station import KeepOut, is_clear, is_inside, turn_rates_rad_s, turned, way_to
from link.messages import StationFrame
from link.records import replace
from tests.companion.facts import pad_at

VEHICLE = KeepOut(radius_m=4.0, over_m=1.5, lowest_m=0.5)
RATES = (1.5, 8.0)
STEP_S = 0.2
places = st.tuples(st.floats(-14.0, 14.0), st.floats(-14.0, 14.0), st.floats(0.5, 9.0)).map(np.array)


def fly(start: Array, wanted: Array, duration_s: float = 60.0) -> Array:
    """The places on the way, one for each step."""
    return way_to(start, wanted, VEHICLE, np.arange(0.0, duration_s, STEP_S), RATES)


def allowed(place: Array) -> bool:
    return not is_inside((float(place[0]), float(place[1]), float(place[2])), VEHICLE)


@given(start=places, wanted=places)
def test_a_way_between_two_stations_never_enters_the_vehicle(start: Array, wanted: Array) -> None:
    assume(allowed(start) and allowed(wanted))
    way = fly(start, wanted)
    for a, b in pairwise(way):
        chord_m = math.hypot(*(b - a).tolist())
        sagitta_m = chord_m**2 / (8.0 * VEHICLE.radius_m)  # of an arc of its radius, that a step cuts
        thinner = KeepOut(radius_m=VEHICLE.radius_m - sagitta_m - 1e-9, over_m=1.5 - 1e-9, lowest_m=0.5)
        assert is_clear(a, b, thinner)


@given(start=places, wanted=places)
def test_a_way_ends_at_its_station(start: Array, wanted: Array) -> None:
    assume(allowed(start) and allowed(wanted))
    assert fly(start, wanted)[-1] == pytest.approx(wanted, abs=1e-9)


@given(start=places, wanted=places)
def test_no_step_of_a_way_is_faster_than_it_may_be(start: Array, wanted: Array) -> None:
    assume(allowed(start) and allowed(wanted) and np.linalg.norm(wanted - start) > 0.4)
    steps = np.diff(fly(start, wanted), axis=0)
    # About the vehicle the three parts of a step, along the arc, outward and up, are each as fast as it may be.
    assert np.linalg.norm(steps, axis=1).max() <= math.sqrt(3.0) * RATES[1] * STEP_S


@pytest.mark.parametrize("far_m", [8.0, 40.0, 300.0])
@pytest.mark.parametrize("height_m", [0.5, 1.4, 3.0])
def test_a_way_home_comes_nearer_from_the_first_step_on_as_fast_as_it_can_stop(far_m: float, height_m: float) -> None:
    home = np.array([0.0, 0.0, 3.5])
    way = fly(np.array([far_m, 0.0, height_m]), home, 90.0)
    rates_m_s = -np.diff(way[:, 0]) / STEP_S
    beside = way[:-1, 0] > VEHICLE.radius_m + 2.0
    stops_m_s = np.sqrt(2.0 * RATES[0] * (way[:-1, 0] - VEHICLE.radius_m).clip(min=0.0))
    assert (rates_m_s[beside] >= 0.8 * np.minimum(stops_m_s, RATES[1])[beside]).all()
    assert (rates_m_s <= np.minimum(np.sqrt(2.0 * RATES[0] * way[:-1, 0].clip(min=0.0)), RATES[1]) + 1e-9).all()
    assert way[-1] == pytest.approx(home, abs=1e-9)


@pytest.mark.parametrize(
    ("start", "leaves_by"),
    [((0.7, 0.4, 0.1), "up"), ((2.9, -1.7, 0.1), "side")],
)
def test_a_drone_in_the_cylinder_leaves_it_where_it_is_nearest(
    start: tuple[float, float, float], leaves_by: str
) -> None:
    first = fly(np.array(start), np.array([-7.0, 1.0, 3.0]))[1] - np.array(start)
    rises = first[2] > 0.0 and math.hypot(first[0], first[1]) < 1e-9
    assert rises == (leaves_by == "up")


def test_a_turned_offset_keeps_its_length_and_height() -> None:
    offset = turned(np.array([3.0, -1.0, 2.0]), 0.7)
    assert np.linalg.norm(offset) == pytest.approx(math.sqrt(14.0))
    assert offset == pytest.approx([3.0 * math.cos(0.7) + math.sin(0.7), 3.0 * math.sin(0.7) - math.cos(0.7), 2.0])


@pytest.mark.parametrize("frame", [StationFrame.VEHICLE, StationFrame.COURSE])
def test_an_acceleration_across_the_course_of_a_vehicle_that_does_not_turn_turns_no_station(
    frame: StationFrame,
) -> None:
    pad = pad_at((0.6, 0.0, 0.0))
    across = replace(pad, acceleration_enu_m_s2=np.tile([-2.0, 0.8, 0.0], (len(pad.offset_s), 1)))
    assert turn_rates_rad_s(frame, across).max() > 0.4
    known = replace(across, yaw_rate_rad_s=np.zeros(len(pad.offset_s)))
    assert not turn_rates_rad_s(frame, known).any()
