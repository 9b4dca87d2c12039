"""The virtual model's tracking: lag is learnt, transients are not, the correction stays bounded."""

import math

import numpy as np
import pytest

from companion.core.data import Array, OwnState
from companion.landing.virtual_model import (
    Tracking,
    add_to_past,
    extrapolate,
    free_place,
    limit_sink,
    press_down,
    setpoint_at,
    state_in_plan,
    update_tracking,
)
from companion.planning.guidance import ReferenceState, Trajectory

STEP_NS = 20_000_000


def _state(t_s: float, speed_m_s: float) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array([speed_m_s * t_s, 0.3, 4.0]),
        velocity_enu_m_s=np.array([speed_m_s, 0.0, 0.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )


def _own(t_ns: int, x: float) -> OwnState:
    return OwnState(
        t_ns=t_ns,
        position_enu_m=(x, 0.3, 4.0),
        velocity_enu_m_s=(5.0, 0.0, 0.0),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def _fly_with_lag(lag_m: float, steps: int, *, learn: bool = True) -> Tracking:
    """The drone stays `lag_m` behind where its setpoint is, correction included, and reports 40 ms late."""
    tracking = Tracking()
    for i in range(1, steps):
        t_ns = i * STEP_NS
        tracking = add_to_past(tracking, t_ns, _state(t_ns * 1e-9, 5.0))
        reported_ns = t_ns - 2 * STEP_NS - 7_000_000
        if reported_ns > 0:
            x = 5.0 * reported_ns * 1e-9 - lag_m + float(tracking.correction_enu_m[0])
            tracking = update_tracking(tracking, reported_ns, (x, 0.3, 4.0), learns=learn)
    return tracking


def test_lasting_lag_is_learnt() -> None:
    tracking = _fly_with_lag(0.4, 1000)
    np.testing.assert_allclose(tracking.correction_enu_m, [0.4, 0.0, 0.0], atol=0.01)
    assert tracking.error_m < 0.01


def test_nothing_is_learnt_unless_asked() -> None:
    tracking = _fly_with_lag(0.4, 200, learn=False)
    assert not np.any(tracking.correction_enu_m)
    np.testing.assert_allclose(tracking.error_m, 0.4, atol=1e-6)
    np.testing.assert_allclose(tracking.behind_enu_m, [0.4, 0.0, 0.0], atol=1e-6)


def test_transient_is_not_learnt() -> None:
    assert not np.any(_fly_with_lag(3.0, 200).correction_enu_m)


def test_correction_stays_bounded() -> None:
    tracking = Tracking()
    for i in range(1, 2000):
        tracking = add_to_past(tracking, i * STEP_NS, _state(i * STEP_NS * 1e-9, 5.0))
        x = 5.0 * (i - 1) * STEP_NS * 1e-9 - 0.9
        tracking = update_tracking(tracking, (i - 1) * STEP_NS, (x, 0.3, 4.0), learns=True)
    assert np.linalg.norm(tracking.correction_enu_m) <= 1.5 + 1e-9


def test_carried_is_the_closed_form_of_constant_acceleration() -> None:
    reference = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([4.0, 0.0, -1.0]),
        acceleration_enu_m_s2=np.array([2.0, 1.0, 0.0]),
    )
    later = extrapolate(reference, 0.05)
    np.testing.assert_allclose(later.position_enu_m, [1.0 + 0.2 + 0.0025, 2.0 + 0.00125, 3.0 - 0.05])
    np.testing.assert_allclose(later.velocity_enu_m_s, [4.1, 0.05, -1.0])
    np.testing.assert_allclose(extrapolate(later, -0.05).position_enu_m, reference.position_enu_m, atol=1e-12)


@pytest.mark.parametrize(("up_m_s2", "sent_m_s2"), [(-2.9, 0.0), (0.7, 0.7)])
def test_model_that_is_carried_on_does_not_fall_faster(up_m_s2: float, sent_m_s2: float) -> None:
    reference = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([4.0, 0.0, -0.7]),
        acceleration_enu_m_s2=np.array([2.0, 1.0, up_m_s2]),
    )
    sent = limit_sink(reference, 0.0, 3.0)
    np.testing.assert_array_equal(sent.acceleration_enu_m_s2, [2.0, 1.0, sent_m_s2])
    np.testing.assert_array_equal(sent.velocity_enu_m_s, reference.velocity_enu_m_s)


