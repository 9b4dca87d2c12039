"""The virtual model that the setpoints follow: its history, and how the drone deviates from it.

The deviation is estimated by the model of the autopilot (`autopilots.response`) from the drone's reports, each beside
the virtual model at the same instant. The plan then leads the virtual model to where the drone meets the pad.
"""

import math
from functools import lru_cache

import numpy as np
from msgspec import Struct, field

from companion.autopilots.response import STATES, Cascade, ResponseModel
from companion.core.data import GRAVITY_M_S2, STEP_MAX_S, Array, OwnState, Setpoint
from companion.landing.steering.losing import Losses
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.planning.guidance import ReferenceState
from link.frames.rotations import rotate
from link.records import replace

_HISTORY_S = 1.0  # longer than any telemetry is late and any setpoint is ahead
UPRIGHT_MIN = 0.5  # cosine of a tilt beyond which nothing is steady
_AIR_MEAN_S = 1.0  # longer than a gust's beginning, shorter than a change of speed
_HOLDS_MEAN_S = 0.1  # of five reports, shorter than a position controller's swing
_RIDE_MEAN_S = 0.5  # as the last quarter of a metre takes before it may touch
_RIDE_MAX_M = 0.15  # a lag of 0.3 s while it sinks at 0.5 m/s: what is more does not last
BREAK_S = 0.25  # between two reports, after which the deviation is what the next one shows
_ACCELERATION_MAX_M_S2 = 10.0  # of the model between two steps: it is set back at times, and that is no motion


class Tracking(Struct, frozen=True, kw_only=True, eq=False):
    """The model's recent past and the drone beside it.

    Attributes:
        past: the model at monotonic times in ns, oldest first, up to where the newest setpoint leads.
        error_m: from the drone to the model at the time of its newest report.
        losses: the reports at which the model was put at the drone (`steering.regain`); None before.
        deviation: (4, 2) horizontal state of `ResponseModel` then: from the model to the drone, and what moves it.
        air_enu_m_s2: (2,) horizontal thrust by mass that holds against the air, a mean of the last second.
        holds_enu_m_s2: (2,) the same by the lean alone, as of a drone that keeps its climb, beyond what the model
            accelerates by, a mean of the last tenth of a second: this, and what makes up for the deviation.
        velocity_enu_m_s: (3,) velocity of the drone then.
        compared_ns: monotonic time of the newest report that was compared; None before the first.
    """

    past: tuple[tuple[int, ReferenceState], ...] = ()
    error_m: float = 0.0
    losses: Losses | None = None
    deviation: Array = field(default_factory=lambda: np.zeros((STATES, 2)))
    air_enu_m_s2: Array = field(default_factory=lambda: np.zeros(2))
    holds_enu_m_s2: Array = field(default_factory=lambda: np.zeros(2))
    velocity_enu_m_s: Array = field(default_factory=lambda: np.zeros(3))
    compared_ns: int | None = None


def add_to_past(tracking: Tracking, t_ns: int, reference: ReferenceState) -> Tracking:
    """Return the tracking with the model at the monotonic `t_ns` added."""
    past = tracking.past
    while past and (t_ns - past[0][0]) * 1e-9 > _HISTORY_S:
        past = past[1:]
    while past and past[-1][0] >= t_ns:  # a step that is rebuilt at the same time takes its place
        past = past[:-1]
    return replace(tracking, past=(*past, (t_ns, reference)))


def move_tracking(tracking: Tracking, by_enu_m: Array) -> Tracking:
    """Return the tracking in a frame in which all places are moved by (3,)."""
    moved = tuple(
        (t_ns, replace(state, position_enu_m=state.position_enu_m + by_enu_m)) for t_ns, state in tracking.past
    )
    return replace(tracking, past=moved)


def state_then(tracking: Tracking, t_ns: int) -> ReferenceState:
    """Return the model at the monotonic `t_ns`, between the oldest and the newest state that were added."""
    if len(tracking.past) == 1:
        return tracking.past[0][1]
    (_, start), (_, end), share = _around(tracking, t_ns)
    accelerates = end.acceleration_enu_m_s2 - start.acceleration_enu_m_s2
    return ReferenceState(
        position_enu_m=start.position_enu_m + share * (end.position_enu_m - start.position_enu_m),
        velocity_enu_m_s=start.velocity_enu_m_s + share * (end.velocity_enu_m_s - start.velocity_enu_m_s),
        acceleration_enu_m_s2=start.acceleration_enu_m_s2 + share * accelerates,
    )


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
    air_enu_m_s2, holds_enu_m_s2 = _update_leans(tracking, own, own_ns, since_s, response)
    tracking = replace(
        tracking,
        error_m=math.hypot(*behind.tolist()),
        compared_ns=own_ns,
        air_enu_m_s2=air_enu_m_s2,
        holds_enu_m_s2=holds_enu_m_s2,
        velocity_enu_m_s=np.array(own.velocity_enu_m_s),
    )
    if not estimates or response is None:
        return replace(tracking, deviation=np.zeros((STATES, 2)))
    measured = np.array([-behind[:2], np.array(own.velocity_enu_m_s[:2]) - velocity[:2]])
    if since_s > BREAK_S:
        return replace(tracking, deviation=np.vstack((measured, np.zeros((STATES - 2, 2)))))
    return replace(tracking, deviation=response.update(tracking.deviation, measured, acceleration[:2], since_s))


