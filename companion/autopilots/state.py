"""The autopilot's messages folded into what the companion's step wants to know of it."""

from collections.abc import Mapping
from math import isfinite
from types import MappingProxyType

from msgspec import Struct, field

from companion.autopilots.driver import NO_AUTOPILOT, AutopilotView, Driver
from companion.autopilots.frame_moves import after_origin, has_stepped_with
from companion.autopilots.geoid import Geoid, hear_geoid
from companion.autopilots.heartbeat import with_heartbeat, with_landed_state, with_mode
from companion.autopilots.own_reports import (
    HISTORY_NS,
    carry,
    is_plausible,
    velocity_bias,
    with_report,
    without_bias,
)
from companion.autopilots.sensor_reports import (
    above_ellipsoid,
    is_same,
    origin_above_sea,
    with_fix,
    with_sensor,
)
from companion.core.data import OwnState
from link.frames.geodesy import Datum, LocalFrame, Projection
from link.frames.rotations import enu_from_ned, flu_from_frd, normalized, quaternion_enu_flu_from_ned_frd
from link.mavlink.clock_map import ClockMap
from link.mavlink.dialect import Message
from link.messages import Quaternion, Vector3
from link.program.text import printable
from link.records import replace

_LATE_MAX_MS = HISTORY_NS // 1_000_000  # what is older says that the clock was set back
_TEXTS_MAX = 50  # that wait; each is a line of the log, which has room for some beside the companion's own
_AHEAD_NS = 100_000_000  # how far a report is carried beyond the newest one


class AutopilotState(Struct, frozen=True, kw_only=True):
    """What the messages so far have told.

    Attributes:
        view: for the step.
        history: the drone's states of the last second, oldest first.
        orientation_wxyz: q_WB of the newest attitude.
        angular_velocity_flu_rad_s: with it.
        attitude_boot_ms: when that was, on the autopilot's clock.
        origin_msl: the origin with its altitude above mean sea level, as it is sent.
        origin_doubted_msl: another one, told once; a single message may be anybody's.
        doubted_ns: of the drone's newest report then; with its origin it steps in the next.
        geoid: what the autopilot's receiver has told of it.
        parameters: those read, by name.
        texts: what it said and nobody has taken yet.
    """

    view: AutopilotView = NO_AUTOPILOT
    history: tuple[OwnState, ...] = ()
    orientation_wxyz: Quaternion | None = None
    angular_velocity_flu_rad_s: Vector3 = (0.0, 0.0, 0.0)
    attitude_boot_ms: int = 0
    origin_msl: Datum | None = None
    origin_doubted_msl: Datum | None = None
    doubted_ns: int = 0
    geoid: Geoid = Geoid()
    parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    texts: tuple[str, ...] = ()

    @property
    def own(self) -> OwnState | None:
        """The newest state of the drone."""
        return self.history[-1] if self.history else None

    @property
    def places_drone(self) -> bool:
        """Whether the autopilot is heard and tells all that places the drone."""
        return (
            self.view.link_up and self.view.frame is not None and self.view.receiver.knows_geoid and bool(self.history)
        )

    def own_at(self, t_ns: int) -> OwnState | None:
        """The state at `t_ns`: the nearest report carried there by its own rates; None beyond what they span."""
        if not self.history or t_ns < self.history[0].t_ns or t_ns > self.history[-1].t_ns + _AHEAD_NS:
            return None
        return carry(min(self.history, key=lambda own: abs(own.t_ns - t_ns)), t_ns)


