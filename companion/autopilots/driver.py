"""What every autopilot driver offers: reading its mode, getting it to follow setpoints, arming, disarming.

A driver is pure: it turns what the companion wants and what the autopilot says into commands to send.
"""

from collections.abc import Mapping
from typing import Protocol

from msgspec import Struct

from companion.autopilots.frame_moves import NO_MOVES, FrameMoves
from companion.autopilots.response import Cascade, Shaping
from companion.core.data import FlightLimits, RangeReading, Setpoint
from link.frames.geodesy import LocalFrame, Projection
from link.mavlink.dialect import Message, mavlink
from link.mavlink.peer import LOST_AFTER_NS
from link.mavlink.requests import ONCE, Retries


class Receiver(Struct, frozen=True, kw_only=True):
    """What the drone's receiver tells."""

    has_fix: bool | None = None  # of three dimensions; None where nobody tells, or there is no receiver
    is_fixed: bool = False  # its carrier phases, so that it is right to centimetres
    fix_told: int | None = None  # GPS_FIX_TYPE of the last report; what it says of both counts when it is told again
    knows_geoid: bool = False  # without it the height of the frame's origin is one above the sea


class AutopilotView(Struct, frozen=True, kw_only=True):
    """The autopilot as its messages tell; None where it has not said yet."""

    link_up: bool
    armed: bool
    in_control: bool  # it is in the mode in which it follows the companion's setpoints
    failsafe: bool  # in which it flies by itself
    mode: int | None = None  # by its own number
    mode_told: bool = False  # since an order for another one was accepted
    disarm_told: bool = False  # by the last heartbeat, or an order that was accepted: it counts with the next one
    killed: bool = False  # its motors are kept still, armed or not, by a switch or a termination: they may turn again
    warns: bool = False  # it reports a failsafe, and follows the setpoints on
    overruled: bool = False  # by a failsafe: another mode than was last asked for is flown
    restarted: bool = False  # and not in control since
    is_id_shared: bool = False  # another autopilot answers under its system id, and obeys its commands
    landed: bool | None = None
    taking_off: bool = False  # by itself, after a command
    refusal: str | None = None  # what it last said against arming
    frame: LocalFrame | None = None  # W; its origin above the ellipsoid
    receiver: Receiver = Receiver()
    frame_moves: FrameMoves = NO_MOVES
    range_down: RangeReading | None = None
    battery_share: float | None = None  # left, 0 to 1: the larger of the last two that were told
    battery_told: float | None = None  # the last


NO_AUTOPILOT = AutopilotView(link_up=False, armed=False, in_control=False, failsafe=False)


class Desire(Struct, frozen=True, kw_only=True):
    """What the companion wants of the autopilot; None leaves it as it is.

    Attributes:
        control: follow the setpoints.
        armed: motors on or off.
        force_disarm: the evidence of a touchdown is complete, so a refused disarm may be forced.
        release: leave the companion's control into a hover of its own.
        takeoff_height_m: be in the air; how far above its home an autopilot climbs that does so by itself.
        leaves_deck: follow setpoints as soon as it is in the air, for its own climb would stand still over ground.
    """

    control: bool | None = None
    armed: bool | None = None
    force_disarm: bool = False
    release: bool = False
    takeoff_height_m: float | None = None
    leaves_deck: bool = False


class AutopilotCommand(Struct, frozen=True, kw_only=True):
    """A COMMAND_LONG to be sent and acknowledged."""

    command: int
    parameters: tuple[float, float, float, float, float, float, float]
    retries: Retries = ONCE


class DriverMemory(Struct, frozen=True, kw_only=True):
    """When the driver last asked for what, and what was refused.

    While the autopilot `climbs_by_itself` it is sent no setpoints. Once it has accepted to arm it is not asked again: a
    person, or the autopilot itself, stops the motors then. Nor is it asked again for a mode that it has accepted.
    """

    streaming_since_ns: int | None = None
    asked_ns: Mapping[AutopilotCommand, int] | None = None
    disarm_asked: bool = False
    disarm_refusals: int = 0
    control_asked_ns: int | None = None  # monotonic, the newest order of the companion's mode; None while none counts
    control_accepted: bool = False  # and not refused since
    arm_asked: bool = False
    arm_accepted: bool = False  # and not refused since
    takeoff_accepted: bool = False  # the last one that was asked for
    climbs_by_itself: bool = False


STREAMS_HZ = {
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 10.0,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 2.0,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 1.0,  # tells the geoid's height
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: 1.0,
    mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 20.0,
}
"""Messages that are read of every autopilot beside its motion, by id."""


