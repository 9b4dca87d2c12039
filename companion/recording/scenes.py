"""What a step knew as a 3-D scene for Foxglove; run by the recorder, not by the loop."""

import math
from collections.abc import Iterator

from companion.config.descent import DescentConfig
from companion.core.data import Forecast
from companion.recording.messages import forecast_of
from companion.recording.records import StepRecord
from companion.vehicle.pad import pad_path
from link.frames.geodesy import geodetic_from_local
from link.frames.rotations import quaternion_from_yaw
from link.payloads.decklander_msgs import RosMessage
from link.payloads.scene import (
    Cone,
    Pose,
    Scene,
    location_message,
    log_message,
    scene_message,
    transform_message,
)
from link.zenoh.keys import Keys

_COURSE_MIN_M_S = 0.5  # below it a course is no heading


def scene_messages(record: StepRecord, descent: DescentConfig, keys: Keys, *, long: bool) -> Iterator[RosMessage]:
    """Return where the drone is and what the pilot is told; with `long`, all that can be drawn, too.

    Args:
        record: of the step.
        descent: says the cone.
        keys: of the Zenoh contract.
        long: as of `companion.recording.messages.step_messages`.
    """
    own = record.inputs.own
    transforms = None if own is None else transform_message(Scene(t_ns=own.t_ns, drone=_drone(record)))
    if transforms is not None:
        yield transforms
    text = record.outputs.text
    if text is not None:
        yield log_message(keys.record("log"), record.inputs.t_ns, "companion", text)
    if long:
        yield from _long_messages(record, descent, keys)


def _long_messages(record: StepRecord, descent: DescentConfig, keys: Keys) -> Iterator[RosMessage]:
    """Return the vehicle's transforms, the scene, and where on earth the drone is."""
    scene = scene_of(record, forecast_of(record), descent)
    transforms = transform_message(Scene(t_ns=scene.t_ns, vehicle=scene.vehicle, pad=scene.pad))
    if transforms is not None:
        yield transforms
    yield scene_message(scene, keys.record("scene"))
    own, frame = record.inputs.own, record.inputs.autopilot.frame
    if own is not None and frame is not None:
        there = geodetic_from_local(frame, own.position_enu_m)
        yield location_message(keys.record("location"), own.t_ns, there)


def scene_of(record: StepRecord, forecast: Forecast | None, descent: DescentConfig) -> Scene:
    """Return all that a step knew of the landing's geometry."""
    status, plan = record.outputs.status, record.outputs.plan
    return Scene(
        t_ns=record.inputs.t_ns,
        drone=_drone(record),
        vehicle=None if forecast is None else _vehicle(record, forecast),
        pad=record.inputs.vehicle.pad,
        cone=Cone(radius_at_pad_m=descent.cone.radius_at_pad_m, slope=descent.cone.slope),
        forecast_enu_m=None if forecast is None else forecast.position_enu_m,
        forecast_std_m=None if forecast is None else forecast.position_std_m,
        plan_enu_m=None if plan is None else plan.trajectory.position_enu_m,
        label=f"{status.phase}: {status.reason}" if status.reason else status.phase,
    )


def _drone(record: StepRecord) -> Pose | None:
    own = record.inputs.own
    return None if own is None else (own.position_enu_m, own.orientation_wxyz)


def _vehicle(record: StepRecord, forecast: Forecast) -> Pose | None:
    """Return the point on the road under the pad and its heading; while that is unknown, the course."""
    pad = record.inputs.vehicle.pad
    if pad is None:
        return None
    path = pad_path(forecast, pad)
    yaw_rad = path.yaw_rad
    east_m_s, north_m_s, _ = path.velocity_enu_m_s[0].tolist()
    if yaw_rad is None and math.hypot(east_m_s, north_m_s) >= _COURSE_MIN_M_S:
        yaw_rad = math.atan2(north_m_s, east_m_s)
    if yaw_rad is None:
        return None
    x_m, y_m, z_m = path.position_enu_m[0].tolist()
    return (x_m, y_m, z_m - pad.height_m), quaternion_from_yaw(yaw_rad)