def update_state(state: AutopilotState, message: Message, clock: ClockMap, driver: Driver) -> AutopilotState:
    """Return the state after `message` of the autopilot; unknown and unusable messages change nothing."""
    match message.get_type():
        case "LOCAL_POSITION_NED":
            state = _position(state, message, clock)
        case "ATTITUDE_QUATERNION":
            state = _attitude(state, message)
        case "HEARTBEAT":
            state = replace(state, view=with_heartbeat(state.view, message, driver))
        case "CURRENT_MODE":
            state = replace(state, view=with_mode(state.view, message, driver))
        case "EXTENDED_SYS_STATE":
            state = replace(state, view=with_landed_state(state.view, message))
        case "GPS_GLOBAL_ORIGIN":
            state = _place_origin(_hear_origin(state, origin_above_sea(message)), driver.projection)
        case "GPS_RAW_INT":
            view = replace(state.view, receiver=with_fix(state.view.receiver, message))
            state = _place_origin(_hear_geoid(replace(state, view=view), message), driver.projection)
        case "DISTANCE_SENSOR" | "BATTERY_STATUS":
            state = replace(state, view=with_sensor(state.view, message, clock, state.own_at))
        case "STATUSTEXT" | "EVENT":
            state = _said(state, message, driver)
    return state


def shift_reports(state: AutopilotState, by_ns: int) -> AutopilotState:
    """Return the state with the times of all reports put off by `by_ns`, for a UTC that was set by as much."""
    history = tuple(replace(own, t_ns=own.t_ns + by_ns) for own in state.history)
    seen, moves = state.view.range_down, state.view.frame_moves
    seen = None if seen is None else replace(seen, t_ns=seen.t_ns + by_ns)
    moves = replace(moves, stepped_ns=moves.stepped_ns + by_ns) if moves.stepped_ns else moves
    view = replace(state.view, range_down=seen, frame_moves=moves)
    return replace(state, history=history, view=view, doubted_ns=state.doubted_ns + by_ns)


def _said(state: AutopilotState, message: Message, driver: Driver) -> AutopilotState:
    """Take a text, or an event in words."""
    refusal = driver.refusal(message)
    if refusal is not None and not state.view.armed:
        state = replace(state, view=replace(state.view, refusal=printable(refusal)))
    text = refusal if message.get_type() == "EVENT" else f"{message.text}"
    return state if text is None else replace(state, texts=(*state.texts[1 - _TEXTS_MAX :], printable(text)))


def _position(state: AutopilotState, message: Message, clock: ClockMap) -> AutopilotState:
    t_ns = clock.boot_to_utc_ns(message.time_boot_ms * 1_000_000)
    values = (message.x, message.y, message.z, message.vx, message.vy, message.vz)
    if t_ns is None or not message.time_boot_ms or state.orientation_wxyz is None:
        return state
    if not is_plausible(values[:3], values[3:]):
        return state
    position, reported = enu_from_ned(values[:3]), enu_from_ned(values[3:])
    bias = velocity_bias(state.own, t_ns, position, reported)
    own = OwnState(
        t_ns=t_ns,
        position_enu_m=position,
        velocity_enu_m_s=without_bias(reported, bias),
        velocity_bias_enu_m_s=bias,
        orientation_wxyz=state.orientation_wxyz,
        angular_velocity_flu_rad_s=state.angular_velocity_flu_rad_s,
        attitude_age_s=max(0.0, (message.time_boot_ms - state.attitude_boot_ms) * 1e-3),
    )
    if state.history and t_ns <= state.history[-1].t_ns:
        if state.history[-1].t_ns - t_ns <= HISTORY_NS:
            return state
        state = replace(state, history=())  # not late: the clock was set back
    return _add_report(state, own)


def _add_report(state: AutopilotState, own: OwnState) -> AutopilotState:
    """Add the drone's newest report to the history; with one that flying cannot explain the local frame has moved."""
    history, moves = with_report(state.history, own, state.view.frame_moves)
    state = replace(state, history=history)
    if moves is state.view.frame_moves:
        return state
    seen = None if state.view.range_down is None else replace(state.view.range_down, own=None)
    state = replace(state, view=replace(state.view, frame_moves=moves, range_down=seen))
    doubted, frame = state.origin_doubted_msl, state.view.frame
    if doubted is None or frame is None or not _has_stepped_along(state, doubted):
        return state
    return _place_origin(replace(state, origin_msl=doubted, origin_doubted_msl=None), frame.projection)


