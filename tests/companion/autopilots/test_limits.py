"""What the autopilots' parameters say of their limits and gains, and what is taken for said nothing."""

import math
from itertools import chain

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.limits import acceleration_of_tilt_m_s2
from companion.autopilots.px4 import Px4Driver
from companion.core.data import GRAVITY_M_S2

DRIVERS = (Px4Driver(), ArduPilotDriver())


@given(tilt_deg=st.floats(1.0, 80.0))
def test_thrust_to_the_side_is_what_the_tilt_gives_less_a_reserve(tilt_deg: float) -> None:
    level_m_s2 = GRAVITY_M_S2 * math.tan(math.radians(tilt_deg))
    assert 0.5 * level_m_s2 < acceleration_of_tilt_m_s2(tilt_deg) < level_m_s2


@pytest.mark.parametrize("driver", DRIVERS, ids=["px4", "ardupilot"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 0.0, -1.3])
def test_gains_that_nothing_could_fly_with_are_taken_for_the_defaults(driver: Driver, value: float) -> None:
    assert driver.cascade(dict.fromkeys(chain(*driver.gain_names), value)) == driver.cascade({})
