import numpy as np
import pytest

from companion.planning import envelope, intercept
from companion.planning.intercept import approach_push, fastest_way, way_at


@pytest.mark.parametrize(
    ("error", "rate"), [(-30.0, 0.0), (12.0, 7.0), (-2.0, 9.0), (0.0, -3.0), (5.0, -1.0), (-40.0, 14.0)]
)
def test_the_way_ends_at_rest_at_the_target(error: float, rate: float) -> None:
    way = fastest_way(error, rate, 4.0, -6.0, 9.0)
    _, position, velocity, acceleration = way_at(error, rate, way, sum(way[1:]) + 0.1)
    assert (position, velocity, acceleration) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("rate", [-5.0, 0.0, 3.0])
def test_the_way_never_leaves_its_bounds(rate: float) -> None:
    way = fastest_way(-30.0, rate, 4.0, -6.0, 9.0)
    path = np.array([way_at(-30.0, rate, way, t) for t in np.linspace(0.0, sum(way[1:]), 500)])
    assert np.abs(path[:, 3]).max() <= 4.0 + 1e-9
    assert path[:, 2].max() <= 9.0 + 1e-9


def test_a_way_from_rest_takes_the_textbook_time() -> None:
    """2 sqrt(d / a) for a double integrator from rest to rest: Bryson and Ho 1975, section 3.9."""
    assert sum(fastest_way(-7.0, 0.0, 3.0, -50.0, 50.0)[1:]) == pytest.approx(2.0 * np.sqrt(7.0 / 3.0))


def test_a_way_with_a_cruise_takes_the_trapezoid_time() -> None:
    """d / v + v / a for a trapezoidal profile."""
    assert sum(fastest_way(50.0, 0.0, 4.0, -5.0, 9.0)[1:]) == pytest.approx(50.0 / 5.0 + 5.0 / 4.0)


def test_position_and_its_integral_follow_from_the_acceleration() -> None:
    way = fastest_way(-12.0, -3.0, 4.0, -6.0, 5.0)
    times = np.linspace(0.0, sum(way[1:]) + 0.3, 20001)
    path = np.array([way_at(-12.0, -3.0, way, t) for t in times])
    h = times[1]
    velocity = -3.0 + np.append(0.0, np.cumsum(0.5 * (path[1:, 3] + path[:-1, 3])) * h)
    position = -12.0 + np.append(0.0, np.cumsum(0.5 * (path[1:, 2] + path[:-1, 2])) * h)
    integral = np.append(0.0, np.cumsum(0.5 * (path[1:, 1] + path[:-1, 1])) * h)
    np.testing.assert_allclose(path[:, 2], velocity, atol=5e-3)
    np.testing.assert_allclose(path[:, 1], position, atol=1e-6)
    np.testing.assert_allclose(path[:, 0], integral, atol=1e-6)


def test_near_the_target_the_push_is_proportional_to_the_error() -> None:
    assert approach_push(0.02, 0.01, 4.0, 5.0, 1.4) == pytest.approx(2.0 * approach_push(0.01, 0.005, 4.0, 5.0, 1.4))


def test_closing_in_too_fast_takes_the_push_that_stops_at_the_target() -> None:
    assert approach_push(-10.0, 9.0, 4.0, 5.0, 1.4) == pytest.approx(9.0**2 / 20.0)


def test_the_compiled_approach_equals_its_python() -> None:
    rng = np.random.default_rng(8)
    nodes = np.linspace(0.0, 3.0, 12)
    for _ in range(20):
        x, target = 10.0 * rng.normal(size=(2, 3)), 3.0 * rng.normal(size=(3, 3, 12))
        limits, floor = tuple(rng.uniform(1.0, 20.0, 5).tolist()), rng.normal(size=12)
        compiled = intercept.approach(x, nodes, target, floor, limits, 0.9, 1.4)
        plain = intercept.approach.py_func(x, nodes, target, floor, limits, 0.9, 1.4)
        np.testing.assert_allclose(compiled, plain)


def test_the_compiled_envelopes_equal_their_python() -> None:
    rng = np.random.default_rng(9)
    times = np.linspace(0.1, 3.0, 9)
    for _ in range(20):
        bound, (v, a) = rng.uniform(1.0, 5.0, 9), 6.0 * rng.normal(size=2)
        x, push, jerk = 3.0 * rng.normal(size=3), *rng.uniform(1.0, 20.0, 2)
        for kernel, arguments in (
            (envelope.velocity_left, (v, a, push, jerk, 0.7)),
            (envelope.braked, (3.0 * rng.normal(size=(3, 3)), push, jerk, times)),
            (envelope.reachable_floor, (bound, x, push, 2.0, jerk, 0.8, times)),
        ):
            np.testing.assert_allclose(kernel(*arguments), kernel.py_func(*arguments), atol=1e-12)
