"""The virtual model that the setpoints follow: its history, how well the drone follows it, and the correction.

An autopilot follows a moving setpoint with a lag of its own (0.4 m with PX4 at 5 m/s). The lag shows as a
lasting difference between the model and the drone at the same instant; its horizontal part is learnt slowly
and added to the setpoints.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from companion.core.data import Array, Setpoint
from companion.planning.guidance import ReferenceState, Trajectory
from link.messages import Vector3
from link.records import replace

_HISTORY_S = 0.6  # longer than any telemetry is late
_CORRECTION_GAIN_HZ = 0.5  # slower than the autopilot's own position loop (about 1 rad/s) by a factor of two
_CORRECTION_MAX_M = 1.5
_CAUGHT_UP_MAX_M = 1.0  # made up for by velocity at a time; more would be a chase
_LEARNING_ERROR_MAX_M = 1.0  # a larger difference is a transient, not a lag


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tracking:
    """The model's recent past and the correction.

    Attributes:
        past: (monotonic ns, position (3,) in W), oldest first.
        behind_enu_m: (3,) from the drone to the model at the time of the drone's newest report.
        error_m: length of that.
        correction_enu_m: (3,) added to the setpoints' position.
        compared_ns: monotonic time of the newest report that was compared; None before the first.
    """

    past: tuple[tuple[int, Array], ...] = ()
    behind_enu_m: Array = field(default_factory=lambda: np.zeros(3))
    error_m: float = 0.0
    correction_enu_m: Array = field(default_factory=lambda: np.zeros(3))
    compared_ns: int | None = None


def add_to_past(tracking: Tracking, t_ns: int, reference: ReferenceState) -> Tracking:
    """Return the tracking with the model's position at the monotonic `t_ns` added."""
    past = tracking.past
    while past and (t_ns - past[0][0]) * 1e-9 > _HISTORY_S:
        past = past[1:]
    return replace(tracking, past=(*past, (t_ns, reference.position_enu_m)))


def update_tracking(tracking: Tracking, own_ns: int, position_enu_m: Vector3, *, learns: bool) -> Tracking:
    """Return the tracking after comparing the drone's report with the model at the same instant.

    Args:
        tracking: so far.
        own_ns: monotonic time of the drone's newest report.
        position_enu_m: of the drone then.
        learns: whether the lag is learnt from it.
    """
    before_ns = tracking.compared_ns
    if before_ns is not None and own_ns <= before_ns:
        return tracking
    if len(tracking.past) < 2 or own_ns < tracking.past[0][0]:
        return tracking
    difference = _position_at(tracking, own_ns) - np.array(position_enu_m)
    error_m = math.hypot(*difference.tolist())
    since_s = 0.0 if before_ns is None else (own_ns - before_ns) * 1e-9
    tracking = replace(tracking, behind_enu_m=difference, error_m=error_m, compared_ns=own_ns)
    if not learns or error_m > _LEARNING_ERROR_MAX_M:
        return tracking
    step = _CORRECTION_GAIN_HZ * min(since_s, _HISTORY_S) * difference * np.array([1.0, 1.0, 0.0])
    correction = tracking.correction_enu_m + step
    length_m = math.hypot(*correction.tolist())
    if length_m > _CORRECTION_MAX_M:
        correction = correction * (_CORRECTION_MAX_M / length_m)
    return replace(tracking, correction_enu_m=correction)


def _position_at(tracking: Tracking, t_ns: int) -> Array:
    later = tracking.past[-1]
    for entry in reversed(tracking.past):
        if entry[0] <= t_ns:
            if entry is later:
                return entry[1]
            share = (t_ns - entry[0]) / (later[0] - entry[0])
            return np.asarray(entry[1] + share * (later[1] - entry[1]))
        later = entry
    return later[1]


def press_down(reference: ReferenceState, acceleration_m_s2: float, duration_s: float) -> ReferenceState:
    """Return the model pressed down for `duration_s`, so that the thrust drops and the gear holds on to the pad."""
    faster_m_s = acceleration_m_s2 * duration_s
    return ReferenceState(
        position_enu_m=reference.position_enu_m - np.array([0.0, 0.0, 0.5 * faster_m_s * duration_s]),
        velocity_enu_m_s=reference.velocity_enu_m_s - np.array([0.0, 0.0, faster_m_s]),
        acceleration_enu_m_s2=np.array([*reference.acceleration_enu_m_s2[:2], -acceleration_m_s2]),
    )


