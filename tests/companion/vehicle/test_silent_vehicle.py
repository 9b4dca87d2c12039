"""A vehicle that tells nothing is placed by sightings of its pad alone, in the drone's own frame."""

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, HeadingConfig, ImmConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import Estimator, EstimatorMemory
from companion.vehicle.factory import make_estimator
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, Drive, circle, pad_centre, straight
from tests.companion.vehicle.rides import arrivals, now_ns

SEEN_S = 3.0
SENSORS = replace(NOMINAL, pad_rate_hz=30.0)


def silent() -> Estimator:
    return make_estimator(EstimatorConfig(), is_silent=True)


def only(quantity: Quantity, truth: Drive, seed: int) -> list[Measurement]:
    return [one for one in arrivals(truth, SENSORS, seed) if one.quantity is quantity and one.t_ns < now_ns(SEEN_S)]


def after(truth: Drive, seed: int) -> tuple[Estimator, EstimatorMemory | None]:
    chosen = silent()
    return chosen, chosen.fuse(None, only(Quantity.PAD, truth, seed))


@pytest.mark.parametrize("truth", [straight(7.0), circle()], ids=["straight", "circle"])
def test_sightings_alone_tell_the_pads_place_and_motion(truth: Drive) -> None:
    chosen, memory = after(truth, 7)
    (position, velocity, yaw, _), (earlier, _, yaw_before, _) = truth.at(SEEN_S), truth.at(SEEN_S - 0.01)
    estimate = chosen.estimate(memory, now_ns(SEEN_S))
    assert estimate is not None
    pad_m_s = (pad_centre(position, yaw) - pad_centre(earlier, yaw_before)) / 0.01
    assert np.linalg.norm(estimate.position_enu_m - pad_centre(position, yaw)) < 0.15
    assert np.linalg.norm(estimate.velocity_enu_m_s - pad_m_s) < 0.5
    assert np.linalg.norm(velocity) > 4.0


def test_what_is_known_grows_old_with_the_sightings_and_is_never_fine_enough_unseen() -> None:
    chosen, memory = after(straight(7.0), 8)
    newest_ns = chosen.newest_fix_ns(memory)
    assert newest_ns is not None
    assert now_ns(SEEN_S) - newest_ns < 100_000_000
    forecast = chosen.forecast(memory, now_ns(SEEN_S + 2.0), np.array([0.0]))
    assert forecast is not None
    assert forecast.is_coarse
    assert forecast.position_std_m[0, 0] > 0.25


def test_no_fix_starts_it() -> None:
    chosen = silent()
    memory = chosen.fuse(None, only(Quantity.POSITION, straight(7.0), 9))
    assert chosen.estimate(memory, now_ns(SEEN_S)) is None


def test_a_pad_that_is_seen_elsewhere_for_good_is_started_on_anew() -> None:
    chosen, memory = after(straight(7.0), 10)
    last = only(Quantity.PAD, straight(7.0), 10)[-1]
    elsewhere = last.value + np.array([-25.0, 40.0, 0.0])
    for index in range(15):
        later_ns = last.t_ns + (index + 1) * 33_000_000
        memory = chosen.fuse(memory, [replace(last, t_ns=later_ns, value=elsewhere)])
    estimate = chosen.estimate(memory, last.t_ns + 15 * 33_000_000)
    assert estimate is not None
    assert estimate.position_enu_m == pytest.approx(elsewhere, abs=0.3)
    assert np.linalg.norm(estimate.velocity_enu_m_s) < 2.0


def beside_m(turning_std_m_s2: float) -> float:
    """How far beside a straight road a vehicle is sought 3 s after it was seen for 0.8 s, root mean square."""
    config = EstimatorConfig(imm=ImmConfig(heading=HeadingConfig(turning_std_m_s2=turning_std_m_s2)))
    found_m = []
    for seed in range(20, 26):
        truth, chosen = straight(9.0), make_estimator(config, is_silent=True)
        seen = [one for one in only(Quantity.PAD, truth, seed) if one.t_ns < now_ns(0.8)]
        forecast = chosen.forecast(chosen.fuse(None, seen), seen[-1].t_ns, np.array([0.0, 3.0]))
        assert forecast is not None
        position, velocity, _, _ = truth.at((seen[-1].t_ns - now_ns(0.0)) * 1e-9 + 3.0)
        left = np.array([-velocity[1], velocity[0], 0.0]) / np.linalg.norm(velocity)
        found_m.append(float(left @ (forecast.position_enu_m[1] - position)))
    return float(np.sqrt(np.mean(np.square(found_m))))


def test_what_was_seen_for_a_moment_is_sought_along_a_curve_that_somebody_drives() -> None:
    assert beside_m(ImmConfig().heading.turning_std_m_s2) < 0.9 * beside_m(1e4)
