"""The simulated vehicle as a pure step: it waits for the drone, then drives its course.

Model: the middle of the body follows the road exactly, the body points along the road, and sways on its wheels.
State `VehicleMemory`: the instants at which something happened, in UTC nanoseconds; everything else is a closed form of
the time since departure, or in a seaway since the start, but for the swaying on wheels, which is computed before it.
Frames: W is ENU about the datum, V the body's FLU with its origin on the road under the middle of the body.
Angular velocity from ZYX Euler rates by the usual kinematic matrix.
"""

import math

import numpy as np
from msgspec import Struct

from link.frames.rotations import conjugate, multiply, quaternion_from_roll_pitch_yaw, rotate, wrap_angle
from link.messages import BodyTruth, Quaternion, Vector3
from link.records import replace
from scenarios.config import VehicleConfig
from scenarios.tracks.course import Course, Roughness
from scenarios.tracks.drive_config import Departure
from scenarios.tracks.profiles import Motion
from scenarios.tracks.roads import RoadPoint
from scenarios.tracks.suspension import dive_after
from sim_autopilot.core.data import Deck

_BRAKE_REACH_M = 3.0  # the vehicle brakes for a drone over its roof, not for one that waits ahead
_NO_WAVE = (0.0, 0.0, 0.0)
_STILL = (_NO_WAVE, _NO_WAVE, _NO_WAVE)


class VehicleState(Struct, frozen=True, kw_only=True):
    """The vehicle at `t_ns`: p_WV, its derivatives in W, q_WV and w_WV in V."""

    t_ns: int
    position_enu_m: Vector3
    velocity_enu_m_s: Vector3
    acceleration_enu_m_s2: Vector3
    orientation_wxyz: Quaternion
    angular_velocity_flu_rad_s: Vector3
    yaw_rad: float
    yaw_rate_rad_s: float


class VehicleMemory(Struct, frozen=True, kw_only=True):
    """When the drone began its present hover, when the vehicle departs, and when it began to brake; None is not yet."""

    started_ns: int | None = None
    hovers_since_ns: int | None = None
    departs_ns: int | None = None
    brakes_ns: int | None = None


class VehicleInputs(Struct, frozen=True, kw_only=True):
    """The time and the drone's truth, None while there is no drone."""

    t_ns: int
    drone: BodyTruth | None


class VehiclePlan(Struct, frozen=True, kw_only=True):
    """What the vehicle does: its course, its departure and the roof that the drone's height is taken from."""

    course: Course
    departure: Departure
    waiting_point_enu_m: Vector3
    roof_height_m: float


def vehicle_step(memory: VehicleMemory, inputs: VehicleInputs, plan: VehiclePlan) -> tuple[VehicleMemory, VehicleState]:
    """Return the memory and the vehicle's state at `inputs.t_ns`; times must not run backwards."""
    if memory.departs_ns is None:
        memory = _watch_for_hover(memory, inputs, plan)
    state = vehicle_at(memory, inputs.t_ns, plan)
    if plan.course.brake is not None and memory.brakes_ns is None and _drone_is_low(state, inputs.drone, plan):
        memory = replace(memory, brakes_ns=inputs.t_ns)
    return memory, state


def _watch_for_hover(memory: VehicleMemory, inputs: VehicleInputs, plan: VehiclePlan) -> VehicleMemory:
    """Return the memory with the departure set once the drone has hovered long enough."""
    departure = plan.departure
    started_ns = inputs.t_ns if memory.started_ns is None else memory.started_ns
    memory = replace(memory, started_ns=started_ns)
    if not departure.wait_for_drone:
        return replace(memory, departs_ns=started_ns + _ns(departure.departs_s))
    drone = inputs.drone
    if drone is None or math.dist(drone.position_enu_m, plan.waiting_point_enu_m) > departure.hover_radius_m:
        return replace(memory, hovers_since_ns=None)
    since_ns = inputs.t_ns if memory.hovers_since_ns is None else memory.hovers_since_ns
    long_enough = inputs.t_ns - since_ns >= _ns(departure.hover_s)
    departs_ns = inputs.t_ns + _ns(departure.departs_s) if long_enough else None
    return replace(memory, hovers_since_ns=since_ns, departs_ns=departs_ns)


def _ns(duration_s: float) -> int:
    return round(duration_s * 1e9)


