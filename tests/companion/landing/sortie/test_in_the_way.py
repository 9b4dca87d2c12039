"""A low station in the vehicle's own way is kept high; beside it, or far enough behind, it stays low."""

import math

import pytest

from companion.landing.sortie.in_the_way import kept_station_m, nears_m
from link.messages import Station, StationFrame, Vector3
from link.records import replace
from tests.companion.facts import CONFIG, pad_at

SPEED_M_S, HEADING_RAD = 10.0, 0.4
PAD = replace(
    pad_at((SPEED_M_S * math.cos(HEADING_RAD), SPEED_M_S * math.sin(HEADING_RAD), 0.0)),
    yaw_rad=HEADING_RAD,
    height_m=3.5,
)
LIMITS = replace(CONFIG.limits.flight_limits(), acceleration_max_m_s2=5.0)
LOW_M, HIGH_M = -1.0, CONFIG.descent.alignment.height_m
RADIUS_M = CONFIG.sortie.vehicle_radius_m + CONFIG.sortie.keep_out_margin_m
WIDE_M = CONFIG.sortie.vehicle_radius_m
# 10 m/s: (1/5 - 1/(0.8 x 9.81)) x 50 = 3.629 m of braking, and 10 m of a second without data
ROOM_M = RADIUS_M + 3.629 + 10.0


def kept_up_m(offset_m: Vector3, frame: StationFrame = StationFrame.VEHICLE) -> float:
    kept = kept_station_m(Station(offset_m=offset_m, frame=frame), 0.0, PAD, LIMITS, CONFIG)
    assert kept[:2].tolist() == pytest.approx(offset_m[:2])
    return float(kept[2])


@pytest.mark.parametrize(
    ("ahead_m", "left_m", "is_in_the_way"),
    [
        (6.3, 0.3, True),
        (60.0, WIDE_M - 0.4, True),
        (60.0, WIDE_M + 0.4, False),
        (0.3, RADIUS_M + 0.3, False),
        (-6.3, 0.3, True),
        (0.2 - ROOM_M, 0.3, True),
        (-0.2 - ROOM_M, 0.3, False),
        (-6.3, -RADIUS_M - 0.3, False),
    ],
)
def test_low_station_is_kept_over_the_roof_where_an_outage_would_end_under_the_vehicle(
    ahead_m: float, left_m: float, *, is_in_the_way: bool
) -> None:
    assert kept_up_m((ahead_m, left_m, LOW_M)) == pytest.approx(HIGH_M if is_in_the_way else LOW_M, abs=0.2)


def test_vehicles_way_is_the_same_for_a_station_that_is_laid_from_north() -> None:
    north_m, east_m = 9.0 * math.sin(HEADING_RAD), 9.0 * math.cos(HEADING_RAD)
    assert kept_up_m((north_m, -east_m, LOW_M), StationFrame.NORTH) == pytest.approx(HIGH_M, abs=0.2)
    assert kept_up_m((-east_m, -north_m, LOW_M), StationFrame.NORTH) == LOW_M


def test_high_station_in_the_way_stays() -> None:
    assert kept_up_m((9.0, 0.3, 4.0)) == 4.0


def test_drone_that_brakes_as_hard_as_the_vehicle_comes_nearer_by_old_data_alone() -> None:
    assert nears_m(SPEED_M_S, LIMITS, 0.4) == pytest.approx(3.629 + 4.0, abs=0.001)
    assert nears_m(SPEED_M_S, replace(LIMITS, acceleration_max_m_s2=9.0), 0.4) == pytest.approx(4.0)
