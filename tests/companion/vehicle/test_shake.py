"""How much of a pad's swing to the sides is followed."""

import math

import numpy as np
import pytest

from companion.core.data import Array, Forecast
from companion.vehicle.pad import pad_path
from companion.vehicle.shake import swing_of
from link.messages import PadGeometry

HEIGHT_M, YAW_RAD = 1.6, 0.7
AHEAD, LEFT = (np.array([math.cos(YAW_RAD), math.sin(YAW_RAD)]), np.array([-math.sin(YAW_RAD), math.cos(YAW_RAD)]))


def swinging(roll_rad_s: float, pitch_rad_s: float) -> Forecast:
    """Roll and pitch of 0.05 and 0.03 rad, undamped, of a vehicle that stands."""
    offset_s = np.linspace(0.0, 1.0, 501)
    at_rest = np.zeros((len(offset_s), 3))
    return Forecast(
        t_ns=0,
        offset_s=offset_s,
        position_enu_m=at_rest,
        velocity_enu_m_s=at_rest,
        acceleration_enu_m_s2=at_rest,
        yaw_rad=np.full(len(offset_s), YAW_RAD),
        position_std_m=at_rest,
        tilt_rad=np.column_stack([*swing(roll_rad_s, 0.05, offset_s), *swing(pitch_rad_s, 0.03, offset_s)]),
        swing=np.array([[1.0, 0.1], [roll_rad_s, 0.0], [pitch_rad_s, 0.0]]),
    )


def swing(w: float, size_rad: float, t_s: Array) -> tuple[Array, Array]:
    return size_rad * np.sin(w * t_s + 0.4), size_rad * w * np.cos(w * t_s + 0.4)


def shares(roll_rad_s: float, pitch_rad_s: float) -> tuple[float, float]:
    """Of the swing that is left out, to the side and ahead."""
    forecast = swinging(roll_rad_s, pitch_rad_s)
    out = swing_of(forecast, HEIGHT_M)
    assert out is not None
    assert forecast.tilt_rad is not None
    aside, ahead = out.shake_enu[0] @ LEFT, out.shake_enu[0] @ AHEAD
    roll, pitch = forecast.tilt_rad[:, 0], forecast.tilt_rad[:, 2]
    return float(np.median(-aside / (HEIGHT_M * roll))), float(np.median(ahead / (HEIGHT_M * pitch)))


def test_ship_s_swing_is_followed_and_a_shaking_car_s_is_not() -> None:
    assert max(shares(0.6, 0.7)) < 0.05
    assert min(shares(2.0 * math.pi * 1.2, 2.0 * math.pi * 1.0)) > 0.75


def test_left_out_share_costs_least_lean_and_speed() -> None:
    """Against a search over shares of a swing of 1 cm."""
    w = 5.0
    followed = np.linspace(0.0, 1.0, 10_001)
    lean, speed = followed * 0.01 * w**2 / 9.80665, (1.0 - followed) * 0.01 * w
    best = followed[np.argmin((lean / math.radians(10.0)) ** 2 + (speed / 0.5) ** 2)]
    assert shares(w, w) == pytest.approx((1.0 - best, 1.0 - best), abs=2e-3)


def test_velocity_and_acceleration_are_how_the_place_changes() -> None:
    forecast = swinging(5.0, 4.0)
    out = swing_of(forecast, HEIGHT_M)
    assert out is not None
    for order in (0, 1):
        rate = np.gradient(out.shake_enu[order], forecast.offset_s, axis=0, edge_order=2)
        assert rate == pytest.approx(out.shake_enu[order + 1], abs=2e-3)


def test_followed_pad_and_its_shake_are_the_pad() -> None:
    pad = PadGeometry(size_m=(1.5, 1.5), height_m=HEIGHT_M, antenna_to_pad_m=(0.0, 0.0, HEIGHT_M))
    forecast = swinging(5.0, 4.0)  # the antenna is on the axis: it does not swing
    path = pad_path(forecast, pad)
    assert forecast.tilt_rad is not None
    assert path.swing is not None
    roll, pitch = forecast.tilt_rad[:, :1], forecast.tilt_rad[:, 2:3]
    swung = HEIGHT_M * (pitch * AHEAD - roll * LEFT)
    assert path.position_enu_m[:, :2] + path.swing.shake_enu[0] == pytest.approx(swung)


def test_slope_is_that_of_the_deck() -> None:
    forecast = swinging(5.0, 4.0)
    out = swing_of(forecast, HEIGHT_M)
    assert out is not None
    assert forecast.tilt_rad is not None
    assert out.slope @ AHEAD == pytest.approx(-forecast.tilt_rad[:, 2])  # bow down
    assert out.slope @ LEFT == pytest.approx(forecast.tilt_rad[:, 0])  # port up


def test_vehicle_that_does_not_tell_its_tilt_has_no_swing() -> None:
    forecast = swinging(5.0, 4.0)
    untold = Forecast(
        t_ns=0,
        offset_s=forecast.offset_s,
        position_enu_m=forecast.position_enu_m,
        velocity_enu_m_s=forecast.velocity_enu_m_s,
        acceleration_enu_m_s2=forecast.acceleration_enu_m_s2,
        yaw_rad=forecast.yaw_rad,
        position_std_m=forecast.position_std_m,
    )
    assert swing_of(untold, HEIGHT_M) is None
