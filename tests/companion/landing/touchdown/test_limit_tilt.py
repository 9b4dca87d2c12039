"""What the largest tilt leaves of the acceleration beside the lean that holds against the air."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.companion import CompanionConfig
from companion.core.data import Array, FlightLimits
from companion.landing.touchdown.levelling import limit_tilt
from companion.planning.guidance import PlanRequest, ReferenceState, Target
from link.records import replace

LIMITS = CompanionConfig().limits.flight_limits()

sides = st.floats(-math.pi, math.pi)
thrusts = st.floats(2.0, 9.0)
shares = st.floats(0.0, 0.79)  # of the thrust to the side, which the air takes


def _turned(length: float, angle_rad: float) -> Array:
    return np.array([length * math.cos(angle_rad), length * math.sin(angle_rad)])


def _tilts(tilt_m_s2: float) -> FlightLimits:
    return replace(LIMITS, acceleration_max_m_s2=100.0, tilt_acceleration_m_s2=tilt_m_s2)


def _left_m_s2(needed: Array, holds_enu_m_s2: Array, limits: FlightLimits) -> float:
    """What is left of a drone's tilt that is wanted off where it is, by (2,)."""
    offset_s = np.arange(0.0, 1.0, 0.2)
    still = np.zeros((len(offset_s), 3))
    request = PlanRequest(
        state=ReferenceState(
            position_enu_m=np.zeros(3), velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.zeros(3)
        ),
        target=Target(
            offset_s=offset_s,
            position_enu_m=still + np.array([*needed, 0.7]),
            velocity_enu_m_s=still,
            acceleration_enu_m_s2=still,
        ),
        limits=limits,
        floor_enu_m=still[:, 2],
        dt_s=0.02,
    )
    return limit_tilt(request, holds_enu_m_s2).limits.acceleration_max_m_s2


@given(tilt_m_s2=thrusts, share=shares, to_rad=sides, air_rad=sides)
def test_acceleration_and_what_holds_against_the_air_are_within_the_tilt_together(
    tilt_m_s2: float, share: float, to_rad: float, air_rad: float
) -> None:
    air = _turned(share * tilt_m_s2, air_rad)
    left_m_s2 = _left_m_s2(_turned(3.0, to_rad), air, _tilts(tilt_m_s2))
    assert math.hypot(*(_turned(left_m_s2, to_rad) + air).tolist()) == pytest.approx(tilt_m_s2)


@given(tilt_m_s2=thrusts, to_rad=sides)
def test_in_still_air_all_of_the_tilt_is_left(tilt_m_s2: float, to_rad: float) -> None:
    assert _left_m_s2(_turned(3.0, to_rad), np.zeros(2), _tilts(tilt_m_s2)) == pytest.approx(tilt_m_s2)


@given(tilt_m_s2=thrusts, share=st.floats(0.01, 1.0), air_rad=sides, off_rad=st.floats(-1.4, 1.4))
def test_more_is_left_to_brake_than_to_go_faster(
    tilt_m_s2: float, share: float, air_rad: float, off_rad: float
) -> None:
    air = _turned(share * tilt_m_s2, air_rad)
    faster, slower = (_turned(3.0, air_rad + off_rad + turned_rad) for turned_rad in (0.0, math.pi))
    assert _left_m_s2(slower, air, _tilts(tilt_m_s2)) > _left_m_s2(faster, air, _tilts(tilt_m_s2)) > 0.0


def test_tilt_raises_no_limit_and_one_that_is_not_known_lowers_none() -> None:
    for tilt_m_s2 in (101.0, math.inf):
        assert _left_m_s2(np.array([2.0, 1.0]), np.array([-3.0, 4.0]), _tilts(tilt_m_s2)) == 100.0
