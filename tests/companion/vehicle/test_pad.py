"""The pad from the antenna: the lever arm turns with the heading, and its motion is that of a rigid body."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from companion.core.data import Array, Forecast
from companion.vehicle.lever import tilted_lever, turned_lever, yaw_rate
from companion.vehicle.pad import HEADING_UNKNOWN, NOT_DESCRIBED, TURNS_ON_SPOT, pad_path
from companion.vehicle.shake import tilted_deck
from link.frames.rotations import quaternion_from_roll_pitch_yaw, quaternion_from_yaw, rotate
from link.messages import PadGeometry, Vector3
from link.records import replace
from tests.companion.world import START_NS

OFFSETS_S = np.arange(0.0, 2.01, 0.05)


def _forecast(yaw_rad: Array | None) -> Forecast:
    n = len(OFFSETS_S)
    velocity = np.tile([3.0, -1.0, 0.1], (n, 1))
    return Forecast(
        t_ns=START_NS,
        offset_s=OFFSETS_S,
        position_enu_m=np.array([7.0, 2.0, 0.8]) + velocity * OFFSETS_S[:, None],
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=np.zeros((n, 3)),
        yaw_rad=yaw_rad,
        position_std_m=np.full((n, 3), 0.1),
    )


def _pad(lever_flu_m: Vector3) -> PadGeometry:
    return PadGeometry(size_m=(1.5, 1.2), height_m=1.5, antenna_to_pad_m=lever_flu_m)


metres = st.floats(-3.0, 3.0)


@given(lever=st.tuples(metres, metres, metres), yaw_rad=st.floats(-math.pi, math.pi), rate_rad_s=st.floats(-0.8, 0.8))
@settings(max_examples=60, deadline=None)
def test_lever_arm_rotates_with_the_heading(lever: Vector3, yaw_rad: float, rate_rad_s: float) -> None:
    yaw = (yaw_rad + rate_rad_s * OFFSETS_S + math.pi) % (2.0 * math.pi) - math.pi
    forecast = _forecast(yaw)
    path = pad_path(forecast, _pad(lever))
    expected = [rotate(quaternion_from_yaw(angle), lever) for angle in yaw.tolist()]
    np.testing.assert_allclose(path.position_enu_m - forecast.position_enu_m, expected, atol=1e-9)
    assert path.unplaced is None


@given(lever=st.tuples(metres, metres, metres), yaw_rad=st.floats(-math.pi, math.pi), rate_rad_s=st.floats(-0.8, 0.8))
@settings(max_examples=60, deadline=None)
def test_velocity_is_the_derivative_of_the_position(lever: Vector3, yaw_rad: float, rate_rad_s: float) -> None:
    path = pad_path(_forecast(yaw_rad + rate_rad_s * OFFSETS_S), _pad(lever))
    moved = np.gradient(path.position_enu_m, OFFSETS_S, axis=0, edge_order=2)
    np.testing.assert_allclose(path.velocity_enu_m_s[1:-1], moved[1:-1], atol=2e-3)


@given(grade=st.lists(st.floats(-0.2, 0.2), min_size=5, max_size=5))
def test_lever_arm_rises_with_the_grade_as_numpy_derives_it(grade: list[float]) -> None:
    offset_s, pitch = np.array([0.0, 0.1, 0.35, 0.4, 1.0]), np.array(grade)
    arm, swing = turned_lever(np.zeros(5), pitch, offset_s, 1.2, 0.3)
    np.testing.assert_array_equal(arm[:, 2], 1.2 * pitch)
    np.testing.assert_array_equal(swing[:, 2], 1.2 * np.gradient(pitch, offset_s))


@given(yaw=st.lists(st.floats(-9.0, 9.0), min_size=5, max_size=5))
def test_heading_turns_the_short_way_round_as_numpy_unwraps_and_derives_it(yaw: list[float]) -> None:
    offset_s, yaw_rad = np.array([0.0, 0.1, 0.35, 0.4, 1.0]), np.array(yaw)
    expected = np.gradient(np.unwrap(yaw_rad), offset_s)
    half_turns = np.abs(np.abs(np.diff(yaw_rad)) % (2.0 * math.pi) - math.pi) < 1e-9
    assume(not half_turns.any())  # both ways round are as short
    assert yaw_rate(yaw_rad, offset_s) == pytest.approx(expected, abs=1e-9)


def test_tilt_moves_a_lever_arm_to_the_second_order() -> None:
    yaw_rad, lever = np.array([0.3, -2.1]), np.array([-13.0, -3.0, -6.5])
    tilt = np.array([[0.05, -0.02, 0.04, 0.05], [-0.03, 0.06, 0.05, -0.02]])
    moved, rate = tilted_lever(yaw_rad, tilt, *lever)
    for i, yaw in enumerate(yaw_rad):
        level = np.array(rotate(quaternion_from_yaw(yaw), tuple(lever)))
        now, later = (
            np.array(rotate(quaternion_from_roll_pitch_yaw(roll, pitch, yaw), tuple(lever)))
            for roll, pitch in (tilt[i, 0::2], tilt[i, 0::2] + 1e-6 * tilt[i, 1::2])
        )
        third = 15.0 * 0.07**3  # what is left out, of the arm's length
        assert moved[i] == pytest.approx(now - level, abs=third)
        assert rate[i] == pytest.approx((later - now) / 1e-6, abs=third)


def test_compiled_kernels_equal_their_python() -> None:
    rng = np.random.default_rng(4)
    offset_s, yaw_rad, tilt = (
        np.array([0.0, 0.2, 0.3, 0.7, 0.9]),
        rng.uniform(-4.0, 4.0, 5),
        rng.standard_normal((5, 4)),
    )
    roll, pitch = (6.0, 0.2, 0.4), (4.0, 0.1, 0.7)
    for kernel, arguments in (
        (turned_lever, (yaw_rad, tilt[:, 0].copy(), offset_s, 0.7, -0.4)),
        (tilted_lever, (yaw_rad, tilt, 0.7, -0.4, 1.6)),
        (yaw_rate, (yaw_rad, offset_s)),
        (tilted_deck, (yaw_rad, tilt, roll, pitch)),
    ):
        for mine, python in zip(kernel(*arguments), kernel.py_func(*arguments), strict=True):
            np.testing.assert_allclose(mine, python, rtol=1e-12, atol=1e-12)


def test_unknown_heading_leaves_a_horizontal_lever_arm_out_and_says_so() -> None:
    forecast = _forecast(None)
    path = pad_path(forecast, _pad((0.4, 0.0, 0.7)))
    assert path.unplaced == HEADING_UNKNOWN
    np.testing.assert_allclose(path.position_enu_m - forecast.position_enu_m, np.tile([0.0, 0.0, 0.7], (41, 1)))


def test_pad_beside_the_antenna_of_a_vehicle_that_turns_on_the_spot_is_told_as_that() -> None:
    forecast = replace(_forecast(None), turns_on_spot=True)
    assert pad_path(forecast, _pad((0.4, 0.0, 0.7))).unplaced == TURNS_ON_SPOT
    assert pad_path(forecast, _pad((0.0, 0.0, 0.7))).unplaced is None


def test_vertical_lever_arm_needs_no_heading() -> None:
    assert pad_path(_forecast(None), _pad((0.0, 0.0, 0.7))).unplaced is None


def test_pad_that_was_not_described_is_followed_at_the_antenna_and_not_placed() -> None:
    forecast = _forecast(np.zeros_like(OFFSETS_S))
    path = pad_path(forecast, None)
    assert path.unplaced == NOT_DESCRIBED
    np.testing.assert_array_equal(path.position_enu_m, forecast.position_enu_m)


def test_forecast_is_not_written_to() -> None:
    forecast = _forecast(0.3 * OFFSETS_S)
    before = forecast.position_enu_m.copy()
    pad_path(forecast, _pad((1.0, -0.5, 0.2)))
    np.testing.assert_array_equal(forecast.position_enu_m, before)


def test_vague_heading_does_not_place_a_pad_on_a_long_lever_arm_that_nobody_has_seen() -> None:
    unseen = replace(_forecast(np.zeros_like(OFFSETS_S)), yaw_std_rad=0.15, position_std_m=np.full((41, 3), 1.0))
    seen = replace(unseen, position_std_m=np.full((41, 3), 0.05))
    assert pad_path(unseen, _pad((2.0, 0.0, 0.7))).unplaced == HEADING_UNKNOWN
    assert pad_path(unseen, _pad((0.4, 0.0, 0.7))).unplaced is None
    assert pad_path(seen, _pad((2.0, 0.0, 0.7))).unplaced is None


def test_yaw_rate_is_the_derivative_of_a_heading_that_wraps() -> None:
    offset_s = _forecast(None).offset_s
    heading = 3.1 + 0.3 * offset_s
    pad = pad_path(_forecast((heading + math.pi) % (2.0 * math.pi) - math.pi), _pad((0.0, 0.0, 0.1)))
    assert pad.yaw_rate_rad_s is not None
    np.testing.assert_allclose(pad.yaw_rate_rad_s, 0.3, atol=1e-9)
