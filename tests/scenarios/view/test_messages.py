"""Messages that the view does not take: what is in them is not whole, or no number."""

import math
from typing import Any

import pytest

from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import floats, ids_array, ros_message
from link.zenoh.keys import Keys
from scenarios.view.state import StateReader, ViewState

KEYS = Keys()
FORECAST = {
    name: floats([0.0] * 6) for name in ("position_m", "velocity_m_s", "acceleration_m_s2", "position_std_m")
} | {"offset_s": floats([0.0, 1.0]), "yaw_rad": floats(None)}
TRAJECTORY = {name: FORECAST[name] for name in ("offset_s", "position_m", "velocity_m_s", "acceleration_m_s2")}
STEP: dict[str, Any] = {
    **dict.fromkeys(("phase", "reason", "text", "plan_status"), ""),
    **dict.fromkeys(("measurements", "plan_limit_excess", "plan_iterations"), 0),
    **dict.fromkeys(("relative_position_m", "relative_velocity_m_s"), floats([1.0, 2.0, 3.0])),
    **dict.fromkeys(("height_above_pad_m", "time_to_contact_s", "fix_age_s", "command_parameters"), floats(None)),
    **dict.fromkeys(("next_position_m", "next_velocity_m_s", "next_acceleration_m_s2"), floats(None)),
    "reply": [],
    "armed": False,
    "commands": ids_array([]),
}


@pytest.mark.parametrize(
    ("topic", "name", "fields", "wrong", "count"),
    [
        ("forecast", "Forecast", FORECAST, "position_m", 4),
        ("forecast", "Forecast", FORECAST, "position_m", 9),
        ("forecast", "Forecast", FORECAST, "position_std_m", 5),
        ("plan", "Trajectory", TRAJECTORY, "position_m", 4),
        ("step", "Step", STEP, "relative_position_m", 1),
    ],
)
def test_message_whose_vectors_are_not_whole_is_refused(
    topic: str, name: str, fields: dict[str, Any], wrong: str, count: int
) -> None:
    right, bad = (
        ros_message(KEYS.record(topic), name, 1, **{**fields, wrong: values})
        for values in (fields[wrong], floats([0.0] * count))
    )
    state = StateReader(KEYS).taken(ViewState(), right.topic, right.payload)
    with pytest.raises(PayloadError, match=r"numbers are no|standard deviations"):
        StateReader(KEYS).taken(state, bad.topic, bad.payload)


ESTIMATE = {name: floats([0.0] * 3) for name in ("position_m", "velocity_m_s", "acceleration_m_s2")} | {
    "covariance": floats([0.0] * 81),
    "yaw_rad": floats([1.0]),
    "yaw_rate_rad_s": floats(None),
}


@pytest.mark.parametrize("number", [math.inf, math.nan])
@pytest.mark.parametrize(
    ("topic", "name", "fields", "wrong"),
    [
        ("estimate", "VehicleEstimate", ESTIMATE, "yaw_rad"),
        ("estimate", "VehicleEstimate", ESTIMATE, "position_m"),
        ("forecast", "Forecast", FORECAST, "position_std_m"),
        ("plan", "Trajectory", TRAJECTORY, "position_m"),
        ("step", "Step", STEP, "relative_velocity_m_s"),
    ],
)
def test_message_with_a_number_that_is_not_finite_is_refused(
    topic: str, name: str, fields: dict[str, Any], wrong: str, number: float
) -> None:
    values = [*fields[wrong][:-1], number]
    bad = ros_message(KEYS.record(topic), name, 1, **{**fields, wrong: floats(values)})
    with pytest.raises(PayloadError, match="not finite"):
        StateReader(KEYS).taken(ViewState(), bad.topic, bad.payload)