_MOTION_IDS = (
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED,
)


class Driver(Protocol):
    """One kind of autopilot."""

    @property
    def name(self) -> str:
        """What users call it."""

    @property
    def autopilot_id(self) -> int:
        """MAV_AUTOPILOT of its heartbeat."""

    @property
    def projection(self) -> Projection:
        """How it lays its local frame out."""

    @property
    def limit_names(self) -> tuple[tuple[str, ...], ...]:
        """Parameters that bound the flight, each by all of its names."""

    @property
    def gain_names(self) -> tuple[tuple[str, ...], ...]:
        """Parameters that `cascade` goes by, each by all of its names."""

    @property
    def hover_mode(self) -> str:
        """The mode into which it is released, as its pilots call it."""

    @property
    def timeout_parameter(self) -> str:
        """Parameter that says for how many seconds without a setpoint it still waits for one."""

    @property
    def timeout_default_s(self) -> float:
        """What that is taken for while it is unknown."""

    @property
    def waits_in_mode(self) -> bool:
        """Whether silence only stops it, and it stays in the mode that follows setpoints."""

    @property
    def takes_target_in_body_axes(self) -> bool:
        """Whether its precision landing takes the way to the pad in the drone's axes, no place in the local frame."""

    @property
    def follows_in_failsafe(self) -> bool:
        """Whether it may report a failsafe and follow setpoints on: that a mode is flown by one is told by the mode."""

    @property
    def speed_parameters(self) -> tuple[str, ...]:
        """Those among them that bound the horizontal speed, for messages."""

    @property
    def mode_streams_hz(self) -> Mapping[int, float]:
        """Messages that tell its mode promptly, by id."""

    @property
    def unused_streams(self) -> tuple[int, ...]:
        """Messages that it sends unasked on a companion's link and that the companion does not read."""

    def is_in_control(self, base_mode: int, custom_mode: int) -> bool:
        """Return whether these heartbeat fields mean that it follows setpoints."""

    def refusal(self, message: Message) -> str | None:
        """Return what `message` says against arming, in words; None when it says nothing of the kind."""

    def act(
        self, memory: DriverMemory, view: AutopilotView, desire: Desire, monotonic_ns: int
    ) -> tuple[DriverMemory, tuple[AutopilotCommand, ...]]:
        """Return the commands that bring the autopilot nearer to `desire`, none while an earlier one is pending."""

    def acknowledged(self, memory: DriverMemory, command: int, result: int) -> DriverMemory:
        """Return the memory after the autopilot answered `command` with MAV_RESULT `result`."""

    def setpoint_message(self, setpoint: Setpoint, boot_ms: int, target_system: int) -> Message:
        """Return the MAVLink message for `setpoint`.

        Raises:
            ValueError: a value of the setpoint is not finite.
        """

    def flies_to(self, sent: Message, told: Message) -> bool:
        """Return whether `told`, its POSITION_TARGET_LOCAL_NED, shows that it flies to the setpoint `sent`."""

    def limits(self, wanted: FlightLimits, parameters: Mapping[str, float]) -> FlightLimits:
        """Return `wanted` cut to what the autopilot's own parameters allow."""

    def cascade(self, parameters: Mapping[str, float]) -> Cascade:
        """Return the gains with which it follows setpoints, and how it takes them, from its own parameters."""

    def shaping(self, parameters: Mapping[str, float]) -> Shaping | None:
        """Return how it carries setpoints on, from its own parameters; None if it holds them as they came."""


_WAITED_SHARE = 0.9  # of the autopilot's time-out; the rest is for the way there and back
_WAITED_MIN_S = 0.5  # a shorter time-out cannot be told from a late message


def gives_up_after_s(driver: Driver, timeout_s: float) -> float:
    """Return for how long nothing may be heard of an autopilot until it may have given up on setpoints.

    One that waits in the mode that follows them does not give up; it is out of touch when its link is lost.
    """
    return LOST_AFTER_NS * 1e-9 if driver.waits_in_mode else max(_WAITED_SHARE * timeout_s, _WAITED_MIN_S)


def streams_hz(driver: Driver, motion_rate_hz: float, *, stops_unused: bool) -> dict[int, float]:
    """Return the rate at which each message is asked for, 0 for one that is to be stopped."""
    motion_hz = dict.fromkeys(_MOTION_IDS, motion_rate_hz)
    unused_hz = dict.fromkeys(driver.unused_streams if stops_unused else (), 0.0)
    return motion_hz | STREAMS_HZ | dict(driver.mode_streams_hz) | unused_hz
