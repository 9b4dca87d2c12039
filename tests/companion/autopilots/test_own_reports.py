"""An autopilot whose velocity is off is seen through by its positions, and is asked for what it will report."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from companion.autopilots.own_reports import as_seen_with, carry, velocity_bias, without_bias
from companion.core.data import OwnState, Setpoint
from link.frames.rotations import quaternion_from_roll_pitch_yaw
from link.messages import Vector3

REPORT_NS = 20_000_000
WRONG_BY: Vector3 = (0.3, -0.45, 0.0)
Motion = Callable[[float], tuple[Vector3, Vector3]]


def straight(t_s: float) -> tuple[Vector3, Vector3]:
    return (8.0 * t_s, -3.0 * t_s, 2.0), (8.0, -3.0, 0.0)


def circle(t_s: float) -> tuple[Vector3, Vector3]:
    radius_m, rate = 12.5, 0.4
    x, y = radius_m * math.cos(rate * t_s), radius_m * math.sin(rate * t_s)
    return (x, y, 2.0), (-rate * y, rate * x, 0.0)


def after(
    motion: Motion, duration_s: float, wrong_by: Vector3, moved_m: Callable[[float], float] = lambda _: 0.0
) -> OwnState:
    """The last report of a drone whose stamps are rounded to milliseconds and whose place is moved now and then."""
    own: OwnState | None = None
    random = np.random.default_rng(1)
    for index in range(round(duration_s * 1e9 / REPORT_NS)):
        t_ns = 10**18 + index * REPORT_NS + int(random.integers(0, 4_000_000))
        (x, y, z), velocity = motion((t_ns - 10**18) * 1e-9)
        position = (x + moved_m((t_ns - 10**18) * 1e-9), y, z)
        reported = without_bias(velocity, tuple(-part for part in wrong_by))  # type: ignore[arg-type]  # (three parts)
        stamp_ns = t_ns - t_ns % 1_000_000
        bias = velocity_bias(own, stamp_ns, position, reported)
        own = OwnState(
            t_ns=stamp_ns,
            position_enu_m=position,
            velocity_enu_m_s=without_bias(reported, bias),
            velocity_bias_enu_m_s=bias,
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
        )
    assert own is not None
    return own


@pytest.mark.parametrize("motion", [straight, circle])
def test_velocity_that_positions_contradict_is_corrected(motion: Motion) -> None:
    own = after(motion, 4.0, WRONG_BY)
    # 4 s are 5.7 time constants; a stamp's rounding of 1 ms is 8 mm at 8 m/s, 12 mm/s through the low-pass.
    np.testing.assert_allclose(own.velocity_bias_enu_m_s, WRONG_BY, atol=0.02)
    rest = after(motion, 4.0, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(rest.velocity_bias_enu_m_s, (0.0, 0.0, 0.0), atol=0.015)


def test_vertical_velocity_is_left_alone() -> None:
    own = after(straight, 4.0, (0.0, 0.0, 0.4))
    assert own.velocity_bias_enu_m_s[2] == 0.0
    assert own.velocity_enu_m_s[2] == 0.4


def test_correction_of_the_place_is_no_velocity() -> None:
    own = after(straight, 4.0, (0.0, 0.0, 0.0), lambda t_s: 0.4 if t_s > 3.9 else 0.0)
    np.testing.assert_allclose(own.velocity_bias_enu_m_s, (0.0, 0.0, 0.0), atol=0.015)


def test_bias_has_a_bound() -> None:
    own = after(straight, 20.0, (2.0, -1.0, 0.0))
    assert math.hypot(*own.velocity_bias_enu_m_s) == pytest.approx(1.0)


@pytest.mark.parametrize("gap_ns", [-20_000_000, 0, 300_000_000])
def test_nothing_is_learnt_over_a_gap_or_a_repetition(gap_ns: int) -> None:
    before = after(straight, 2.0, WRONG_BY)
    position, _ = straight(2.5)
    assert velocity_bias(before, before.t_ns + gap_ns, position, (0.0, 0.0, 0.0)) == before.velocity_bias_enu_m_s


def test_setpoint_asks_for_the_velocity_that_the_autopilot_will_report() -> None:
    wanted = Setpoint(
        t_ns=1,
        position_enu_m=(1.0, 2.0, 3.0),
        velocity_enu_m_s=(5.0, -1.0, 0.2),
        acceleration_enu_m_s2=None,
        yaw_rad=0.3,
    )
    asked = as_seen_with(wanted, WRONG_BY)
    assert asked.velocity_enu_m_s == pytest.approx((5.3, -1.45, 0.2))
    assert without_bias(asked.velocity_enu_m_s or (0.0, 0.0, 0.0), WRONG_BY) == pytest.approx(wanted.velocity_enu_m_s)
    assert asked.position_enu_m == wanted.position_enu_m


def test_orientation_is_carried_from_when_it_was_so() -> None:
    rate_rad_s, attitude_age_s, ahead_s = -2.5, 0.012, 0.007
    own = OwnState(
        t_ns=10**18,
        position_enu_m=(1.0, 2.0, 3.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=quaternion_from_roll_pitch_yaw(0.0, 0.3, 0.0),
        angular_velocity_flu_rad_s=(0.0, rate_rad_s, 0.0),
        attitude_age_s=attitude_age_s,
    )
    carried = carry(own, own.t_ns + round(ahead_s * 1e9))
    pitch_rad = 0.3 + rate_rad_s * (attitude_age_s + ahead_s)
    assert carried.orientation_wxyz == pytest.approx(quaternion_from_roll_pitch_yaw(0.0, pitch_rad, 0.0), abs=1e-5)
