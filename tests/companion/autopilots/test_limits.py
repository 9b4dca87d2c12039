"""What the autopilots' parameters say of their limits and gains, and what is taken for said nothing."""

import math
from collections.abc import Mapping
from itertools import chain

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.limits import LimitQuestions, acceleration_of_tilt_m_s2
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.response import ResponseModel
from companion.core.data import GRAVITY_M_S2, FlightLimits
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.parameters import Parameter
from sim_autopilot.firmware.ardupilot.parameters import OBEYED as ARDUPILOT_PARAMETERS
from sim_autopilot.firmware.px4.parameters import OBEYED as PX4_PARAMETERS

DRIVERS = (Px4Driver(), ArduPilotDriver())
ANY_LIMITS = FlightLimits(**dict.fromkeys(FlightLimits.__struct_fields__, math.inf))


@given(tilt_deg=st.floats(1.0, 80.0))
def test_thrust_to_the_side_is_what_the_tilt_gives_less_a_reserve(tilt_deg: float) -> None:
    level_m_s2 = GRAVITY_M_S2 * math.tan(math.radians(tilt_deg))
    assert 0.5 * level_m_s2 < acceleration_of_tilt_m_s2(tilt_deg) < level_m_s2


@pytest.mark.parametrize(
    ("driver", "reference"),
    [(Px4Driver(), PX4_PARAMETERS), (ArduPilotDriver(), ARDUPILOT_PARAMETERS)],
    ids=["px4", "ardupilot"],
)
def test_limit_that_a_firmware_calls_otherwise_counts_as_its_default(
    driver: Driver, reference: tuple[Parameter, ...]
) -> None:
    defaults = {parameter.name: float(parameter.default) for parameter in reference}
    by_default = driver.limits(ANY_LIMITS, defaults)
    for names in driver.limit_names:
        renamed = {name: value for name, value in defaults.items() if name not in names}
        assert driver.limits(ANY_LIMITS, renamed) == by_default
        assert driver.shaping(renamed) == driver.shaping(defaults)


@pytest.mark.parametrize("driver", DRIVERS, ids=["px4", "ardupilot"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 0.0, -1.3])
def test_gains_that_nothing_could_fly_with_are_taken_for_the_defaults(driver: Driver, value: float) -> None:
    assert driver.cascade(dict.fromkeys(chain(*driver.gain_names), value)) == driver.cascade({})


@pytest.mark.slow
@pytest.mark.parametrize("driver", DRIVERS, ids=["px4", "ardupilot"])
@given(data=st.data())
@settings(max_examples=50, deadline=None)
def test_no_gains_whatever_are_without_a_model_that_settles(driver: Driver, data: st.DataObject) -> None:
    names = st.sampled_from(tuple(chain(*driver.gain_names)))
    parameters = data.draw(st.dictionaries(names, st.floats(width=32) | st.floats(0.0, 20.0)))
    response = ResponseModel(driver.cascade(parameters), HORIZON_OFFSETS_S)
    assert np.all(np.linalg.eigvalsh(response.spread) >= -1e-9)
    assert np.all(np.linalg.eigvalsh(response.covariance) >= -1e-9)
    states = len(response.spread)
    start = np.vstack((np.ones((2, 1)), np.zeros((states - 2, 1))))
    ends = response.predict(start, np.zeros((len(HORIZON_OFFSETS_S), 1)))[-1]
    assert np.abs(ends[:2]).max() < 3.0


def test_gains_of_the_simulated_px4_are_taken_as_they_are() -> None:
    cascade = Px4Driver().cascade({"MPC_XY_P": 1.767, "MPC_XY_VEL_P_ACC": 4.81, "MPC_XY_VEL_I_ACC": 9.6})
    assert (cascade.position_per_s, cascade.velocity_per_s, cascade.integral_per_s2) == (1.767, 4.81, 9.6)


def gain(value: float) -> Message:
    return mavlink.MAVLink_param_value_message(b"MPC_XY_P", value, mavlink.MAV_PARAM_TYPE_REAL32, 1, 0)


def test_parameter_that_changes_all_the_time_is_taken_every_five_seconds_and_in_the_end_asked_for() -> None:
    driver, questions = Px4Driver(), LimitQuestions()
    values: list[Mapping[str, float]] = [{}]
    questions.due(driver, 0)
    for t_ns in range(0, 9_000_000_000, 1_000_000):
        known = questions.hear(gain(0.7 + t_ns * 1e-10), driver, values[-1], t_ns)
        if known is not values[-1]:
            values.append(known)
    assert [round((known["MPC_XY_P"] - 0.7) * 1e10 / 1e9, 2) for known in values[1:]] == [0.0, 0.0, 5.0]
    assert questions.due(driver, 10_000_000_000) == []
    assert questions.due(driver, 10_001_000_000) == ["MPC_XY_P"]
    assert questions.hear(gain(0.9), driver, values[-1], 10_020_000_000)["MPC_XY_P"] == pytest.approx(0.9)
