"""Places relative to a vehicle as the planner takes them: each derivative is that of the one before."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.data import Array
from companion.landing.sortie.over_vehicle import keep_out_of, over_vehicle
from companion.vehicle.pad import PadMounting, PadPath
from link.messages import StationFrame
from link.records import replace
from tests.companion.facts import CONFIG, pad_at

OFFSET_S = np.linspace(0.0, 4.0, 401)
INSIDE = slice(3, -3)  # numpy's differences are of the first order at the ends


def derivative(values: Array) -> Array:
    return np.asarray(np.gradient(values, OFFSET_S, axis=0))


def turning_pad(speed_m_s: float, rate_rad_s: float) -> PadPath:
    """A pad that drives on a circle."""
    rates = np.full_like(OFFSET_S, rate_rad_s)
    heading = rate_rad_s * OFFSET_S
    level = np.zeros_like(OFFSET_S)
    velocity = speed_m_s * np.column_stack((np.cos(heading), np.sin(heading), level))
    steps = 0.5 * (velocity[:-1] + velocity[1:]) * np.diff(OFFSET_S)[:, None]
    return PadPath(
        offset_s=OFFSET_S,
        position_enu_m=np.vstack((np.zeros(3), np.cumsum(steps, axis=0))),
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=speed_m_s * rates[:, None] * np.column_stack((-np.sin(heading), np.cos(heading), level)),
        yaw_rad=0.0,
        position_std_m=np.full((len(OFFSET_S), 3), 0.1),
        yaw_rate_rad_s=rates,
    )


@given(
    speed_m_s=st.floats(0.0, 15.0),
    rate_rad_s=st.floats(-0.5, 0.5),
    moving_m_s=st.tuples(*[st.floats(-4.0, 4.0)] * 3),
)
def test_velocity_and_acceleration_are_those_of_the_path_in_a_bend_too(
    speed_m_s: float, rate_rad_s: float, moving_m_s: tuple[float, float, float]
) -> None:
    pad = turning_pad(speed_m_s, rate_rad_s)
    way = np.array([-6.0, 4.0, 3.0]) + OFFSET_S[:, None] * np.array(moving_m_s)
    target = over_vehicle(way, StationFrame.VEHICLE, 0.0, pad, 0.1)
    velocity, acceleration = derivative(target.position_enu_m), derivative(target.velocity_enu_m_s)
    assert velocity[INSIDE] == pytest.approx(target.velocity_enu_m_s[INSIDE], abs=1e-2)
    assert acceleration[INSIDE] == pytest.approx(target.acceleration_enu_m_s2[INSIDE], abs=1e-2)


@pytest.mark.parametrize(
    ("arm_m", "yaw_rad", "radius_m"),
    [(0.5, 0.2, 4.0), (13.0, 0.2, 14.0), (0.5, None, 4.5), (13.0, None, 27.0), (0.0, None, 4.0)],
)
def test_vehicle_reaches_as_far_as_its_antenna_and_on_any_side_while_its_heading_is_unknown(
    arm_m: float, yaw_rad: float | None, radius_m: float
) -> None:
    pad = replace(pad_at(), mounting=PadMounting(arm_m=arm_m), yaw_rad=yaw_rad)
    assert CONFIG.sortie.vehicle_radius_m + CONFIG.sortie.keep_out_margin_m == 4.0
    assert keep_out_of(pad, CONFIG).radius_m == pytest.approx(radius_m)