@pytest.mark.parametrize(("lowest_m", "sent_m_s"), [(-2.0, -1.5), (0.6, -0.8), (3.5, 0.0), (-math.inf, -1.5)])
def test_model_that_is_carried_on_ends_above_the_lowest_height(lowest_m: float, sent_m_s: float) -> None:
    reference = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([4.0, 0.0, -1.5]),
        acceleration_enu_m_s2=np.array([2.0, 1.0, 0.0]),
    )
    sent = limit_sink(reference, lowest_m, 3.0)
    np.testing.assert_allclose(sent.velocity_enu_m_s, [4.0, 0.0, sent_m_s])
    np.testing.assert_array_equal(sent.position_enu_m, reference.position_enu_m)
    np.testing.assert_array_equal(limit_sink(reference, lowest_m, 0.0).velocity_enu_m_s, reference.velocity_enu_m_s)


def test_setpoint_is_the_model_with_the_correction() -> None:
    setpoint = setpoint_at(_state(2.0, 5.0), np.array([0.1, 0.0, 0.0]), 50_000_000, 0.3, position_only=False)
    np.testing.assert_allclose(setpoint.position_enu_m, [10.1, 0.3, 4.0])
    assert setpoint.velocity_enu_m_s == (5.0, 0.0, 0.0)
    assert setpoint_at(_state(2.0, 5.0), np.zeros(3), 0, 0.3, position_only=True).velocity_enu_m_s is None


def _cubic(t_s: Array) -> Trajectory:
    """A motion of constant jerk, at `t_s` (n,)."""
    p, v, a, j = (np.array(one) for one in ([1.0, 2.0, 3.0], [4.0, -1.0, 0.3], [0.5, 2.0, -0.7], [3.0, -5.0, 1.0]))
    t = t_s[:, None]
    return Trajectory(
        offset_s=t_s,
        position_enu_m=p + v * t + a * t**2 / 2.0 + j * t**3 / 6.0,
        velocity_enu_m_s=v + a * t + j * t**2 / 2.0,
        acceleration_enu_m_s2=a + j * t,
    )


@pytest.mark.parametrize("offset_s", [0.0, 0.013, 0.11, 0.3, 0.37])
def test_model_between_two_instants_of_its_plan_is_the_motion_of_their_jerk(offset_s: float) -> None:
    model, truth = state_in_plan(_cubic(np.array([0.0, 0.02, 0.13, 0.3])), offset_s), _cubic(np.array([offset_s]))
    np.testing.assert_allclose(model.position_enu_m, truth.position_enu_m[0])
    np.testing.assert_allclose(model.velocity_enu_m_s, truth.velocity_enu_m_s[0])
    np.testing.assert_allclose(model.acceleration_enu_m_s2, truth.acceleration_enu_m_s2[0])


def test_model_that_is_pressed_falls_as_if_nothing_held_it() -> None:
    level = _state(2.0, 5.0)
    pressed = press_down(level, 9.0, 0.13)
    np.testing.assert_allclose(level.position_enu_m - pressed.position_enu_m, [0.0, 0.0, 0.5 * 9.0 * 0.13**2])
    np.testing.assert_allclose(pressed.velocity_enu_m_s, [5.0, 0.0, -9.0 * 0.13])
    np.testing.assert_allclose(pressed.acceleration_enu_m_s2, [0.0, 0.0, -9.0])


@pytest.mark.parametrize(
    ("behind_m", "faster_m_s"),
    [((0.3, -0.2, 0.5), (0.45, -0.3)), ((3.0, -4.0, 0.0), (0.9, -1.2))],
    ids=["in proportion", "bounded"],
)
def test_free_place_is_made_up_for_by_the_horizontal_velocity(
    behind_m: tuple[float, float, float], faster_m_s: tuple[float, float]
) -> None:
    wanted = setpoint_at(_state(2.0, 5.0), np.zeros(3), 0, 0.3, position_only=False)
    free = free_place(wanted, np.array(behind_m), 1.5)
    assert free.is_place_free
    assert free.velocity_enu_m_s == pytest.approx((5.0 + faster_m_s[0], faster_m_s[1], 0.0))
    assert free.position_enu_m == wanted.position_enu_m
    held = setpoint_at(_state(2.0, 5.0), np.zeros(3), 0, 0.3, position_only=True)
    assert free_place(held, np.array(behind_m), 1.5) is held
