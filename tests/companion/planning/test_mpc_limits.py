import numpy as np
import pytest

from companion.config.planning import MpcConfig
from companion.core.data import Array, FlightLimits
from companion.planning.guidance import Leaning, ReferenceState
from companion.planning.mpc import Mpc
from link.records import replace
from tests.companion.planning.cases import LIMITS, Motion, circle, fly, norm, state_at, state_on, straight

MPC = Mpc(MpcConfig())
NORM_TOLERANCE = 1.02
"""A speed norm may be broken by 2 % while the axes turn and the jerk limit is low."""


def random_limits(rng: np.random.Generator) -> FlightLimits:
    return FlightLimits(
        speed_max_m_s=rng.uniform(8.0, 25.0),
        climb_max_m_s=rng.uniform(1.5, 4.0),
        descent_max_m_s=rng.uniform(1.0, 3.0),
        acceleration_max_m_s2=rng.uniform(3.0, 7.0),
        vertical_acceleration_max_m_s2=rng.uniform(2.0, 4.0),
        jerk_max_m_s3=rng.uniform(10.0, 40.0),
        vertical_jerk_max_m_s3=rng.uniform(4.0, 10.0),
    )


def rises(values: Array) -> bool:
    """Whether a sequence rises anywhere after its maximum."""
    return bool((np.diff(values[values.argmax() :]) > 1e-6).any())


@pytest.mark.parametrize("seed", range(12))
def test_random_chases_keep_all_limits_at_every_tick(seed: int) -> None:
    rng = np.random.default_rng(seed)
    limits = random_limits(rng)
    v_max = limits.speed_max_m_s
    start, velocity = rng.uniform(-60.0, 60.0, 2), rng.uniform(-0.6, 0.6, 2) * v_max
    motion = straight((*start.tolist(), 3.0), (*velocity.tolist(), 0.0))
    if seed % 2:
        motion = circle(rng.uniform(15.0, 30.0), rng.uniform(3.0, min(8.0, 0.8 * v_max)))
    flight = fly(MPC, motion, state_at((0.0, 0.0, 5.0)), 8.0, limits)
    assert norm(flight.velocity).max() <= NORM_TOLERANCE * v_max
    assert norm(flight.acceleration).max() <= 1.001 * limits.acceleration_max_m_s2
    assert norm(flight.jerk).max() <= 1.0001 * limits.jerk_max_m_s3
    assert np.abs(flight.jerk[:, 2]).max() <= 1.0001 * limits.vertical_jerk_max_m_s3
    assert flight.velocity[:, 2].max() <= 1.001 * limits.climb_max_m_s  # between the nodes
    assert -flight.velocity[:, 2].min() <= 1.001 * limits.descent_max_m_s
    assert np.abs(flight.acceleration[:, 2]).max() <= limits.vertical_acceleration_max_m_s2 + 1e-4


