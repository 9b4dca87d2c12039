"""Velocities of another point than the antenna: it is learnt in bends, and they are made those of the antenna."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from companion.core.data import Measurement, Quantity
from companion.vehicle.velocity_point import VelocityPoint, learn_point, velocities_of_antenna
from link.records import replace
from tests.companion.vehicle.drives import (
    DEGRADED,
    EPOCH_NS,
    NOMINAL,
    Drive,
    Sensors,
    circle,
    random_drive,
    stop_and_go,
    straight,
)
from tests.companion.vehicle.rides import arrivals

ARM_M = (1.2, -0.5)  # from the antenna to where the velocity is told


def of_point(truth: Drive, sent: Sequence[Measurement], turns_rad_s: float) -> list[Measurement]:
    """The measurements with the velocities of a point ahead and to the right of the antenna, with the same noise."""

    def moved(one: Measurement) -> Measurement:
        if one.quantity is not Quantity.VELOCITY:
            return one
        yaw = truth.at((one.t_ns - EPOCH_NS) * 1e-9)[2]
        c, s = math.cos(yaw), math.sin(yaw)
        swing = np.array([-s * ARM_M[0] - c * ARM_M[1], c * ARM_M[0] - s * ARM_M[1], 0.0])
        return replace(one, value=one.value + turns_rad_s * swing)

    return [moved(one) for one in sent]


def learnt(measurements: Sequence[Measurement]) -> VelocityPoint:
    point = VelocityPoint()
    for one in measurements:
        point = learn_point(point, [one])
    return point


@pytest.mark.parametrize(("speed_m_s", "radius_m"), [(8.0, 30.0), (5.0, 20.0), (4.0, 8.0)])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_point_is_learnt_in_a_bend(speed_m_s: float, radius_m: float, seed: int) -> None:
    truth = circle(speed_m_s=speed_m_s, radius_m=radius_m)
    turns_rad_s = speed_m_s / radius_m
    point = learnt(of_point(truth, arrivals(truth, NOMINAL, seed), turns_rad_s))
    slip_rad = math.atan2(turns_rad_s * ARM_M[0], speed_m_s - turns_rad_s * ARM_M[1])
    c, s = math.cos(slip_rad), math.sin(slip_rad)  # it lies so in the frame of its own course
    np.testing.assert_allclose(point.arm_m, (c * ARM_M[0] + s * ARM_M[1], c * ARM_M[1] - s * ARM_M[0]), atol=0.15)


def test_velocities_become_those_of_the_antenna() -> None:
    truth = circle(speed_m_s=8.0, radius_m=30.0)
    sent = of_point(truth, arrivals(truth, NOMINAL, 4), 8.0 / 30.0)
    point, errors_m_s = VelocityPoint(), []
    for one in sent:
        point = learn_point(point, [one])
        (told,) = velocities_of_antenna(point, [one])
        if one.quantity is Quantity.VELOCITY and one.t_ns > sent[0].t_ns + 5_000_000_000:
            errors_m_s.append(told.value - truth.at((one.t_ns - EPOCH_NS) * 1e-9)[1])
            assert told.covariance[0, 0] > one.covariance[0, 0]
        elif one.quantity is not Quantity.VELOCITY:
            assert told is one
    np.testing.assert_allclose(np.mean(errors_m_s, axis=0), 0.0, atol=0.04)
    assert np.abs(np.array(errors_m_s)[:, :2]).max() < 0.3  # of 0.35 m/s that the point is faster, beside the noise


@pytest.mark.parametrize("sensors", [NOMINAL, DEGRADED, replace(NOMINAL, rate_hz=1.0), replace(NOMINAL, rate_hz=5.0)])
def test_receiver_whose_velocities_are_its_antennas_has_no_other_point(sensors: Sensors) -> None:
    for seed in range(12):
        for truth in (stop_and_go(), random_drive(seed), circle(), straight(8.0)):
            sent = arrivals(truth, sensors, seed)
            point = learnt(sent)
            assert point.arm_m == (0.0, 0.0)
            assert velocities_of_antenna(point, sent) == tuple(sent)


def test_straight_tells_of_no_point() -> None:
    truth = straight(8.0)
    assert not learnt(of_point(truth, arrivals(truth, NOMINAL, 5), 0.0)).is_known


def test_order_of_arrival_repeats_and_gaps_change_nothing() -> None:
    truth = circle(speed_m_s=8.0, radius_m=30.0)
    sent = of_point(truth, arrivals(truth, NOMINAL, 6), 8.0 / 30.0)
    repeated = [one for each in sent for one in (each, each)]
    assert learnt(repeated) == learnt(sent)
    slow = [one for one in sent if one.quantity is not Quantity.VELOCITY or (one.t_ns // 10**8) % 4 == 0]
    assert not learnt(slow).is_known
