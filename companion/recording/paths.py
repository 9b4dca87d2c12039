"""Forecast and plan once more as `nav_msgs/Path`: the form that every 3-D tool draws without being told how.

A path holds places and headings only; times, speeds, accelerations and deviations are in `Forecast` and `Trajectory`.
"""

from companion.core.data import Array, Forecast
from companion.planning.guidance import Trajectory
from link.messages import Plan, PlannedPose
from link.payloads import cdr
from link.payloads.decklander_msgs import RosMessage
from link.zenoh.keys import Keys

_POINTS_EVERY = 2  # of the horizon's


def forecast_path_message(forecast: Forecast, keys: Keys) -> RosMessage:
    """Return the way of the vehicle's antenna; an unknown heading is east."""
    yaws_rad = [0.0] * len(forecast.offset_s) if forecast.yaw_rad is None else forecast.yaw_rad.tolist()
    return _path(keys.record("forecast_path"), forecast.t_ns, forecast.offset_s, forecast.position_enu_m, yaws_rad)


def plan_path_message(trajectory: Trajectory, t_ns: int, yaw_rad: float, keys: Keys) -> RosMessage:
    """Return the planned way of the drone.

    Args:
        trajectory: from `t_ns` on.
        t_ns: now, UTC.
        yaw_rad: the setpoint's heading.
        keys: of the Zenoh contract.
    """
    yaws_rad = [yaw_rad] * len(trajectory.offset_s)
    return _path(keys.record("plan_path"), t_ns, trajectory.offset_s, trajectory.position_enu_m, yaws_rad)


def _path(topic: str, t_ns: int, offset_s: Array, position_enu_m: Array, yaws_rad: list[float]) -> RosMessage:
    rows = zip(offset_s.tolist(), position_enu_m.tolist(), yaws_rad, strict=True)
    poses = tuple(
        PlannedPose(t_ns=max(t_ns + round(after_s * 1e9), 0), position_enu_m=(x, y, z), yaw_rad=yaw_rad)
        for after_s, (x, y, z), yaw_rad in list(rows)[::_POINTS_EVERY]
    )
    payload = cdr.encode(Plan(t_ns=max(t_ns, 0), poses=poses))
    return RosMessage(topic=topic, type_name=cdr.ROS_TYPES[Plan], payload=payload)
