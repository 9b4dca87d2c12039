"""From a companion's records to ROS 2 messages; run by the recorder, not by the loop."""

from collections.abc import Iterator

from companion.autopilots.own_reports import carry
from companion.core.data import Array, Forecast, OwnState, Setpoint, VehicleEstimate
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.planning.guidance import Trajectory
from companion.recording.records import InputRecord, LinkRecord, StepRecord, StepTimeRecord
from link.frames.rotations import conjugate, rotate
from link.messages import BodyTruth, ContactForecast, Fix, FixVelocity, PadSighting, Plan, PlannedPose, VehicleImu
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import RosMessage, bytes_array, floats, ids_array, ros_message
from link.zenoh.keys import Keys

LONG_EVERY = 5
"""Forecast, plan and estimate are recorded every so many steps: 10 times a second at 50 of them."""


def input_messages(record: InputRecord, keys: Keys) -> Iterator[RosMessage]:
    """Return an input as the node got it and, when it is a sample that can be read, on its own topic, too."""
    yield ros_message(
        keys.record("input"),
        "NodeInput",
        None,
        sequence=record.sequence,
        kind=int(record.kind),
        local_ns=record.local_ns,
        key=record.key,
        data=bytes_array(record.data),
    )
    kind = _sample_types(keys).get(record.key)
    if kind is None:
        return
    try:
        cdr.decode(kind, record.data)
    except PayloadError:
        return
    yield RosMessage(topic=record.key, type_name=cdr.ROS_TYPES[kind], payload=record.data)


def step_messages(record: StepRecord, keys: Keys, *, long: bool) -> Iterator[RosMessage]:
    """Return what a step knew and made; with `long`, the vehicle over the horizon and the whole plan, too."""
    inputs, outputs = record.inputs, record.outputs
    t_ns = inputs.t_ns
    if inputs.own is not None:
        yield own_message(inputs.own, keys)
    yield _step(record, keys)
    if outputs.setpoint is not None:
        yield _setpoint(outputs.setpoint, keys)
    if not long:
        return
    yield from _vehicle_messages(record, keys)
    if outputs.status.contact_forecast is not None:
        yield _contact_forecast(outputs.status.contact_forecast, t_ns, keys)
    way = outputs.way_from(t_ns)
    if way is not None and outputs.setpoint is not None:
        yield _plan(way, t_ns, keys)
        yield plan_path_message(way, t_ns, outputs.setpoint.yaw_rad, keys)


def _vehicle_messages(record: StepRecord, keys: Keys) -> Iterator[RosMessage]:
    estimate = estimate_of(record)
    if estimate is not None:
        yield estimate_message(estimate, keys)
    forecast = forecast_of(record)
    if forecast is not None:
        yield forecast_message(forecast, keys)
        yield forecast_path_message(forecast, keys)


def estimate_of(record: StepRecord) -> VehicleEstimate | None:
    """Return the vehicle as a step knew it, None before the first fix."""
    return record.estimator.estimate(record.estimator_memory, record.inputs.t_ns)


def forecast_of(record: StepRecord) -> Forecast | None:
    """Return the vehicle over the horizon as a step knew it; the step looked only as far ahead as its phase needs."""
    return record.estimator.forecast(record.estimator_memory, record.inputs.t_ns, HORIZON_OFFSETS_S)


def link_message(record: LinkRecord, keys: Keys) -> RosMessage:
    """Return the counters."""
    session, codec = record.session, record.session.codec
    return ros_message(
        keys.record("link"),
        "LinkStatistics",
        record.t_ns,
        bytes_received=codec.bytes_received,
        messages_received=codec.messages_received,
        messages_sent=codec.messages_sent,
        bad_bytes=codec.bad_bytes,
        lost_messages=codec.lost_messages,
        commands_retried=session.commands_retried,
        commands_timed_out=session.commands_timed_out,
        round_trips=session.round_trips,
        zenoh_bad_payloads=record.zenoh_bad_payloads,
        records_dropped=record.records_dropped,
    )


def step_time_message(record: StepTimeRecord, keys: Keys) -> RosMessage:
    """Return a step's duration."""
    return ros_message(
        keys.record("step_time"), "StepTime", record.t_ns, state_to_setpoint_s=record.state_to_setpoint_s
    )


def _sample_types(keys: Keys) -> dict[str, type[Fix | FixVelocity | VehicleImu | PadSighting]]:
    return {keys.fix: Fix, keys.fix_velocity: FixVelocity, keys.imu: VehicleImu, keys.pad_pose: PadSighting}


def own_message(own: OwnState, keys: Keys) -> RosMessage:
    """Return the drone's state at its stamp as Odometry, which has velocities in the body frame."""
    own = carry(own, own.t_ns)
    velocity_flu_m_s = rotate(conjugate(own.orientation_wxyz), own.velocity_enu_m_s)
    motion = BodyTruth(
        t_ns=max(own.t_ns, 0),
        position_enu_m=own.position_enu_m,
        orientation_wxyz=own.orientation_wxyz,
        velocity_flu_m_s=velocity_flu_m_s,
        angular_velocity_flu_rad_s=own.angular_velocity_flu_rad_s,
    )
    return RosMessage(topic=keys.record("own"), type_name=cdr.ROS_TYPES[BodyTruth], payload=cdr.encode(motion))


