"""Recorded paths are what forecast and plan say, in the form of `nav_msgs/Path`."""

import numpy as np
import pytest

from companion.core.data import Forecast
from companion.planning.guidance import Trajectory
from companion.recording.messages import forecast_path_message, plan_path_message
from link.messages import Plan
from link.payloads import cdr
from link.zenoh.keys import Keys

T_NS = 1_767_225_600_000_000_007
OFFSET_S = np.array([0.0, 0.1, 0.3, 0.6, 1.0])
POSITION_M = np.column_stack([3.0 + OFFSET_S, 2.0 * OFFSET_S, np.full(5, 1.6)])
NOTHING = np.zeros((5, 3))


def _forecast(yaw_rad: np.ndarray[tuple[int], np.dtype[np.float64]] | None) -> Forecast:
    return Forecast(
        t_ns=T_NS,
        offset_s=OFFSET_S,
        position_enu_m=POSITION_M,
        velocity_enu_m_s=NOTHING,
        acceleration_enu_m_s2=NOTHING,
        position_std_m=NOTHING,
        yaw_rad=yaw_rad,
    )


def _poses(payload: bytes) -> tuple[list[int], list[tuple[float, float, float]], list[float]]:
    poses = cdr.decode(Plan, payload).poses
    return [one.t_ns for one in poses], [one.position_enu_m for one in poses], [one.yaw_rad for one in poses]


def test_forecast_path_has_every_second_place_with_its_time_and_heading() -> None:
    message = forecast_path_message(_forecast(0.2 * OFFSET_S - 0.1), Keys())
    times_ns, places_m, yaws_rad = _poses(message.payload)
    assert (message.topic, message.type_name) == ("decklander/drone/companion/forecast_path", "nav_msgs/msg/Path")
    assert [t_ns - T_NS for t_ns in times_ns] == [0, 300_000_000, 1_000_000_000]
    assert np.array(places_m) == pytest.approx(POSITION_M[::2])
    assert yaws_rad == pytest.approx([-0.1, -0.04, 0.1])


def test_forecast_path_of_a_vehicle_without_heading_looks_east() -> None:
    assert _poses(forecast_path_message(_forecast(None), Keys()).payload)[2] == [0.0, 0.0, 0.0]


def test_plan_path_has_the_setpoints_heading() -> None:
    planned = Trajectory(
        offset_s=OFFSET_S, position_enu_m=POSITION_M, velocity_enu_m_s=NOTHING, acceleration_enu_m_s2=NOTHING
    )
    message = plan_path_message(planned, T_NS, 0.7, Keys())
    _, places_m, yaws_rad = _poses(message.payload)
    assert message.topic == "decklander/drone/companion/plan_path"
    assert np.array(places_m) == pytest.approx(POSITION_M[::2])
    assert yaws_rad == pytest.approx([0.7, 0.7, 0.7])
