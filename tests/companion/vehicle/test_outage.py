"""A vehicle without a heading sensor that turns while nothing is heard of it: its heading is learnt anew."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.core.data import Measurement, Quantity
from companion.vehicle.factory import make_estimator
from companion.vehicle.imm_numbers import Deck
from tests.companion.vehicle.rides import now_ns

SPEED_M_S, STEADY_S, HEARD_S = 8.0, 10.0, 6.0
FIX_STD_M, VELOCITY_STD_M_S = 0.015, 0.05


Leg = tuple[float, float, tuple[float, float]]
"""When it begins, the course, rad, and where."""


def _told(t_s: float, leg: Leg, rng: np.random.Generator) -> list[Measurement]:
    """Place and velocity of a vehicle that has driven evenly for `t_s`."""
    begin_s, course_rad, start_m = leg
    along = np.array([math.cos(course_rad), math.sin(course_rad), 0.0])
    place = np.array([*start_m, 0.0]) + SPEED_M_S * t_s * along
    return [
        Measurement(
            t_ns=now_ns(begin_s + t_s),
            quantity=quantity,
            value=value + std * rng.standard_normal(3),
            covariance=std**2 * np.eye(3),
        )
        for quantity, value, std in (
            (Quantity.POSITION, place, FIX_STD_M),
            (Quantity.VELOCITY, SPEED_M_S * along, VELOCITY_STD_M_S),
        )
    ]


@pytest.mark.parametrize("silent_s", [10.0, 20.0, 40.0])
@pytest.mark.parametrize("turn_deg", [90.0, 135.0, 180.0, -180.0])
def test_heading_after_an_outage_is_the_one_that_the_vehicle_has(silent_s: float, turn_deg: float) -> None:
    rng, turn_rad = np.random.default_rng(3), math.radians(turn_deg)
    chosen = make_estimator(EstimatorConfig(), Deck(antenna_to_pad_m=(1.2, 0.0, 0.5)), EstimatorKind.IMM)
    legs = (((0.0, 0.0, (0.0, 0.0)), STEADY_S), ((STEADY_S + silent_s, turn_rad, (100.0, 30.0)), HEARD_S))
    memory = None
    for leg, lasts_s in legs:
        for t_s in np.arange(0.0, lasts_s, 0.1).tolist():
            memory = chosen.fuse(memory, _told(t_s, leg, rng))
    estimate = chosen.estimate(memory, now_ns(STEADY_S + silent_s + HEARD_S))
    assert estimate is not None
    assert estimate.yaw_rad is not None
    assert math.cos(estimate.yaw_rad - turn_rad) > math.cos(math.radians(5.0))
