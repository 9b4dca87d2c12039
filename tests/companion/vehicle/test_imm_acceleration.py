"""A vehicle whose inertial unit tells the acceleration along it, with gravity in it and an offset."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind, ImmConfig, ReceiversConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import EstimatorMemory
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, Drive, climb, drive, sense, straight
from tests.companion.vehicle.rides import estimator, now_ns

SAME_FRAME = EstimatorConfig(
    imm=ImmConfig(receivers=ReceiversConfig(frame_offset_std_m=0.0, frame_offset_walk_m2_s=0.0))
)
LATE = replace(NOMINAL, delay_s=0.15)
RATE_HZ, BRAKES_AT_S, WHITE_M_S2, OFFSET_M_S2 = 50.0, 10.02, 0.2, 0.2
GRAVITY_M_S2 = 9.80665

Felt = Callable[[float], float]


def braking(deceleration_m_s2: float) -> Drive:
    return drive(12.0, lambda t: float(np.clip(12.0 - deceleration_m_s2 * (t - BRAKES_AT_S), 0.0, 12.0)), lambda _: 0.0)


def told(felt: Felt, until_s: float, seed: int) -> list[tuple[int, Measurement]]:
    """Accelerations (arrival, measurement) that are 0.02 s old."""
    rng = np.random.default_rng(seed)
    found = []
    for i in range(round(until_s * RATE_HZ)):
        t_ns = now_ns(i / RATE_HZ)
        value = np.array([felt(i / RATE_HZ) + OFFSET_M_S2 + WHITE_M_S2 * rng.standard_normal()])
        measured = Measurement(t_ns=t_ns, quantity=Quantity.ACCELERATION, value=value, covariance=0.09 * np.eye(1))
        found.append((t_ns + 20_000_000, measured))
    return found


def known_at(
    t_s: float, arrivals: list[tuple[int, Measurement]], kind: EstimatorKind = EstimatorKind.IMM
) -> EstimatorMemory | None:
    chosen = estimator(kind, SAME_FRAME)
    return chosen.fuse(None, [measured for arrives_ns, measured in arrivals if arrives_ns <= now_ns(t_s)])


def speed_error_m_s(truth: Drive, t_s: float, arrivals: list[tuple[int, Measurement]]) -> float:
    estimate = estimator(EstimatorKind.IMM, SAME_FRAME).estimate(known_at(t_s, arrivals), now_ns(t_s))
    assert estimate is not None
    return float(np.linalg.norm(estimate.velocity_enu_m_s[:2]) - np.linalg.norm(truth.at(t_s)[1][:2]))


@pytest.mark.slow
@pytest.mark.parametrize("deceleration_m_s2", [2.5, 6.0])
def test_brake_is_known_a_tenth_of_a_second_after_it_began(deceleration_m_s2: float) -> None:
    truth, t_s = braking(deceleration_m_s2), BRAKES_AT_S + 0.1
    blind, feeling = [], []
    for seed in range(3):
        seen = sense(truth, LATE, seed)
        felt = told(lambda t: -deceleration_m_s2 if t > BRAKES_AT_S else 0.0, 12.0, seed)
        blind.append(speed_error_m_s(truth, t_s, seen))
        feeling.append(speed_error_m_s(truth, t_s, [*seen, *felt]))
    assert np.mean(blind) > 0.08 * deceleration_m_s2
    assert abs(np.mean(feeling)) < 0.035 * deceleration_m_s2


@pytest.mark.slow
def test_gravity_on_a_climb_is_not_taken_for_an_acceleration() -> None:
    truth = climb(0.08, 8.0)
    slope = np.arctan(truth.grade)

    def felt(t_s: float) -> float:
        return GRAVITY_M_S2 * math.sin(float(np.interp(t_s, np.arange(len(slope)) * 0.005, slope)))

    arrivals = [*sense(truth, NOMINAL, 5), *told(felt, truth.length_s, 5)]
    errors = [speed_error_m_s(truth, t_s, arrivals) for t_s in np.arange(6.5, truth.length_s - 0.2, 0.5)]
    assert np.abs(errors).max() < 0.25


def test_acceleration_waits_for_a_heading_to_be_along() -> None:
    truth = straight(0.0)
    standing = sense(truth, replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0), 6)
    felt = told(lambda _: 3.0, 8.0, 6)
    chosen = estimator(EstimatorKind.IMM, SAME_FRAME)
    without, with_felt = (
        chosen.estimate(known_at(7.0, arrivals), now_ns(7.0)) for arrivals in (standing, [*standing, *felt])
    )
    assert without is not None
    assert with_felt is not None
    assert with_felt.position_enu_m == pytest.approx(without.position_enu_m, abs=2e-3)


@pytest.mark.parametrize("kind", [EstimatorKind.LKF, EstimatorKind.UKF])
def test_estimators_without_a_use_for_it_leave_it_out(kind: EstimatorKind) -> None:
    seen, felt = sense(straight(8.0), NOMINAL, 7), told(lambda _: 0.0, 4.0, 7)
    chosen = estimator(kind, SAME_FRAME)
    without, with_felt = (
        chosen.estimate(known_at(3.0, arrivals, kind), now_ns(3.0)) for arrivals in (seen, [*seen, *felt])
    )
    assert without is not None
    assert with_felt is not None
    assert with_felt.velocity_enu_m_s == pytest.approx(without.velocity_enu_m_s, abs=1e-3)