def _drone_is_low(state: VehicleState, drone: BodyTruth | None, plan: VehiclePlan) -> bool:
    """Return whether the drone is over the vehicle, at the height at which the vehicle brakes."""
    brake = plan.course.brake
    if drone is None or brake is None:
        return False
    aside_m = math.dist(drone.position_enu_m[:2], state.position_enu_m[:2])
    height_m = drone.position_enu_m[2] - state.position_enu_m[2] - plan.roof_height_m
    return aside_m <= _BRAKE_REACH_M and height_m <= brake.height_above_roof_m


def vehicle_at(memory: VehicleMemory, t_ns: int, plan: VehiclePlan) -> VehicleState:
    """Return the vehicle's state at `t_ns` as `memory` decides it: the past, or the future if nothing happens."""
    course = plan.course
    motion = _motion_at(memory, t_ns, course)
    swaying = _STILL
    if course.sway is not None and memory.departs_ns is not None:
        heave, pitch, roll = course.sway.at((t_ns - memory.departs_ns) * 1e-9)
        swaying = heave, _dived(memory, t_ns, course, pitch), roll
    elif course.seaway is not None:
        swaying = course.seaway.at(0.0 if memory.started_ns is None else (t_ns - memory.started_ns) * 1e-9, motion)
    state = state_on_road(t_ns, motion, course.road.at(motion.s_m), course.roughness, swaying)
    turns = plan.departure.backwards + sum(motion.s_m > cusp_m for cusp_m in course.cusps_m)
    return _backwards(state) if turns % 2 else state


def _dived(memory: VehicleMemory, t_ns: int, course: Course, pitch: Vector3) -> Vector3:
    """Return the body's pitch, its rate and acceleration, with what a brake adds that the drone's height began."""
    brake = course.brake
    if brake is None or brake.suspension is None or memory.brakes_ns is None or memory.departs_ns is None:
        return pitch
    before = course.profile.at((memory.brakes_ns - memory.departs_ns) * 1e-9)
    stops_s = before.speed_m_s / brake.deceleration_m_s2
    more = dive_after((t_ns - memory.brakes_ns) * 1e-9, brake.deceleration_m_s2, stops_s, brake.suspension)
    return pitch[0] + more[0], pitch[1] + more[1], pitch[2] + more[2]


def _motion_at(memory: VehicleMemory, t_ns: int, course: Course) -> Motion:
    if memory.departs_ns is None:
        return course.profile.at(-1.0)
    if memory.brakes_ns is None or course.brake is None or t_ns <= memory.brakes_ns:
        return course.profile.at((t_ns - memory.departs_ns) * 1e-9)
    before = course.profile.at((memory.brakes_ns - memory.departs_ns) * 1e-9)
    return _brake(before, (t_ns - memory.brakes_ns) * 1e-9, course.brake.deceleration_m_s2)


def _brake(before: Motion, duration_s: float, deceleration_m_s2: float) -> Motion:
    """Return the motion after braking for `duration_s`, at most to a stop."""
    stop_s = before.speed_m_s / deceleration_m_s2
    braking_s = min(duration_s, stop_s)
    stands = duration_s >= stop_s
    return Motion(
        s_m=before.s_m + (before.speed_m_s - 0.5 * deceleration_m_s2 * braking_s) * braking_s,
        speed_m_s=0.0 if stands else before.speed_m_s - deceleration_m_s2 * braking_s,
        acceleration_m_s2=0.0 if stands else -deceleration_m_s2,
    )


