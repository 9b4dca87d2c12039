"""The landing pad now and over the horizon, from the forecast of the vehicle's antenna."""

from dataclasses import dataclass

import numpy as np

from companion.data import Array, Forecast
from link.messages import PadGeometry


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PadPath:
    """The pad's centre in W; row 0 is the present.

    Attributes:
        offset_s: (n,) seconds from now, the first is 0.
        position_enu_m: (n, 3).
        velocity_enu_m_s: (n, 3).
        acceleration_enu_m_s2: (n, 3).
        yaw_rad: heading of the vehicle now, None when unknown.
        position_std_m: (n, 3).
        placed: whether the pad's place is known; False while a lever arm points in an unknown direction.
    """

    offset_s: Array
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array
    yaw_rad: float | None
    position_std_m: Array
    placed: bool = True


def pad_path(forecast: Forecast, pad: PadGeometry | None) -> PadPath:
    """Return where the pad will be.

    The lever arm from the antenna turns with the vehicle's heading. With an unknown heading its horizontal
    part is left out and the pad is not placed: it can be followed, but not landed on. Without a pad geometry the
    antenna is taken for the pad's centre.

    Args:
        forecast: of the antenna, its first offset 0.
        pad: the vehicle's own description, None until it has answered.
    """
    lever_x_m, lever_y_m, lever_z_m = pad.antenna_to_pad_m if pad is not None else (0.0, 0.0, 0.0)
    position = forecast.position_enu_m + np.array([0.0, 0.0, lever_z_m])
    velocity = forecast.velocity_enu_m_s
    is_beside = bool(lever_x_m or lever_y_m)
    if forecast.yaw_rad is not None and is_beside:
        yaw = np.unwrap(forecast.yaw_rad)
        cos, sin = np.cos(yaw), np.sin(yaw)
        lever = np.column_stack([cos * lever_x_m - sin * lever_y_m, sin * lever_x_m + cos * lever_y_m])
        yaw_rate = np.gradient(yaw, forecast.offset_s)
        position[:, :2] += lever
        velocity = velocity + np.column_stack([-yaw_rate * lever[:, 1], yaw_rate * lever[:, 0], np.zeros_like(yaw)])
    return PadPath(
        offset_s=forecast.offset_s,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=forecast.acceleration_enu_m_s2,
        yaw_rad=None if forecast.yaw_rad is None else float(forecast.yaw_rad[0]),
        position_std_m=forecast.position_std_m,
        placed=forecast.yaw_rad is not None or not is_beside,
    )
