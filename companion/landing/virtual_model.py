"""The virtual model that the setpoints follow: its history, and how the drone deviates from it.

The deviation is estimated by the model of the autopilot (`autopilots.response`) from the drone's reports, each beside
the virtual model at the same instant. The plan then leads the virtual model to where the drone meets the pad.
"""

import math

import numpy as np
from msgspec import Struct, field

from companion.autopilots.response import STATES, ResponseModel
from companion.core.data import GRAVITY_M_S2, Array, OwnState, Setpoint
from companion.planning.guidance import ReferenceState, Trajectory
from link.frames.rotations import rotate
from link.records import replace

_HISTORY_S = 0.6  # longer than any telemetry is late
_UPRIGHT_MIN = 0.5  # cosine of a tilt beyond which nothing is steady
_AIR_MEAN_S = 1.0  # longer than a gust's beginning, shorter than a change of speed
_BRAKING_M_S2 = 1.0  # of a drone whose setpoints have stayed away: ArduPilot's WPNAV_ACCEL_Z by default
_CAUGHT_UP_MAX_M = 1.0  # made up for by velocity at a time; more would be a chase
_BREAK_S = 0.25  # between two reports, after which the deviation is what the next one shows
_ACCELERATION_MAX_M_S2 = 10.0  # of the model between two steps: it is set back at times, and that is no motion


class Tracking(Struct, frozen=True, kw_only=True, eq=False):
    """The model's recent past and the drone beside it.

    Attributes:
        past: (monotonic ns, position (3,), velocity (3,) in W), oldest first.
        behind_enu_m: (3,) from the drone to the model at the time of the drone's newest report.
        error_m: length of that.
        deviation: (4, 2) horizontal state of `ResponseModel` then: from the model to the drone, and what moves it.
        air_enu_m_s2: (2,) horizontal thrust by mass that holds against the air, a mean of the last second.
        velocity_enu_m_s: (2,) horizontal velocity of the drone then.
        compared_ns: monotonic time of the newest report that was compared; None before the first.
    """

    past: tuple[tuple[int, Array, Array], ...] = ()
    behind_enu_m: Array = field(default_factory=lambda: np.zeros(3))
    error_m: float = 0.0
    deviation: Array = field(default_factory=lambda: np.zeros((STATES, 2)))
    air_enu_m_s2: Array = field(default_factory=lambda: np.zeros(2))
    velocity_enu_m_s: Array = field(default_factory=lambda: np.zeros(2))
    compared_ns: int | None = None


def add_to_past(tracking: Tracking, t_ns: int, reference: ReferenceState) -> Tracking:
    """Return the tracking with the model at the monotonic `t_ns` added."""
    past = tracking.past
    while past and (t_ns - past[0][0]) * 1e-9 > _HISTORY_S:
        past = past[1:]
    while past and past[-1][0] >= t_ns:  # a step that is made anew at the same time takes its place
        past = past[:-1]
    return replace(tracking, past=(*past, (t_ns, reference.position_enu_m, reference.velocity_enu_m_s)))


def update_tracking(
    tracking: Tracking, own_ns: int, own: OwnState, response: ResponseModel | None, *, estimates: bool
) -> Tracking:
    """Return the tracking after comparing the drone's report with the model at the same instant.

    Args:
        tracking: so far.
        own_ns: monotonic time of the report.
        own: the drone's newest report.
        response: of the autopilot.
        estimates: whether the drone flies freely after the model's place, so that its deviation is the autopilot's.
    """
    before_ns = tracking.compared_ns
    if before_ns is not None and own_ns <= before_ns:
        return tracking
    if len(tracking.past) < 2 or own_ns < tracking.past[0][0]:
        return tracking
    position, velocity, acceleration = _model_at(tracking, own_ns)
    behind = position - np.array(own.position_enu_m)
    since_s = math.inf if before_ns is None else (own_ns - before_ns) * 1e-9
    tracking = replace(
        tracking,
        behind_enu_m=behind,
        error_m=math.hypot(*behind.tolist()),
        compared_ns=own_ns,
        air_enu_m_s2=_update_air(tracking, own, since_s),
        velocity_enu_m_s=np.array(own.velocity_enu_m_s[:2]),
    )
    if not estimates or response is None:
        return replace(tracking, deviation=np.zeros((STATES, 2)))
    measured = np.array([-behind[:2], np.array(own.velocity_enu_m_s[:2]) - velocity[:2]])
    if since_s > _BREAK_S:
        return replace(tracking, deviation=np.vstack((measured, np.zeros((STATES - 2, 2)))))
    return replace(tracking, deviation=response.update(tracking.deviation, measured, acceleration[:2], since_s))


def tracking_error_max_m(
    reference: ReferenceState | None, response: ResponseModel | None, delay_std_s: float, stds_max: float
) -> float:
    """Return how far from its setpoint a drone may be that follows it.

    Args:
        reference: the virtual model, None while nothing is flown.
        response: of the autopilot, None while none is connected.
        delay_std_s: standard deviation of the link's delay.
        stds_max: so many standard deviations of what gusts and the link do.
    """
    if response is None:
        return math.inf
    speed_m_s = 0.0 if reference is None else math.hypot(*reference.velocity_enu_m_s.tolist())
    return stds_max * math.hypot(math.sqrt(response.spread[0, 0]), speed_m_s * delay_std_s)


