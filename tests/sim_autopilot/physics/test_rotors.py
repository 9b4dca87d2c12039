import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, REPORT_AIRFRAME
from sim_autopilot.physics.parameters import body_record
from sim_autopilot.physics.rotors import ROTOR_X, ROTOR_Y, fill_commands, fill_lagged, fill_thrusts, fill_wrench

BODY = body_record(BENCHMARK_AIRFRAME, 0.8, ground_effect=True)[0]
ARM_M = BENCHMARK_AIRFRAME.arm_m
TORQUE_M = BENCHMARK_AIRFRAME.torque_coefficient_n_m_s2 / BENCHMARK_AIRFRAME.thrust_coefficient_n_s2
TOP_N = BENCHMARK_AIRFRAME.weight_n / 2.0
thrusts = st.lists(st.floats(0.0, TOP_N), min_size=4, max_size=4).map(np.array)
wrenches = st.tuples(st.floats(-20, 60), st.floats(-4, 4), st.floats(-4, 4), st.floats(-2, 2)).map(np.array)


def wrench_of(thrust: np.ndarray) -> np.ndarray:
    out = np.empty(4)
    fill_wrench.py_func(thrust, ARM_M, TORQUE_M, out)
    return out


def thrusts_of(wrench: np.ndarray) -> np.ndarray:
    out = np.empty(4)
    fill_thrusts.py_func(wrench, BODY, out)
    return out


def test_wrench_is_equation_5_of_the_report() -> None:
    kt, kd, d = 6.7e-6, 3.12e-7, 0.215
    matrix = np.array([[kt, kt, kt, kt], [0, 0, -d * kt, d * kt], [d * kt, -d * kt, 0, 0], [kd, kd, -kd, -kd]])
    speed = np.array([710.0, 802.0, 655.0, 741.0])
    np.testing.assert_allclose(wrench_of(kt * speed**2), matrix @ speed**2, rtol=1e-12)


def test_torques_are_moments_of_the_thrusts_at_the_rotors() -> None:
    thrust = np.array([3.0, 4.5, 2.0, 5.5])
    arms = np.column_stack([ROTOR_X, ROTOR_Y, np.zeros(4)]) * ARM_M
    moment = np.cross(arms, np.column_stack([np.zeros(4), np.zeros(4), thrust])).sum(axis=0)
    np.testing.assert_allclose(wrench_of(thrust)[1:3], moment[:2], rtol=1e-12)


@given(thrusts)
def test_allocation_returns_the_thrusts_of_any_wrench_that_they_can_give(thrust: np.ndarray) -> None:
    np.testing.assert_allclose(thrusts_of(wrench_of(thrust)), thrust, atol=1e-9)


@given(wrenches)
def test_allocation_stays_within_each_rotor(wrench: np.ndarray) -> None:
    thrust = thrusts_of(wrench)
    assert thrust.min() >= 0.0
    assert thrust.max() <= TOP_N + 1e-9


@given(wrenches)
def test_allocation_keeps_roll_and_pitch_up_to_one_rotor(wrench: np.ndarray) -> None:
    reach = ARM_M * TOP_N
    np.testing.assert_allclose(wrench_of(thrusts_of(wrench))[1:3], np.clip(wrench[1:3], -reach, reach), atol=1e-9)


@given(wrenches)
def test_allocation_keeps_thrust_before_yaw(wrench: np.ndarray) -> None:
    lean = np.minimum(TOP_N, np.abs(wrench[1:3]) / ARM_M).sum()
    wanted = min(max(wrench[0], lean), 4.0 * TOP_N - lean)
    assert wrench_of(thrusts_of(wrench))[0] == pytest.approx(wanted, abs=1e-9)


@given(wrenches)
def test_allocation_never_yaws_beyond_what_is_asked(wrench: np.ndarray) -> None:
    # with roll and pitch unequal, some yaw torque may be unavoidable; level, it never is
    level = np.array([wrench[0], 0.0, 0.0, wrench[3]])
    given_yaw = wrench_of(thrusts_of(level))[3]
    assert abs(given_yaw) <= abs(wrench[3]) + 1e-12
    assert given_yaw * wrench[3] >= 0.0


def test_allocation_without_limits_only_forbids_pulling() -> None:
    body = body_record(REPORT_AIRFRAME, 0.8, ground_effect=True)[0]
    out = np.empty(4)
    wrench = np.array([500.0, 11.0, -7.0, 3.0])
    fill_thrusts.py_func(wrench, body, out)
    np.testing.assert_allclose(wrench_of(out), wrench, rtol=1e-12)


def test_lag_reaches_63_percent_after_one_time_constant() -> None:
    out = np.empty(4)
    fill_lagged.py_func(np.zeros(4), np.full(4, 1000.0), 0.05, 0.05, out)
    np.testing.assert_allclose(out, 1000.0 * (1.0 - math.exp(-1.0)), rtol=1e-12)


def test_lag_does_not_depend_on_how_it_is_cut() -> None:
    start, command = np.array([700.0, 0.0, 900.0, 1050.0]), np.array([800.0, 300.0, 0.0, 1050.0])
    once, half, twice = np.empty(4), np.empty(4), np.empty(4)
    fill_lagged.py_func(start, command, 0.03, 0.05, once)
    fill_lagged.py_func(start, command, 0.011, 0.05, half)
    fill_lagged.py_func(half, command, 0.019, 0.05, twice)
    np.testing.assert_allclose(once, twice, rtol=1e-12)


def test_overdriven_commands_stay_within_the_motor() -> None:
    out = np.empty(4)
    fill_commands.py_func(np.array([7.0, 0.1, 3.7, 0.0]), np.array([700.0, 900.0, 742.7, 500.0]), 2.0, BODY, out)
    top = BENCHMARK_AIRFRAME.hover_speed_rad_s * math.sqrt(2.0)
    assert out[0] == pytest.approx(top)
    assert out[1] == 0.0
    assert 742.0 < out[2] < 745.0
    assert out[3] == 0.0