def _step(record: StepRecord, keys: Keys) -> RosMessage:
    outputs, status = record.outputs, record.outputs.status
    plan, reply = outputs.plan, outputs.reply
    next_state = None if plan is None else plan.next_state
    return ros_message(
        keys.record("step"),
        "Step",
        record.inputs.t_ns,
        phase=status.phase,
        reason=status.reason,
        text=outputs.text or "",
        reply=[] if reply is None else [f"accepted: {reply.reason}" if reply.accepted else f"refused: {reply.reason}"],
        armed=status.armed,
        measurements=len(record.inputs.vehicle.measurements),
        commands=ids_array([command.command for command in outputs.commands]),
        command_parameters=floats([command.parameters for command in outputs.commands]),
        relative_position_m=floats(status.relative_position_enu_m),
        relative_velocity_m_s=floats(status.relative_velocity_enu_m_s),
        height_above_pad_m=floats(status.height_above_pad_m),
        time_to_contact_s=floats(status.time_to_contact_s),
        fix_age_s=floats(status.fix_age_s),
        plan_status="" if plan is None else plan.status.value,
        plan_limit_excess=0.0 if plan is None else float(plan.limit_excess),
        plan_iterations=0 if plan is None else int(plan.iterations),
        next_position_m=floats(None if next_state is None else next_state.position_enu_m),
        next_velocity_m_s=floats(None if next_state is None else next_state.velocity_enu_m_s),
        next_acceleration_m_s2=floats(None if next_state is None else next_state.acceleration_enu_m_s2),
    )


def _setpoint(setpoint: Setpoint, keys: Keys) -> RosMessage:
    return ros_message(
        keys.record("setpoint"),
        "Setpoint",
        setpoint.t_ns,
        position_m=floats(setpoint.position_enu_m),
        velocity_m_s=floats(setpoint.velocity_enu_m_s),
        acceleration_m_s2=floats(setpoint.acceleration_enu_m_s2),
        yaw_rad=setpoint.yaw_rad,
    )


def _contact_forecast(forecast: ContactForecast, t_ns: int, keys: Keys) -> RosMessage:
    values = {name: getattr(forecast, name) for name in ContactForecast.__struct_fields__ if name != "in_s"}
    return ros_message(keys.record("contact_forecast"), "ContactForecast", t_ns, in_s=floats(forecast.in_s), **values)


def estimate_message(estimate: VehicleEstimate, keys: Keys) -> RosMessage:
    """Return the vehicle as estimated."""
    return ros_message(
        keys.record("estimate"),
        "VehicleEstimate",
        estimate.t_ns,
        position_m=floats(estimate.position_enu_m),
        velocity_m_s=floats(estimate.velocity_enu_m_s),
        acceleration_m_s2=floats(estimate.acceleration_enu_m_s2),
        covariance=floats(estimate.covariance),
        yaw_rad=floats(estimate.yaw_rad),
        yaw_rate_rad_s=floats(estimate.yaw_rate_rad_s),
    )


def forecast_message(forecast: Forecast, keys: Keys) -> RosMessage:
    """Return the vehicle over the horizon."""
    return ros_message(
        keys.record("forecast"),
        "Forecast",
        forecast.t_ns,
        offset_s=floats(forecast.offset_s),
        position_m=floats(forecast.position_enu_m),
        velocity_m_s=floats(forecast.velocity_enu_m_s),
        acceleration_m_s2=floats(forecast.acceleration_enu_m_s2),
        position_std_m=floats(forecast.position_std_m),
        yaw_rad=floats(forecast.yaw_rad),
    )


def _plan(trajectory: Trajectory, t_ns: int, keys: Keys) -> RosMessage:
    return ros_message(
        keys.record("plan"),
        "Trajectory",
        t_ns,
        offset_s=floats(trajectory.offset_s),
        position_m=floats(trajectory.position_enu_m),
        velocity_m_s=floats(trajectory.velocity_enu_m_s),
        acceleration_m_s2=floats(trajectory.acceleration_enu_m_s2),
    )


_POINTS_EVERY = 2  # of the horizon's


def forecast_path_message(forecast: Forecast, keys: Keys) -> RosMessage:
    """Return the way of the vehicle's antenna; an unknown heading is east."""
    yaws_rad = [0.0] * len(forecast.offset_s) if forecast.yaw_rad is None else forecast.yaw_rad.tolist()
    return _path(keys.record("forecast_path"), forecast.t_ns, forecast.offset_s, forecast.position_enu_m, yaws_rad)


def plan_path_message(trajectory: Trajectory, t_ns: int, yaw_rad: float, keys: Keys) -> RosMessage:
    """Return the planned way of the drone.

    Args:
        trajectory: its offsets from `t_ns`.
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