def _attitude(state: AutopilotState, message: Message) -> AutopilotState:
    q = (message.q1, message.q2, message.q3, message.q4)
    rates = (message.rollspeed, message.pitchspeed, message.yawspeed)
    if not all(map(isfinite, (*q, *rates))) or sum(part * part for part in q) < 0.5:
        return state
    if 0 <= state.attitude_boot_ms - message.time_boot_ms <= _LATE_MAX_MS or not message.time_boot_ms:
        return state  # a newer one has come already, or nobody knows when it was
    return replace(
        state,
        orientation_wxyz=normalized(quaternion_enu_flu_from_ned_frd(q)),
        angular_velocity_flu_rad_s=flu_from_frd(rates),
        attitude_boot_ms=message.time_boot_ms,
    )


def has_frame_moved(before: AutopilotState, state: AutopilotState) -> bool:
    """Return whether the local frame has stepped, or what is known of its origin has changed."""
    has_stepped = state.view.frame_moves.shift_enu_m != before.view.frame_moves.shift_enu_m
    return has_stepped or state.origin_doubted_msl != before.origin_doubted_msl


def _hear_origin(state: AutopilotState, told: Datum | None) -> AutopilotState:
    """Take the first origin, and another one that the drone has stepped with, which no single message can feign.

    Any other is taken once it is told again after the drone has told its place in between.
    """
    known, doubted, newest_ns = state.origin_msl, state.origin_doubted_msl, state.own.t_ns if state.own else 0
    if told is None:
        return state
    if known is not None and is_same(told, known):
        return replace(state, origin_doubted_msl=None)
    is_told_again = doubted is not None and is_same(told, doubted)
    is_confirmed = is_told_again and (newest_ns != state.doubted_ns or not newest_ns)
    if known is None or is_confirmed or _has_stepped_along(state, told):
        return replace(state, origin_msl=told, origin_doubted_msl=None)
    return state if is_told_again else replace(state, origin_doubted_msl=told, doubted_ns=newest_ns)


def _has_stepped_along(state: AutopilotState, told: Datum) -> bool:
    known, frame = state.origin_msl, state.view.frame
    if known is None or frame is None:
        return False
    return has_stepped_with(
        state.view.frame_moves, replace(frame, origin=known), LocalFrame(origin=told, projection=frame.projection)
    )


def _hear_geoid(state: AutopilotState, message: Message) -> AutopilotState:
    """Take the geoid's first height, and another one that is told twice in a row: with it the local frame moves.

    Nothing moves the geoid under a drone that flies. There a sure one is kept, unless the drone's own height has
    stepped along, as to another receiver's: by another one the pad would be metres lower than it is.
    """
    geoid, other = hear_geoid(state.geoid, message)
    if other is not None and (not (state.view.armed and geoid.is_sure) or _has_risen(state, other.above(geoid))):
        geoid = other
    return replace(state, geoid=geoid)


def _has_risen(state: AutopilotState, by_m: float) -> bool:
    origin = state.origin_msl
    return origin is not None and _has_stepped_along(state, replace(origin, altitude_m=origin.altitude_m + by_m))


def _place_origin(state: AutopilotState, projection: Projection) -> AutopilotState:
    """Put the origin above the ellipsoid; with another one the local frame has moved."""
    if state.origin_msl is None:
        return state
    origin = above_ellipsoid(state.origin_msl, state.geoid.height_m)
    known, moves = state.view.frame, state.view.frame_moves
    receiver = replace(state.view.receiver, knows_geoid=state.geoid.height_m is not None)
    if known is not None and known.projection is projection and is_same(origin, known.origin):
        return replace(state, view=replace(state.view, receiver=receiver))
    frame = LocalFrame(origin=origin, projection=projection)
    moves = after_origin(moves, known, frame)
    view = replace(state.view, frame=frame, receiver=receiver, frame_moves=moves)
    # The newest report stays, for the next one tells by how much the drone's own place steps with the origin.
    return replace(state, view=view, history=state.history[-1:])