def state_on_road(
    t_ns: int,
    motion: Motion,
    at: RoadPoint,
    roughness: Roughness | None,
    swaying: tuple[Vector3, Vector3, Vector3] = _STILL,
) -> VehicleState:
    """Return the state of a vehicle on the road; speeds are horizontal.

    Args:
        t_ns: of the state.
        motion: along the road.
        at: the road there.
        roughness: that shakes the body along the road, None for none.
        swaying: heave (m), pitch and roll (rad) of the body on its wheels or in waves, each with rate and acceleration.
    """
    v, a = motion.speed_m_s, motion.acceleration_m_s2
    heave, roll, shake = _shaken_by(roughness, motion.s_m)
    rise, dive, lean = swaying
    cosine, sine = math.cos(at.heading_rad), math.sin(at.heading_rad)
    yaw_rate_rad_s = at.curvature_per_m * v
    slope, bend_per_m = at.grade + heave[1], at.grade_change_per_m + heave[2]
    roll_rad, roll_rate_rad_s = roll[0] + lean[0], v * roll[1] + lean[1]
    pitch_rad = shake[0] - math.atan(at.grade) + dive[0]
    pitch_rate_rad_s = v * (shake[1] - at.grade_change_per_m / (1.0 + at.grade**2)) + dive[1]
    yaw_rad = wrap_angle(at.heading_rad)
    return VehicleState(
        t_ns=t_ns,
        position_enu_m=(at.x_m, at.y_m, at.z_m + heave[0] + rise[0]),
        velocity_enu_m_s=(v * cosine, v * sine, v * slope + rise[1]),
        acceleration_enu_m_s2=(
            a * cosine - v * yaw_rate_rad_s * sine,
            a * sine + v * yaw_rate_rad_s * cosine,
            a * slope + v * v * bend_per_m + rise[2],
        ),
        orientation_wxyz=quaternion_from_roll_pitch_yaw(roll_rad, pitch_rad, yaw_rad),
        angular_velocity_flu_rad_s=_body_rates(roll_rad, pitch_rad, roll_rate_rad_s, pitch_rate_rad_s, yaw_rate_rad_s),
        yaw_rad=yaw_rad,
        yaw_rate_rad_s=yaw_rate_rad_s,
    )


def _backwards(state: VehicleState) -> VehicleState:
    """Return the vehicle turned round where it is: what was its front is its rear."""
    roll_rate_rad_s, pitch_rate_rad_s, yaw_rate_rad_s = state.angular_velocity_flu_rad_s
    return replace(
        state,
        orientation_wxyz=multiply(state.orientation_wxyz, (0.0, 0.0, 0.0, 1.0)),
        angular_velocity_flu_rad_s=(-roll_rate_rad_s, -pitch_rate_rad_s, yaw_rate_rad_s),
        yaw_rad=wrap_angle(state.yaw_rad + math.pi),
    )


def _shaken_by(roughness: Roughness | None, s_m: float) -> tuple[Vector3, Vector3, Vector3]:
    """Return heave (m), roll and pitch (rad) of the body by the road, each with two derivatives by the distance."""
    if roughness is None:
        return _STILL
    return roughness.heave.at(s_m), roughness.roll.at(s_m), roughness.pitch.at(s_m)


def _body_rates(
    roll_rad: float, pitch_rad: float, roll_rate_rad_s: float, pitch_rate_rad_s: float, yaw_rate_rad_s: float
) -> Vector3:
    """Return the angular velocity in V of ZYX Euler rates."""
    forward_rad_s = math.cos(pitch_rad) * yaw_rate_rad_s
    return (
        roll_rate_rad_s - math.sin(pitch_rad) * yaw_rate_rad_s,
        math.cos(roll_rad) * pitch_rate_rad_s + math.sin(roll_rad) * forward_rad_s,
        math.cos(roll_rad) * forward_rad_s - math.sin(roll_rad) * pitch_rate_rad_s,
    )


def vehicle_truth(state: VehicleState) -> BodyTruth:
    """Return the state as the vehicle's truth is published."""
    return BodyTruth(
        t_ns=state.t_ns,
        position_enu_m=state.position_enu_m,
        orientation_wxyz=state.orientation_wxyz,
        velocity_flu_m_s=rotate(conjugate(state.orientation_wxyz), state.velocity_enu_m_s),
        angular_velocity_flu_rad_s=state.angular_velocity_flu_rad_s,
    )


def vehicle_deck(state: VehicleState, body: VehicleConfig) -> Deck:
    """Return the vehicle as the simulated drone's physics takes it."""
    return Deck(
        t_ns=state.t_ns,
        position_enu_m=np.array(state.position_enu_m),
        orientation_wxyz=np.array(state.orientation_wxyz),
        velocity_enu_m_s=np.array(state.velocity_enu_m_s),
        angular_velocity_enu_rad_s=np.array(rotate(state.orientation_wxyz, state.angular_velocity_flu_rad_s)),
        roof_size_m=(body.length_m, body.width_m),
        roof_height_m=body.roof_height_m,
        is_afloat=body.is_afloat,
    )