def limit_sink(reference: ReferenceState, lowest_enu_m: float, duration_s: float) -> ReferenceState:
    """Return the model for an autopilot that carries a setpoint on for `duration_s`, should no other follow.

    Without a downward acceleration, which would add up to several metres per second, and sinking no faster than what
    ends above `lowest_enu_m`: ArduCopter was flown into the road at 1.6 m/s from a chase whose companion had died.
    """
    ax, ay, az = reference.acceleration_enu_m_s2
    vx, vy, vz = reference.velocity_enu_m_s
    above_m = max(float(reference.position_enu_m[2]) - lowest_enu_m, 0.0)
    slowest_m_s = -above_m / duration_s if duration_s > 0.0 else -math.inf
    return replace(
        reference,
        velocity_enu_m_s=np.array([vx, vy, max(vz, slowest_m_s)]),
        acceleration_enu_m_s2=np.array([ax, ay, max(az, 0.0)]),
    )


def extrapolate(reference: ReferenceState, duration_s: float) -> ReferenceState:
    """Return the model `duration_s` later (or, negative, earlier) at its present acceleration."""
    velocity, acceleration = reference.velocity_enu_m_s, reference.acceleration_enu_m_s2
    return replace(
        reference,
        position_enu_m=reference.position_enu_m + (velocity + 0.5 * acceleration * duration_s) * duration_s,
        velocity_enu_m_s=velocity + acceleration * duration_s,
    )


def state_in_plan(trajectory: Trajectory, offset_s: float) -> ReferenceState:
    """Return the model `offset_s` after its plan was made; between two instants of a plan the jerk is constant."""
    last = len(trajectory.offset_s) - 2
    node = min(max(int(np.searchsorted(trajectory.offset_s, offset_s, side="right")) - 1, 0), last)
    start_s, end_s = trajectory.offset_s[node : node + 2].tolist()
    position, velocity = trajectory.position_enu_m[node], trajectory.velocity_enu_m_s[node]
    acceleration = trajectory.acceleration_enu_m_s2[node]
    jerk = (trajectory.acceleration_enu_m_s2[node + 1] - acceleration) / (end_s - start_s)
    t_s = offset_s - start_s
    return ReferenceState(
        position_enu_m=position + (velocity + (acceleration / 2.0 + jerk * t_s / 6.0) * t_s) * t_s,
        velocity_enu_m_s=velocity + (acceleration + jerk * t_s / 2.0) * t_s,
        acceleration_enu_m_s2=acceleration + jerk * t_s,
    )


def setpoint_at(
    reference: ReferenceState, correction_enu_m: Array, t_ns: int, yaw_rad: float, *, position_only: bool
) -> Setpoint:
    """Return the setpoint that asks for `reference`, corrected, at `t_ns`."""
    px, py, pz = (reference.position_enu_m + correction_enu_m).tolist()
    vx, vy, vz = reference.velocity_enu_m_s.tolist()
    ax, ay, az = reference.acceleration_enu_m_s2.tolist()
    return Setpoint(
        t_ns=t_ns,
        position_enu_m=(px, py, pz),
        velocity_enu_m_s=None if position_only else (vx, vy, vz),
        acceleration_enu_m_s2=None if position_only else (ax, ay, az),
        yaw_rad=yaw_rad,
    )


def free_place(setpoint: Setpoint, behind_enu_m: Array, gain_hz: float) -> Setpoint:
    """Return the setpoint with a free place: what the drone is off its place is made up for by the velocity asked for.

    Args:
        setpoint: with a velocity.
        behind_enu_m: (3,) from the drone to where it was asked to be.
        gain_hz: velocity per distance.
    """
    if setpoint.velocity_enu_m_s is None:
        return setpoint
    (vx, vy, vz), (x_m, y_m, _) = setpoint.velocity_enu_m_s, behind_enu_m.tolist()
    gain_hz *= _CAUGHT_UP_MAX_M / max(math.hypot(x_m, y_m), _CAUGHT_UP_MAX_M)
    return replace(setpoint, velocity_enu_m_s=(vx + gain_hz * x_m, vy + gain_hz * y_m, vz), is_place_free=True)
