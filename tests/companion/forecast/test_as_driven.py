"""What the estimate may err is bounded by how the vehicle has been driven, along its way only."""

import numpy as np
import pytest

from companion.landing.touchdown.rollout_errors import as_driven
from companion.vehicle.hindsight import Driving

NORTH_EAST = np.array([0.6, 0.8])
OFF = 0.4 * np.random.default_rng(5).standard_normal((4000, 3, 2))
SEEN_10_S = (0.0,) * 100


def test_a_vehicle_that_stands_is_off_its_place_only() -> None:
    off = as_driven(OFF, Driving(), NORTH_EAST, stands=True)
    assert np.array_equal(off[:, 0], OFF[:, 0])
    assert not off[:, 1:].any()


def test_an_even_driver_errs_less_along_and_no_less_aside() -> None:
    off = as_driven(OFF, Driving(changes=SEEN_10_S, unevenness_m_s2=0.05), NORTH_EAST, stands=False)
    aside = np.array([-0.8, 0.6])
    assert off[:, 2] @ aside == pytest.approx(OFF[:, 2] @ aside)
    believed_m_s2 = float(np.std(OFF[:, 2] @ NORTH_EAST))
    expected_m_s2 = np.sqrt((2.0 * believed_m_s2**2 + 10.0 * 0.05**2) / 12.0)
    assert np.std(off[:, 2] @ NORTH_EAST) == pytest.approx(expected_m_s2, rel=0.01)


@pytest.mark.parametrize("driving", [Driving(), Driving(changes=SEEN_10_S, unevenness_m_s2=2.0)])
def test_an_unseen_or_an_uneven_driver_errs_as_the_estimate_says(driving: Driving) -> None:
    assert as_driven(OFF, driving, NORTH_EAST, stands=False) == pytest.approx(OFF)
