"""Guidance only: the pad's place, as LANDING_TARGET, for an autopilot that flies its own precision landing; pure.

ArduCopter takes the way from the drone in its body's axes (MAV_FRAME_BODY_FRD), with its length, and turns it by its
own attitude. PX4 takes the place in its local frame (MAV_FRAME_LOCAL_NED) and refuses the other.
Source: ArduCopter 4.6, AC_PrecLand_Companion.cpp; PX4 1.17, mavlink_receiver.cpp, handle_message_landing_target.
"""

import math

from companion.autopilots.own_reports import carry
from companion.config.autopilot import Guide
from companion.config.companion import CompanionConfig
from companion.core.data import OwnState
from companion.landing.state.step_data import StepInputs, StepOutputs
from companion.vehicle.pad_reach import is_unseen
from link.frames.rotations import conjugate, frd_from_flu, multiply, ned_from_enu, quaternion_from_yaw, rotate
from link.frames.rotations import quaternion_ned_frd_from_enu_flu as ned_frd
from link.mavlink.dialect import Message, mavlink
from link.messages import Quaternion, Vector3

_NO_TURN = (1.0, 0.0, 0.0, 0.0)
_FAR_M = 1e4


def landing_target(
    place_enu_m: Vector3, yaw_rad: float | None, own: OwnState, *, in_body_axes: bool, local_ns: int
) -> Message | None:
    """Return the message, None for a place that is absurd.

    Args:
        place_enu_m: of the pad's centre in W.
        yaw_rad: the vehicle's heading, None while unknown.
        own: the drone at the same time.
        in_body_axes: what ArduCopter takes; False for PX4's.
        local_ns: now, on the clock that answers the autopilot's TIMESYNC.
    """
    x, y, z = (there - here for there, here in zip(place_enu_m, own.position_enu_m, strict=True))
    distance_m = math.hypot(x, y, z)
    if not distance_m < _FAR_M:
        return None
    upright: Quaternion | None = None if yaw_rad is None else quaternion_from_yaw(yaw_rad)
    if in_body_axes:
        body = conjugate(own.orientation_wxyz)
        place = frd_from_flu(rotate(body, (x, y, z)))
        turn = _NO_TURN if upright is None else _frd_turn(multiply(body, upright))
    else:
        place = ned_from_enu(place_enu_m)
        turn = _NO_TURN if upright is None else ned_frd(upright)
    return mavlink.MAVLink_landing_target_message(
        time_usec=local_ns // 1000,
        target_num=0,
        frame=mavlink.MAV_FRAME_BODY_FRD if in_body_axes else mavlink.MAV_FRAME_LOCAL_NED,
        angle_x=0.0,
        angle_y=0.0,
        distance=distance_m,
        size_x=0.0,
        size_y=0.0,
        x=place[0],
        y=place[1],
        z=place[2],
        q=list(turn),
        type=mavlink.LANDING_TARGET_TYPE_RADIO_BEACON,
        position_valid=1,
    )


def _frd_turn(q_flu: Quaternion) -> Quaternion:
    """Return a turn between two frames with axes forward, left, up, between the same with forward, right, down."""
    w, x, y, z = q_flu
    return (w, x, -y, -z)


def guiding_message(outputs: StepOutputs, inputs: StepInputs, config: CompanionConfig, local_ns: int) -> Message | None:
    """Return the LANDING_TARGET of a step, None while nothing is guided or the pad is not known well enough.

    An autopilot that hears none for some seconds does what its own parameters say of a lost target.

    Args:
        outputs: of the step.
        inputs: of the step.
        config: all numbers.
        local_ns: now, on the companion's own clock.
    """
    if config.autopilot.guide is not Guide.PRECLAND:
        return None
    pad, own, driver, fix_age_s = outputs.pad, inputs.own, inputs.driver, outputs.status.fix_age_s
    if pad is None or own is None or driver is None or pad.unplaced is not None or is_unseen(pad, config):
        return None
    age_s = (inputs.t_ns - own.t_ns) * 1e-9
    if fix_age_s is None or fix_age_s > config.abort.fix_age_max_s or age_s > config.abort.own_age_max_s:
        return None
    x, y, z = pad.position_enu_m[0].tolist()
    return landing_target(
        (x, y, z),
        pad.yaw_rad,
        carry(own, inputs.t_ns),
        in_body_axes=driver.takes_target_in_body_axes,
        local_ns=local_ns,
    )
