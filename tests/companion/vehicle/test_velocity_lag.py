"""Velocities that are older than their stamps: by how much is learnt from changes of speed, and from nothing else."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import EstimatorMemory
from companion.vehicle.velocity_lag import VelocityLag, dated_velocities, learn_lag
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
from tests.companion.vehicle.rides import arrivals, estimator, now_ns


def delayed(truth: Drive, sent: Sequence[Measurement], quantity: Quantity, by_s: float) -> list[Measurement]:
    """The measurements with those of one quantity as they were `by_s` earlier, with the same noise."""
    which = 0 if quantity is Quantity.POSITION else 1

    def older(one: Measurement) -> Measurement:
        t_s = (one.t_ns - EPOCH_NS) * 1e-9
        change = truth.at(max(t_s - by_s, 0.0))[which] - truth.at(t_s)[which]
        return replace(one, value=one.value + change) if one.quantity is quantity else one

    return [older(one) for one in sent]


def learnt(measurements: Sequence[Measurement]) -> VelocityLag:
    lag = VelocityLag()
    for one in measurements:
        lag = learn_lag(lag, [one])
    return lag


@pytest.mark.parametrize("by_s", [0.12, 0.2, 0.45])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_lag_of_velocities_is_learnt_from_changes_of_speed(by_s: float, seed: int) -> None:
    for truth in (stop_and_go(), random_drive(seed)):
        sent = delayed(truth, arrivals(truth, NOMINAL, seed), Quantity.VELOCITY, by_s)
        assert learnt(sent).lag_s == pytest.approx(by_s, rel=0.1, abs=0.02)


@pytest.mark.parametrize("sensors", [NOMINAL, DEGRADED, replace(NOMINAL, rate_hz=1.0), replace(NOMINAL, rate_hz=5.0)])
def test_receiver_whose_velocities_are_of_their_stamps_has_no_lag(sensors: Sensors) -> None:
    for seed in range(12):
        for truth in (stop_and_go(), random_drive(seed), circle()):
            assert learnt(arrivals(truth, sensors, seed)).lag_s == 0.0


def test_receiver_that_states_too_little_has_no_lag_either() -> None:
    for seed in range(12):
        truth = random_drive(seed)
        sent = [replace(one, covariance=0.01 * one.covariance) for one in arrivals(truth, NOMINAL, seed)]
        assert learnt(sent).lag_s == 0.0


def test_places_that_are_old_and_steady_driving_tell_of_none() -> None:
    truth = stop_and_go()
    assert learnt(delayed(truth, arrivals(truth, NOMINAL, 4), Quantity.POSITION, 0.2)).lag_s == 0.0
    assert learnt(delayed(straight(8.0), arrivals(straight(8.0), NOMINAL, 4), Quantity.VELOCITY, 0.2)).lag_s == 0.0


def test_velocity_of_another_point_in_a_bend_is_no_lag() -> None:
    truth = circle(speed_m_s=5.0, radius_m=8.0)
    swing_m_s = 5.0 / 8.0 * 1.2

    def of_middle(one: Measurement) -> Measurement:
        if one.quantity is not Quantity.VELOCITY:
            return one
        yaw = truth.at((one.t_ns - EPOCH_NS) * 1e-9)[2]
        return replace(one, value=one.value + swing_m_s * np.array([-math.sin(yaw), math.cos(yaw), 0.0]))

    assert learnt([of_middle(one) for one in arrivals(truth, NOMINAL, 5)]).lag_s == 0.0


def test_order_of_arrival_repeats_and_a_step_of_the_place_change_little() -> None:
    truth = stop_and_go()
    sent = delayed(truth, arrivals(truth, NOMINAL, 6), Quantity.VELOCITY, 0.25)
    mixed = [one for i in range(0, len(sent), 7) for one in (*reversed(sent[i : i + 7]), *sent[i : i + 3])]
    stepped = [
        replace(one, value=one.value + 3.0) if one.quantity is Quantity.POSITION and one.t_ns > now_ns(6.0) else one
        for one in mixed
    ]
    assert learnt(stepped).lag_s == pytest.approx(0.25, abs=0.04)


def test_only_velocities_are_dated_earlier_and_only_by_a_lag_that_is_known() -> None:
    sent = arrivals(straight(8.0, length_s=1.0), NOMINAL, 7)
    assert dated_velocities(VelocityLag(), sent) == tuple(sent)
    known = VelocityLag(information_per_s2=4e4, product_per_s=8e3, squares=1.6e3, windows=5.0, is_known=True)
    for one, dated in zip(sent, dated_velocities(known, sent), strict=True):
        by_ns = 200_000_000 if one.quantity is Quantity.VELOCITY else 0
        assert one.t_ns - dated.t_ns == by_ns


def test_estimate_of_a_vehicle_that_stops_and_goes_is_as_good_as_it_says() -> None:
    truth = stop_and_go()
    sent = delayed(truth, arrivals(truth, NOMINAL, 8), Quantity.VELOCITY, 0.2)
    chosen = estimator(EstimatorKind.IMM)
    memory: EstimatorMemory | None = None
    lag, off_m = VelocityLag(), []
    for one in sent:
        lag = learn_lag(lag, [one])
        memory = chosen.fuse(memory, dated_velocities(lag, [one]))
        estimate = chosen.estimate(memory, one.t_ns)
        if estimate is not None and one.t_ns > now_ns(6.0) and one.quantity is Quantity.POSITION:
            off_m.append(np.linalg.norm((estimate.position_enu_m - truth.at((one.t_ns - EPOCH_NS) * 1e-9)[0])[:2]))
    assert chosen.health(memory).place_step == (0, 0.0)
    assert np.sqrt(np.mean(np.square(off_m))) < 0.05
