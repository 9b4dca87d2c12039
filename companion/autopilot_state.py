"""The autopilot's messages folded into what the companion's step wants to know of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite, radians
from types import MappingProxyType

from companion.autopilots.driver import NO_AUTOPILOT, AutopilotView, Driver
from companion.data import OwnState
from link.frames import enu_from_ned, flu_from_frd, normalized, quaternion_enu_flu_from_ned_frd
from link.geodesy import Datum
from link.mavlink.clock_map import ClockMap
from link.mavlink.dialect import Message, mavlink
from link.messages import Quaternion, Vector3

_HISTORY_NS = 1_000_000_000  # sightings of the pad arrive less late than this
_ORIGIN_MOVED_RAD = 1e-8  # 6 cm; the field's resolution is 1e-7 degrees, 1 cm
_ORIGIN_MOVED_M = 0.05
_LATITUDE_MAX_1E7 = 90 * 10**7
_LONGITUDE_MAX_1E7 = 180 * 10**7
_FAILSAFE_STATES = (mavlink.MAV_STATE_CRITICAL, mavlink.MAV_STATE_EMERGENCY)


@dataclass(frozen=True, slots=True, kw_only=True)
class AutopilotState:
    """What the messages so far have told.

    Attributes:
        view: for the step.
        history: the drone's states of the last second, oldest first.
        orientation_wxyz: q_WB of the newest attitude.
        angular_velocity_flu_rad_s: with it.
        parameters: those read, by name.
        texts: STATUSTEXT not yet taken.
    """

    view: AutopilotView = NO_AUTOPILOT
    history: tuple[OwnState, ...] = ()
    orientation_wxyz: Quaternion | None = None
    angular_velocity_flu_rad_s: Vector3 = (0.0, 0.0, 0.0)
    parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    texts: tuple[str, ...] = ()

    @property
    def own(self) -> OwnState | None:
        """The newest state of the drone."""
        return self.history[-1] if self.history else None

    def own_at(self, t_ns: int) -> OwnState | None:
        """The state nearest to `t_ns`, None when the history does not reach there."""
        if not self.history or t_ns < self.history[0].t_ns - _HISTORY_NS // 10:
            return None
        return min(self.history, key=lambda own: abs(own.t_ns - t_ns))


def heard(state: AutopilotState, message: Message, clock: ClockMap, driver: Driver) -> AutopilotState:
    """Return the state after `message` of the autopilot; unknown and unusable messages change nothing."""
    match message.get_type():
        case "LOCAL_POSITION_NED":
            state = _position(state, message, clock)
        case "ATTITUDE_QUATERNION":
            state = _attitude(state, message)
        case "HEARTBEAT":
            state = _heartbeat(state, message, driver)
        case "CURRENT_MODE":
            in_control = driver.is_in_control(mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, message.custom_mode)
            state = replace(state, view=replace(state.view, in_control=in_control))
        case "EXTENDED_SYS_STATE":
            state = replace(state, view=replace(state.view, landed=_landed(message.landed_state)))
        case "GPS_GLOBAL_ORIGIN":
            state = _origin(state, message)
        case "STATUSTEXT":
            state = replace(state, texts=(*state.texts, f"{message.text}"))
        case _:
            pass
    return state


def _position(state: AutopilotState, message: Message, clock: ClockMap) -> AutopilotState:
    t_ns = clock.boot_to_utc_ns(message.time_boot_ms * 1_000_000)
    values = (message.x, message.y, message.z, message.vx, message.vy, message.vz)
    if t_ns is None or state.orientation_wxyz is None or not all(map(isfinite, values)):
        return state
    if state.history and t_ns <= state.history[-1].t_ns:
        return state
    own = OwnState(
        t_ns=t_ns,
        position_enu_m=enu_from_ned(values[:3]),
        velocity_enu_m_s=enu_from_ned(values[3:]),
        orientation_wxyz=state.orientation_wxyz,
        angular_velocity_flu_rad_s=state.angular_velocity_flu_rad_s,
    )
    kept = tuple(old for old in state.history if t_ns - old.t_ns <= _HISTORY_NS)
    return replace(state, history=(*kept, own))


def _attitude(state: AutopilotState, message: Message) -> AutopilotState:
    q = (message.q1, message.q2, message.q3, message.q4)
    rates = (message.rollspeed, message.pitchspeed, message.yawspeed)
    if not all(map(isfinite, (*q, *rates))) or sum(part * part for part in q) < 0.5:
        return state
    orientation = normalized(quaternion_enu_flu_from_ned_frd(q))
    return replace(state, orientation_wxyz=orientation, angular_velocity_flu_rad_s=flu_from_frd(rates))


def _heartbeat(state: AutopilotState, message: Message, driver: Driver) -> AutopilotState:
    view = replace(
        state.view,
        link_up=True,
        armed=bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED),
        in_control=driver.is_in_control(message.base_mode, message.custom_mode),
        failsafe=message.system_status in _FAILSAFE_STATES,
    )
    return replace(state, view=view)


def _landed(landed_state: int) -> bool | None:
    if landed_state == mavlink.MAV_LANDED_STATE_UNDEFINED:
        return None
    return bool(landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND)


def _origin(state: AutopilotState, message: Message) -> AutopilotState:
    """Take the origin; a moved one is counted, since everything in the local frame has then moved."""
    if abs(message.latitude) > _LATITUDE_MAX_1E7 or abs(message.longitude) > _LONGITUDE_MAX_1E7:
        return state
    origin = Datum(
        latitude_rad=radians(message.latitude * 1e-7),
        longitude_rad=radians(message.longitude * 1e-7),
        altitude_m=message.altitude * 1e-3,
    )
    known = state.view.origin
    if known is not None and (
        abs(origin.latitude_rad - known.latitude_rad) < _ORIGIN_MOVED_RAD
        and abs(origin.longitude_rad - known.longitude_rad) < _ORIGIN_MOVED_RAD
        and abs(origin.altitude_m - known.altitude_m) < _ORIGIN_MOVED_M
    ):
        return state
    view = replace(state.view, origin=origin, origin_count=state.view.origin_count + 1)
    return replace(state, view=view, history=())