def _update_air(tracking: Tracking, own: OwnState, since_s: float) -> Array:
    """Return the mean of what the drone leans beyond what accelerates it, by the change of its own velocity."""
    x, y, up = rotate(own.orientation_wxyz, (0.0, 0.0, 1.0))
    if up < _UPRIGHT_MIN or not 0.0 < since_s < _BREAK_S:
        return tracking.air_enu_m_s2
    changed = (np.array(own.velocity_enu_m_s[:2]) - tracking.velocity_enu_m_s) / since_s
    leans = np.array([x, y]) * (GRAVITY_M_S2 / up) - changed
    return np.asarray(tracking.air_enu_m_s2 - math.expm1(-since_s / _AIR_MEAN_S) * (leans - tracking.air_enu_m_s2))


def _model_at(tracking: Tracking, t_ns: int) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration (3,) of the model at `t_ns`; after its newest place that one's."""
    past = tracking.past
    later = next((index for index in range(len(past) - 1, 0, -1) if past[index - 1][0] <= t_ns), 1)
    (start_ns, start, start_velocity), (end_ns, end, end_velocity) = past[later - 1], past[later]
    between_s = (end_ns - start_ns) * 1e-9
    share = min(max((t_ns - start_ns) / (end_ns - start_ns), 0.0), 1.0)
    acceleration = ((end_velocity - start_velocity) / between_s).clip(-_ACCELERATION_MAX_M_S2, _ACCELERATION_MAX_M_S2)
    return start + share * (end - start), start_velocity + share * (end_velocity - start_velocity), acceleration


def predict_deviation(tracking: Tracking, response: ResponseModel, late_s: float, planned: Array) -> Array:
    """Return how far the drone will be off the model, (n, 2, 2): at the response's offsets, position and velocity.

    Args:
        tracking: with the deviation at the time of the newest report.
        response: of the autopilot.
        late_s: since that report.
        planned: (n, 2) accelerations of the model at the offsets.
    """
    now = response.carry(tracking.deviation, min(late_s, _BREAK_S))
    return response.predict(now, planned)[:, :2]


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

    Its acceleration upwards is at least such that the drone, which then brakes, ends above `lowest_enu_m`: ArduCopter
    was flown into the road at 1.6 m/s from a chase whose companion had died. The rate w at the end of the time T obeys
    `h + (v + w) T / 2 - w^2 / 2A >= 0` with the height h, the rate v and the braking A.
    """
    if duration_s <= 0.0:
        return reference
    above_m = float(reference.position_enu_m[2]) - lowest_enu_m
    ax, ay, az = reference.acceleration_enu_m_s2.tolist()
    climb_m_s, room_m = float(reference.velocity_enu_m_s[2]), 2.0 * above_m
    room_m += climb_m_s * duration_s
    if room_m >= 0.0:
        brakes_m_s = _BRAKING_M_S2 * duration_s
        end_m_s = 0.5 * (brakes_m_s - math.sqrt(brakes_m_s**2 + 4.0 * _BRAKING_M_S2 * room_m))
    else:
        end_m_s = -room_m / duration_s
    least_m_s2 = (end_m_s - climb_m_s) / duration_s
    if az >= least_m_s2:
        return reference
    return replace(reference, acceleration_enu_m_s2=np.array([ax, ay, least_m_s2]))


def keep_up(
    planned: ReferenceState, before: ReferenceState, lowest_enu_m: float, duration_s: float, period_s: float
) -> ReferenceState:
    """Return the planned next state, kept up by `limit_sink`, so that it may be carried on for `duration_s`.

    The model itself is kept up, for the drone follows what is sent, and the next plan begins there.

    Args:
        planned: the model `period_s` after `before`.
        before: the model now.
        lowest_enu_m: where it is to end above.
        duration_s: for which a setpoint is carried on.
        period_s: of control.
    """
    limited = limit_sink(planned, lowest_enu_m, duration_s)
    if limited is planned:
        return planned
    up = extrapolate(replace(before, acceleration_enu_m_s2=limited.acceleration_enu_m_s2), period_s)
    kept_up = ReferenceState(
        position_enu_m=np.array([*planned.position_enu_m[:2], up.position_enu_m[2]]),
        velocity_enu_m_s=np.array([*planned.velocity_enu_m_s[:2], up.velocity_enu_m_s[2]]),
        acceleration_enu_m_s2=limited.acceleration_enu_m_s2,
    )
    return limit_sink(kept_up, lowest_enu_m, duration_s)


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


def setpoint_at(reference: ReferenceState, t_ns: int, yaw_rad: float, *, position_only: bool) -> Setpoint:
    """Return the setpoint that asks for `reference` at `t_ns`."""
    px, py, pz = reference.position_enu_m.tolist()
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
