"""The filter's models as its kernels take them: each differs from steady driving in its own numbers only."""

import numpy as np
import pytest

from companion.config.estimation import BufferConfig, ImmConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import BufferedEstimator
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_forecast import forecast_modes
from companion.vehicle.imm_kernels import HEADING
from companion.vehicle.imm_noise import BEND_ACCELERATION_STD, BEND_STD
from companion.vehicle.imm_numbers import Deck, noises_with, numbers_of
from companion.vehicle.imm_sensors import antenna_velocity
from companion.vehicle.imm_swing import PITCH_RATE, ROLL_RATE, SIZE
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, straight
from tests.companion.vehicle.rides import arrivals, now_ns
from tests.companion.vehicle.test_imm_kernels import MOTION, NOISE, a_state

JERK, LATERAL = 0, 2
OWN = [{JERK}, {JERK}, {LATERAL}, {BEND_STD, BEND_ACCELERATION_STD}]


def test_each_model_differs_from_steady_driving_in_what_it_is_for() -> None:
    noises = numbers_of(ImmConfig(), Deck()).noises
    differ = [set(np.flatnonzero(row != noises[0]).tolist()) for row in noises[1:]]
    assert differ == OWN


def test_what_is_learnt_of_steady_driving_holds_for_each_model_but_for_its_own_manoeuvre() -> None:
    numbers = numbers_of(ImmConfig(), Deck())
    noises = noises_with(numbers, (0.0, 0.0, 0.0), (0.217, 0.219), 0.0, turn_is_measured=False)
    assert [JERK not in own for own in [set[int](), *OWN]] == (noises[:, JERK] == 0.217).tolist()
    assert [LATERAL not in own for own in [set[int](), *OWN]] == (noises[:, LATERAL] == 0.219).tolist()
    kept = np.delete(np.arange(noises.shape[1]), [JERK, LATERAL])
    assert (
        noises[:, kept] == noises_with(numbers, (0.0, 0.0, 0.0), (1.0, 1.0), 0.0, turn_is_measured=False)[:, kept]
    ).all()


def test_steady_driver_who_is_configured_as_wild_as_a_manoeuvre_stays_so() -> None:
    config = ImmConfig()
    config = config.model_copy(update={"steady": config.steady.model_copy(update={"jerk_psd_m2_s5": 5.0})})
    assert numbers_of(config, Deck()).steady_m2_s5[0] == (5.0, 5.0)


def test_water_has_no_ramps_and_a_vessel_is_steered_like_none_on_wheels() -> None:
    config = ImmConfig()
    afloat, on_road = (numbers_of(config, Deck(is_afloat=is_afloat)) for is_afloat in (True, False))
    assert np.all(afloat.noises[:, BEND_STD] == 0.0)
    assert afloat.steady_m2_s5[0] == on_road.steady_m2_s5[0]
    assert [one.steady_m2_s5[1][0] for one in (afloat, on_road)] == [
        config.helm_psd_m2_s5,
        config.steady.lateral_acceleration_psd_m2_s5,
    ]


def test_forecast_over_two_kinds_of_road_has_the_mean_of_their_variances() -> None:
    x, P = a_state(1), 1e-9 * np.eye(SIZE)
    ramp = np.where(np.isin(np.arange(len(NOISE)), (BEND_STD, BEND_ACCELERATION_STD)), 6.0 * NOISE, NOISE)
    variances = []
    for weights in ((1.0, 0.0), (0.0, 1.0), (0.5, 0.5)):
        modes = (np.stack([x, x]), np.stack([P, P]), np.array(weights))
        told = forecast_modes(modes, np.array([0.0, 0.3]), np.stack([NOISE, ramp]), MOTION, 1.0)
        variances.append(told[6][1, 3] ** 2)
    assert variances[1] > 1.5 * variances[0]
    assert variances[2] == pytest.approx(0.5 * (variances[0] + variances[1]), rel=1e-6)


@pytest.mark.parametrize("is_afloat", [False, True])
def test_a_velocity_that_contradicts_opens_every_rate_and_slope_that_it_is_made_of(*, is_afloat: bool) -> None:
    deck = Deck(antenna_to_pad_m=(1.0, 0.0, 0.5), is_afloat=is_afloat)
    imm = ImmModel(config=ImmConfig(), deck=deck)
    fix = Measurement(t_ns=now_ns(0.0), quantity=Quantity.POSITION, value=np.zeros(3), covariance=1e-4 * np.eye(3))
    start = imm.start(fix)
    contradicts = replace(fix, quantity=Quantity.VELOCITY, value=np.array([9.0, 0.0, 3.0]))
    opened = imm.recover(start, contradicts).modes[1][0].diagonal() - start.modes[1][0].diagonal()
    x = np.ones(SIZE)
    _, H = antenna_velocity(x, np.zeros(4))
    for state in np.flatnonzero(np.abs(H).max(axis=0) > 0.0).tolist():
        if state not in (HEADING, ROLL_RATE, PITCH_RATE):  # of which other sensors tell
            assert opened[state] == imm.numbers.prior_variances[state]


@pytest.mark.parametrize("is_afloat", [False, True])
def test_course_tells_where_a_car_points_and_not_where_a_vessel_does(*, is_afloat: bool) -> None:
    deck = Deck(antenna_to_pad_m=(-3.0, 0.0, 0.5), is_afloat=is_afloat)
    chosen = BufferedEstimator(model=ImmModel(config=ImmConfig(), deck=deck), config=BufferConfig())
    silent = replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0)
    memory = chosen.fuse(None, arrivals(straight(3.0, 10.0), silent, 1))
    estimate = chosen.estimate(memory, now_ns(9.0))
    assert estimate is not None
    assert (estimate.yaw_rad is None) is is_afloat