class Ride(Struct, frozen=True, kw_only=True):
    """How the drone flies on its setpoints: always a little above or below them, by lags and by wind.

    Attributes:
        above_m: the drone's lowest foot above that of a level one on the model, a mean of the last half second in which
            it could touch nothing.
        t_ns: monotonic, of the newest comparison.
    """

    above_m: float = 0.0
    t_ns: int | None = None


NO_RIDE = Ride()


def update_ride(ride: Ride, t_ns: int, above_m: float, foot_below_m: float) -> Ride:
    """Return the ride after a comparison at the monotonic `t_ns`; the first is all that is known.

    Args:
        ride: so far.
        t_ns: monotonic.
        above_m: the drone above the model.
        foot_below_m: its lowest foot below those of a level drone.
    """
    above_m = min(max(above_m, -_RIDE_MAX_M), _RIDE_MAX_M) - foot_below_m
    if ride.t_ns is None:
        return Ride(above_m=above_m, t_ns=t_ns)
    share = -math.expm1(-min((t_ns - ride.t_ns) * 1e-9, STEP_MAX_S) / _RIDE_MEAN_S)
    return Ride(above_m=ride.above_m + share * (above_m - ride.above_m), t_ns=t_ns)


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


def _update_leans(
    tracking: Tracking, own: OwnState, own_ns: int, since_s: float, response: ResponseModel | None
) -> tuple[Array, Array]:
    """Return the means of the thrust across beyond what accelerates the drone, and of the lean beyond the model's.

    The first is by the change of its own velocity: a drone that speeds up as it sinks leans more for the same thrust
    across. The second is by the model when the autopilot was to lean as now; a change of velocity would be as noisy as
    its mean is short.
    """
    air, holds = tracking.air_enu_m_s2, tracking.holds_enu_m_s2
    x, y, up = rotate(own.orientation_wxyz, (0.0, 0.0, 1.0))
    if up < UPRIGHT_MIN or not 0.0 < since_s < BREAK_S:
        return air, holds
    leans = np.array([x, y]) * (GRAVITY_M_S2 / up)
    changed = (np.array(own.velocity_enu_m_s) - tracking.velocity_enu_m_s) / since_s
    across = leans * (1.0 + float(changed[2]) / GRAVITY_M_S2)
    lag_s = 0.0 if response is None else response.cascade.lean_lag_s
    _, _, asked = _model_at(tracking, own_ns - round(lag_s * 1e9))
    air = air - math.expm1(-since_s / _AIR_MEAN_S) * (across - changed[:2] - air)
    return np.asarray(air), np.asarray(holds - math.expm1(-since_s / _HOLDS_MEAN_S) * (leans - asked[:2] - holds))


def _model_at(tracking: Tracking, t_ns: int) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration (3,) of the model at `t_ns`; after its newest place that one's."""
    (start_ns, start), (end_ns, end), share = _around(tracking, t_ns)
    moved, faster = end.position_enu_m - start.position_enu_m, end.velocity_enu_m_s - start.velocity_enu_m_s
    acceleration = (faster / ((end_ns - start_ns) * 1e-9)).clip(-_ACCELERATION_MAX_M_S2, _ACCELERATION_MAX_M_S2)
    return start.position_enu_m + share * moved, start.velocity_enu_m_s + share * faster, acceleration


def _around(tracking: Tracking, t_ns: int) -> tuple[tuple[int, ReferenceState], tuple[int, ReferenceState], float]:
    """Return the states before and after `t_ns` with their times, and the share of the second one."""
    past = tracking.past
    later = next((index for index in range(len(past) - 1, 0, -1) if past[index - 1][0] <= t_ns), 1)
    start, end = past[later - 1], past[later]
    return start, end, min(max((t_ns - start[0]) / (end[0] - start[0]), 0.0), 1.0)


def press_down(reference: ReferenceState, acceleration_m_s2: float, duration_s: float) -> ReferenceState:
    """Return the model pressed down for `duration_s`, so that the thrust drops and the gear holds on to the pad."""
    faster_m_s = acceleration_m_s2 * duration_s
    return ReferenceState(
        position_enu_m=reference.position_enu_m - np.array([0.0, 0.0, 0.5 * faster_m_s * duration_s]),
        velocity_enu_m_s=reference.velocity_enu_m_s - np.array([0.0, 0.0, faster_m_s]),
        acceleration_enu_m_s2=np.array([*reference.acceleration_enu_m_s2[:2], -acceleration_m_s2]),
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


@lru_cache(maxsize=16)  # the gains of some landings; nothing that a link tells fills the memory
def response_to(cascade: Cascade) -> ResponseModel:
    """Return the model of a cascade; 2 ms, and the gains of an autopilot come one by one in each of many landings."""
    return ResponseModel(cascade, HORIZON_OFFSETS_S)