@pytest.mark.parametrize(
    ("velocity", "acceleration"),
    [
        ((28.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        ((20.0, 19.0, -4.0), (0.0, 0.0, 0.0)),
        ((19.0, 0.0, 5.0), (8.0, 0.0, 0.0)),
        ((15.0, -15.0, 0.0), (5.0, -5.0, -4.0)),
    ],
)
def test_a_state_outside_the_limits_comes_back_without_turning_round(
    velocity: tuple[float, float, float], acceleration: tuple[float, float, float]
) -> None:
    state = state_at((0.0, 0.0, 5.0), velocity, acceleration)
    flight = fly(MPC, straight((0.0, 0.0, 2.0), (10.0, 0.0, 0.0)), state, 6.0)
    assert not rises(np.maximum(norm(flight.velocity) - LIMITS.speed_max_m_s, 0.0))
    assert not rises(np.maximum(norm(flight.acceleration) - LIMITS.acceleration_max_m_s2, 0.0))
    assert not rises(np.maximum(flight.velocity[:, 2] - LIMITS.climb_max_m_s, 0.0))
    assert not rises(np.maximum(-flight.velocity[:, 2] - LIMITS.descent_max_m_s, 0.0))
    assert norm(flight.velocity)[-1] <= LIMITS.speed_max_m_s + 1e-3


def test_a_target_below_the_floor_is_followed_on_the_floor() -> None:
    flight = fly(MPC, straight((0.0, 0.0, -3.0), (5.0, 0.0, 0.0)), state_at((0.0, 0.0, 5.0)), 8.0, floor_m=1.0)
    assert flight.position[:, 2].min() > 1.0 - 1e-4
    assert flight.position[-1, 2] == pytest.approx(1.0, abs=1e-3)


def test_a_start_below_the_floor_climbs_to_it() -> None:
    flight = fly(MPC, straight((0.0, 0.0, -3.0), (5.0, 0.0, 0.0)), state_at((0.0, 0.0, -2.0)), 6.0, floor_m=1.0)
    assert not rises(np.maximum(1.0 - flight.position[:, 2], 0.0))
    assert flight.position[-1, 2] == pytest.approx(1.0, abs=1e-3)


def test_a_target_faster_than_the_limit_is_chased_at_the_limit() -> None:
    flight = fly(MPC, straight((5.0, 0.0, 2.0), (23.0, 0.0, 0.0)), state_at((0.0, 0.0, 5.0)), 10.0)
    assert norm(flight.velocity)[-1] == pytest.approx(LIMITS.speed_max_m_s, rel=1e-3)


def test_a_kept_plan_reports_no_excess() -> None:
    flight = fly(MPC, straight((20.0, 5.0, 2.0), (3.0, 4.0, 0.0)), state_at((0.0, 0.0, 5.0)), 4.0)
    assert max(result.limit_excess for result in flight.results) < 1e-9


def test_a_start_that_must_break_the_floor_reports_the_excess() -> None:
    state = state_at((0.0, 0.0, 2.0), (0.0, 0.0, -4.0))
    flight = fly(MPC, straight((0.0, 0.0, -3.0), (0.0, 0.0, 0.0)), state, 1.0, floor_m=1.0)
    assert max(result.limit_excess for result in flight.results) > 0.0


def bend(speed_m_s: float, radius_m: float, angle_rad: float, *, begins_s: float) -> Motion:
    """A straight, a bend to the left, and a straight."""
    rate, first = speed_m_s / radius_m, np.array([0.0, 0.0, 2.0])

    def at(t_s: Array) -> tuple[Array, Array, Array]:
        turned = np.clip(rate * (t_s - begins_s), 0.0, angle_rad)
        before, after = np.minimum(t_s, begins_s), np.maximum(t_s - begins_s - angle_rad / rate, 0.0)
        c, s, o = np.cos(turned), np.sin(turned), np.zeros_like(t_s)
        place = np.stack((speed_m_s * before + radius_m * s, radius_m * (1.0 - c), o), axis=1)
        ahead, turns = np.stack((c, s, o), axis=1), (turned > 0.0) & (turned < angle_rad)
        across = speed_m_s * rate * turns[:, None] * np.stack((-s, c, o), axis=1)
        return first + place + speed_m_s * after[:, None] * ahead, speed_m_s * ahead, across

    return at


@pytest.mark.parametrize(("speed_m_s", "radius_m"), [(10.2, 17.0), (9.4, 15.0), (10.5, 21.0)])
def test_a_bend_that_needs_more_than_the_limit_is_cut_by_no_more_than_its_excess(
    speed_m_s: float, radius_m: float
) -> None:
    """What lacks acceleration by d over the time T of the bend sags by d T^2 / 8 at most, from end to end."""
    limits = replace(LIMITS, acceleration_max_m_s2=5.0, jerk_max_m_s3=60.0)
    motion, angle_rad = bend(speed_m_s, radius_m, 0.5 * np.pi, begins_s=3.5), 0.5 * np.pi
    flight = fly(MPC, motion, state_on(motion), 10.0, limits)
    excess, lasts_s = speed_m_s**2 / radius_m - 5.0, angle_rad * radius_m / speed_m_s
    assert excess > 0.2
    assert norm(flight.error).max() < excess * lasts_s**2 / 8.0 + 0.1
    assert norm(flight.error)[-1] < 0.05


def test_a_circle_is_flown_on_which_drag_and_the_turn_together_take_nearly_all_of_the_tilt() -> None:
    """Along the velocity drag leaves next to nothing of the tilt, across it three quarters, which the turn needs."""
    most_m_s2, drag_hz, motion = 4.8, 0.5, circle(20.0, 7.2)

    def leaning(state: ReferenceState) -> Leaning:
        held = drag_hz * state.velocity_enu_m_s[:2]
        return Leaning(path_max_m_s2=LIMITS.acceleration_max_m_s2, most_m_s2=most_m_s2, holds_enu_m_s2=held)

    flight = fly(MPC, motion, state_at((17.0, -3.0, 3.0), (0.0, 5.0, 0.0)), 25.0, leaning=leaning)
    thrust = norm(flight.acceleration + drag_hz * flight.velocity)
    assert thrust.max() <= 1.01 * most_m_s2  # the drag within a block is that at its beginning
    assert norm(flight.error)[-1] < 0.05
    assert thrust[-1] > 0.92 * most_m_s2
