"""What the vehicle did before an instant, on roads that are written as formulas."""

import math
from collections.abc import Callable

import pytest

from link.messages import Vector3
from scenarios.scoring.circumstances import Circumstances, closest_ns, vehicle_circumstances
from scenarios.scoring.truth_log import TruthLog, truth_log
from tests.scenarios.scoring.synthetic import STILL, at_ns, body

HEADING_RAD = 0.7
AT_S = 7.3
ABOVE: Vector3 = (0.0, 0.0, 3.0)


def log_of(place: Callable[[float], Vector3], until_s: float = 9.0) -> TruthLog:
    times_s = [0.01 * step for step in range(round(until_s * 100.0))]
    return truth_log(
        [body(t_s, ABOVE, STILL) for t_s in times_s], [body(t_s, place(t_s), STILL) for t_s in times_s], []
    )


def shown(place: Callable[[float], Vector3], at_s: float = AT_S) -> Circumstances:
    return vehicle_circumstances(log_of(place), at_ns(at_s))


def along(way_m: float, up_m: float = 0.0) -> Vector3:
    return (way_m * math.cos(HEADING_RAD), way_m * math.sin(HEADING_RAD), up_m)


def eased(t_s: float, from_s: float, acceleration_m_s2: float) -> float:
    """The way of a body that stands until `from_s` and accelerates then."""
    return 0.5 * acceleration_m_s2 * max(0.0, t_s - from_s) ** 2


def on_circle(t_s: float, speed_m_s: float, radius_m: float, from_s: float) -> Vector3:
    """A straight to the East that becomes a left turn."""
    before_m = speed_m_s * min(t_s, from_s)
    angle_rad = speed_m_s * max(0.0, t_s - from_s) / radius_m
    return (before_m + radius_m * math.sin(angle_rad), radius_m * (1.0 - math.cos(angle_rad)), 0.0)


def test_steady_drive_shows_its_speed_and_nothing_else() -> None:
    found = shown(lambda t_s: along(6.3 * t_s))
    assert found["vehicle_speed_m_s"] == pytest.approx(6.3)
    assert found["vehicle_curvature_per_m"] == pytest.approx(0.0, abs=1e-9)
    for name in ("before_brake_m_s2", "before_speed_up_m_s2", "before_lateral_m_s2", "before_rise_m_s"):
        assert found[name] == pytest.approx(0.0, abs=1e-6)
    assert found["before_departs"] is False


def test_brake_within_three_seconds_is_its_deceleration() -> None:
    found = shown(lambda t_s: along(12.0 * t_s - eased(t_s, 5.0, 4.2)))
    assert found["before_brake_m_s2"] == pytest.approx(4.2, rel=1e-3)
    assert found["before_speed_up_m_s2"] == pytest.approx(0.0, abs=1e-6)
    assert found["vehicle_speed_m_s"] == pytest.approx(12.0 - 4.2 * 2.3, abs=0.01)


def test_brake_that_was_over_before_shows_nothing() -> None:
    brake_s = 0.5
    found = shown(lambda t_s: along(12.0 * t_s - eased(t_s, 2.0, 4.2) + eased(t_s, 2.0 + brake_s, 4.2)))
    assert found["before_brake_m_s2"] == pytest.approx(0.0, abs=1e-6)


def test_what_follows_the_instant_shows_nothing() -> None:
    found = shown(lambda t_s: along(8.0 * t_s - eased(t_s, AT_S + 0.2, 5.0)))
    assert found["before_brake_m_s2"] == pytest.approx(0.0, abs=1e-6)


def test_departure_is_standing_first_and_driving_now() -> None:
    def place(t_s: float) -> Vector3:
        return along(eased(t_s, 6.0, 1.9))

    assert shown(place)["before_departs"] is True
    assert shown(place)["before_speed_up_m_s2"] == pytest.approx(1.9, rel=1e-3)
    assert shown(place, 5.5)["before_departs"] is False


def test_circle_shows_its_curvature_and_no_turn_in() -> None:
    found = shown(lambda t_s: on_circle(t_s, 6.0, 24.0, from_s=0.0))
    assert found["vehicle_curvature_per_m"] == pytest.approx(1.0 / 24.0, rel=1e-3)
    assert found["before_lateral_m_s2"] == pytest.approx(0.0, abs=1e-3)
    assert found["before_brake_m_s2"] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("radius_m", [24.0, -24.0])
def test_turn_in_is_the_change_of_the_acceleration_to_the_side(radius_m: float) -> None:
    found = shown(lambda t_s: on_circle(t_s, 6.0, radius_m, from_s=6.0))
    assert found["before_lateral_m_s2"] == pytest.approx(36.0 / 24.0, rel=1e-3)
    assert found["vehicle_curvature_per_m"] == pytest.approx(1.0 / 24.0, rel=1e-3)


def test_climb_that_begins_is_the_change_of_vertical_speed() -> None:
    found = shown(lambda t_s: along(9.0 * t_s, 0.08 * 9.0 * max(0.0, t_s - 6.0)))
    assert found["before_rise_m_s"] == pytest.approx(0.72, rel=1e-3)


def test_standing_vehicle_has_no_curvature() -> None:
    found = shown(lambda _: along(4.0))
    assert found["vehicle_curvature_per_m"] is None
    assert (found["vehicle_speed_m_s"], found["before_lateral_m_s2"]) == (0.0, 0.0)


@pytest.mark.parametrize("at_s", [0.0, 0.05, 8.99])
def test_instants_at_the_ends_of_the_log_are_known_too(at_s: float) -> None:
    assert shown(lambda t_s: along(6.3 * t_s), at_s)["vehicle_speed_m_s"] == pytest.approx(6.3)


def test_closest_instant_is_the_nearest_to_the_pad_from_the_start_on() -> None:
    def place(t_s: float) -> Vector3:
        return (3.0 * abs(t_s - 2.0) if t_s < 4.0 else abs(t_s - 6.37), 0.0, 0.0)

    log = log_of(place)
    assert closest_ns(log, 1.5, at_ns(0.0)) == at_ns(2.0)
    assert closest_ns(log, 1.5, at_ns(4.5)) == at_ns(6.37)
    assert closest_ns(log, 1.5, at_ns(20.0)) == int(log.t_ns[-1])
