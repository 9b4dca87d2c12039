"""When a vehicle passes a place, on truth of the tests' own making."""

from collections.abc import Callable

import numpy as np
import pytest

from link.messages import BodyTruth, RotorTruth
from scenarios.scoring.truth_log import passing_ns, truth_log

PLACE = np.array([10.0, 2.0])


def passed_s(vehicle_x_m: Callable[[float], float], around_s: float) -> float | None:
    """Return when a vehicle on the x axis passes the place."""
    times_s = np.arange(0.0, 30.0, 0.01).tolist()
    drone = [_body(t_s, (0.0, 0.0, 5.0)) for t_s in times_s]
    vehicle = [_body(t_s, (vehicle_x_m(t_s), 0.0, 0.0)) for t_s in times_s]
    found = passing_ns(truth_log(drone, vehicle, list[RotorTruth]()), PLACE, round(around_s * 1e9))
    return None if found is None else found * 1e-9


def _body(t_s: float, position: tuple[float, float, float]) -> BodyTruth:
    still = (0.0, 0.0, 0.0)
    return BodyTruth(
        t_ns=round(t_s * 1e9),
        position_enu_m=position,
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=still,
        angular_velocity_flu_rad_s=still,
    )


@pytest.mark.parametrize("around_s", [2.0, 5.0, 7.5])
def test_passing_is_the_nearest_point_whether_it_is_still_to_come_or_over(around_s: float) -> None:
    assert passed_s(lambda t_s: 2.0 * t_s, around_s) == pytest.approx(5.0)


@pytest.mark.parametrize(("around_s", "expected_s"), [(4.0, 5.0), (14.0, 15.0), (16.0, 15.0)])
def test_passing_is_that_of_the_same_lap(around_s: float, expected_s: float) -> None:
    assert passed_s(lambda t_s: 2.0 * (t_s % 10.0), around_s) == pytest.approx(expected_s)


def test_vehicle_that_stands_is_passed_at_once() -> None:
    assert passed_s(lambda t_s: min(2.0 * t_s, 9.0), 12.0) == pytest.approx(12.0)


def test_vehicle_that_stops_before_the_place_is_nearest_when_it_stops() -> None:
    assert passed_s(lambda t_s: min(2.0 * t_s, 9.0), 3.0) == pytest.approx(4.5)


def test_vehicle_that_is_still_coming_has_not_passed() -> None:
    assert passed_s(lambda t_s: 0.2 * t_s, 12.0) is None
