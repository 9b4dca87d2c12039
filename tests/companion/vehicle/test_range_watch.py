"""Which readings are believed: those that agree, that change as the drone moves; and how far a roof rises."""

import math

import pytest

from companion.core.data import OwnState, RangeReading
from companion.vehicle.range_watch import RangeWatch, moved_up, watch_ranges
from link.frames.rotations import quaternion_from_roll_pitch_yaw

HEIGHT_M = 5.0
PERIOD_NS = 50_000_000


def _reading(index: int, surface_m: float, *, height_m: float = HEIGHT_M, roll_rad: float = 0.0) -> RangeReading:
    """A reading of a surface as high as given, `index` periods on."""
    own = OwnState(
        t_ns=index * PERIOD_NS,
        position_enu_m=(3.0, 4.0, height_m),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=quaternion_from_roll_pitch_yaw(roll_rad, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )
    return RangeReading(t_ns=own.t_ns, distance_m=height_m - surface_m, own=own)


def _watch(readings: list[RangeReading], climbs_m: float = 0.0) -> float | None:
    """How far the last of them rises, None where it is not believed, over a road that climbs by so much a period."""
    watch, rises_m = RangeWatch(), None
    for i, seen in enumerate(readings):
        watch, rises_m = watch_ranges(watch, seen, climbs_m * i)
    return rises_m


@pytest.mark.parametrize(
    ("heights_m", "is_believed"),
    [
        ((1.5, 1.5, 1.52, 1.49, 1.5), True),
        ((1.5, 1.5, 1.5, 1.5), False),  # too few yet
        ((1.5, 1.5, 1.5, 1.5, 1.9), False),
        ((0.0, 0.0, 0.0, 1.5, 1.5), False),  # the roof's edge
        ((0.0, 0.0, 1.5, 1.5, 1.5), True),
        ((1.5, 0.6, 1.5, 0.6, 1.5), True),  # this one, and the others were left out
    ],
)
def test_reading_is_believed_that_agrees_with_most_of_the_last(
    heights_m: tuple[float, ...], *, is_believed: bool
) -> None:
    assert (_watch([_reading(i, height_m) for i, height_m in enumerate(heights_m)]) is not None) is is_believed


def test_readings_of_long_ago_agree_with_nothing() -> None:
    assert _watch([*(_reading(i, 1.5) for i in range(4)), _reading(24, 1.5)]) is None


@pytest.mark.parametrize("sinks_m", [0.06, -0.06])
def test_range_finder_that_says_the_same_while_the_drone_moves_is_not_believed(sinks_m: float) -> None:
    stuck = [_reading(i, 1.5 - sinks_m * i, height_m=HEIGHT_M - sinks_m * i) for i in range(5)]
    assert _watch(stuck[:1] * 5) == 0.0
    assert _watch(stuck) is None


def test_roof_rises_above_the_road_that_was_seen_before_it_for_ten_seconds() -> None:
    road, roof = [_reading(i, 0.1) for i in range(6)], [_reading(6 + i, 1.6) for i in range(400)]
    assert _watch(road + roof[:5]) == pytest.approx(1.5)
    assert _watch(road + roof[:190]) == pytest.approx(1.5)
    assert _watch(road + roof[:210]) == pytest.approx(0.0)


@pytest.mark.parametrize("road_s", [12.0, 35.0])
def test_road_is_known_for_ten_seconds_after_it_was_seen_last_however_long_it_was_seen(road_s: float) -> None:
    count = round(road_s * 1e9 / PERIOD_NS)
    road = [_reading(i, 0.1 + 0.02 * math.sin(i)) for i in range(count)]
    roof = [_reading(count + i, 1.6) for i in range(220)]
    assert _watch(road + roof[:195]) == pytest.approx(1.5, abs=0.05)
    assert _watch(road + roof) == pytest.approx(0.0)


def test_road_that_climbs_does_not_rise() -> None:
    climbs_m = 0.06 * 8.0 * PERIOD_NS * 1e-9
    road = [_reading(i, climbs_m * i) for i in range(400)]
    assert _watch(road, climbs_m) == pytest.approx(0.0, abs=1e-9)
    assert _watch(road) == pytest.approx(climbs_m * 200)  # of a vehicle that stays below


def test_road_does_not_rise_as_the_vehicles_height_is_corrected() -> None:
    watch, rises_m = RangeWatch(), None
    for i in range(60):
        watch, rises_m = watch_ranges(watch, _reading(i, 0.02 * (i % 2)), 0.8 if i < 30 else 0.0)
    assert rises_m == pytest.approx(0.02)


@pytest.mark.parametrize("up_m", [-2.0, -0.2, 0.0, 0.2, 2.0])
def test_frame_that_steps_changes_nothing_of_what_rises(up_m: float) -> None:
    watch, rises_m = RangeWatch(), None
    for i in range(30):
        step_m, surface_m = up_m if i >= 20 else 0.0, 1.6 if i >= 10 else 0.1
        watch = moved_up(watch, up_m) if i == 20 else watch
        seen = _reading(i, surface_m + step_m, height_m=HEIGHT_M + step_m)
        watch, rises_m = watch_ranges(watch, seen, step_m)
        assert (rises_m is None) is (i < 4 or i in {10, 11})  # too few, or the roof's edge
    assert rises_m == pytest.approx(1.5)


def test_surface_seen_while_the_vehicle_is_not_placed_is_not_believed() -> None:
    watch = RangeWatch()
    for i in range(6):
        watch, rises_m = watch_ranges(watch, _reading(i, 1.5), None)
        assert rises_m is None


def test_range_finder_that_was_stuck_before_the_drones_place_was_known_is_not_believed() -> None:
    stuck = [_reading(i, 1.5 - 0.06 * i, height_m=HEIGHT_M - 0.06 * i) for i in range(6)]
    assert _watch([RangeReading(t_ns=0, distance_m=stuck[0].distance_m), *stuck[1:]]) is None


def test_drone_that_leans_far_sees_no_road() -> None:
    road, roof = [_reading(i, -0.6, roll_rad=0.5) for i in range(6)], [_reading(6 + i, 1.6) for i in range(6)]
    assert _watch(road) is None
    assert _watch(road + roof) == pytest.approx(0.0)


def test_single_low_reading_is_no_road() -> None:
    roof = [_reading(i, 1.6) for i in range(12)]
    assert _watch([*roof[:6], _reading(6, 0.1), *roof[7:]]) == pytest.approx(0.0)


def test_reading_without_a_known_place_is_not_believed() -> None:
    unknown = RangeReading(t_ns=9 * PERIOD_NS, distance_m=3.0)
    assert _watch([*(_reading(i, 1.5) for i in range(6)), unknown]) is None
