"""The data in which one firmware differs from another, in groups; `interfaces.py` puts them together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from link.frames.geodesy import Projection
from link.mavlink.dialect import mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.parameters import Parameter, Values
from sim_autopilot.core.settings import FlightSettings

COMMON_CAPABILITIES = int(
    mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    | mavlink.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
)
"""MAV_PROTOCOL_CAPABILITY flags of every firmware here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """What an autopilot says of itself, its build and its board.

    Attributes:
        autopilot_id: MAV_AUTOPILOT.
        capabilities: MAV_PROTOCOL_CAPABILITY flags.
        version: flight_sw_version of AUTOPILOT_VERSION.
        custom_version: eight bytes of the commit.
        os_version: of the operating system; 0 is none.
        board_version: of the board.
        uid: the board's number; 0 is none.
        uid2: the board's longer number.
    """

    autopilot_id: int
    capabilities: int
    version: int
    custom_version: bytes = bytes(8)
    os_version: int = 0
    board_version: int = 0
    uid: int = 0
    uid2: bytes = bytes(18)


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeCode:
    """How a mode is named on the wire.

    Attributes:
        base_mode: MAV_MODE_FLAGs of the heartbeat, without the armed one.
        custom_mode: of the heartbeat.
        request: parameter 2, and 3 where it counts, of the MAV_CMD_DO_SET_MODE that asks for it.
        name: in texts.
    """

    base_mode: int
    custom_mode: int
    request: tuple[int, ...]
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeRules:
    """The modes that a firmware has, and how they are asked for.

    Attributes:
        codes: by mode.
        boot: in which it starts.
        unarmable: in which it refuses to arm.
        loiter: which MAV_CMD_NAV_LOITER_UNLIM asks for.
        of_flags: the mode that a client without custom modes asks for by its MAV_MODE_FLAGs; None denies it.
        leaves_landing: whether it goes back, when the motors stop, to the last mode asked for that lets arm.
        tells_changes: whether a change of mode sends a heartbeat at once.
        answered_twice: whether DO_SET_MODE is accepted at once, with the final answer a step later.
        set_mode_answered_as: the MAV_CMD that the COMMAND_ACK to a SET_MODE names; None answers nothing.
    """

    codes: Mapping[Mode, ModeCode]
    boot: Mode
    unarmable: frozenset[Mode]
    loiter: Mode
    of_flags: Callable[[int], Mode | None] | None
    leaves_landing: bool
    tells_changes: bool
    answered_twice: bool
    set_mode_answered_as: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Readiness:
    """When after boot things begin to work: the processor, GPS, origin and home, arming."""

    booted_s: float
    fix_s: float
    position_s: float
    arming_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Statuses:
    """MAV_STATE of the heartbeat: while booting, unarmed, armed on the ground, in the air, in a failsafe."""

    booting: int
    standby: int
    armed: int
    flying: int
    failsafe: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFlags:
    """The SYS_STATUS bit masks: sensors present, enabled, healthy.

    Attributes:
        present: the sensors that there are.
        enabled: the sensors that are used.
        health: the sensors that work from the start.
        fix_health: added with a GPS fix.
        arming_health: added once it says that it can arm, `arming_s` after boot.
        arming_s: which is not when it does.
        control: added to enabled and health while it flies by position.
    """

    present: int
    enabled: int
    health: int
    fix_health: int = 0
    arming_health: int
    arming_s: float
    control: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """What it tells of its condition.

    Attributes:
        readiness: after boot.
        statuses: of HEARTBEAT.
        sensors: of SYS_STATUS.
        fix_type: GPS_FIX_TYPE, once there is a fix.
        vtol_state: of EXTENDED_SYS_STATE.
        current_ca: that the battery tells, centiampere; None for what empties it evenly, with what it has given.
    """

    readiness: Readiness
    statuses: Statuses
    sensors: SensorFlags
    fix_type: int
    vtol_state: int
    current_ca: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRules:
    """Its parameters, and how it is asked for them.

    Attributes:
        table: in index order; what the flight does not obey is kept and answered all the same.
        settings: the flight settings that their values amount to.
        system_id: the name of the one that holds the MAVLink system.
        lenient: whether a PARAM_SET is taken whatever its type and range.
        tells_indices: whether a parameter that was asked for or set by name is answered with its index.
        banner: texts that follow a PARAM_REQUEST_LIST.
    """

    table: tuple[Parameter, ...] = field(repr=False)  # hundreds
    settings: Callable[[Values], FlightSettings]
    system_id: str
    lenient: bool
    tells_indices: bool
    banner: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """The MAV_RESULTs of refusals; a reboot is refused since the process has an operator of its own."""

    arm_refused: int
    reboot_refused: int
    disarm_in_the_air: int
    mode_refused: int
    no_such_mode: int
    no_such_message: int
    no_such_stream: int


@dataclass(frozen=True, slots=True, kw_only=True)
class OriginRules:
    """How its local frame is laid out, whether its origin stays once it is there, and whether it tells when home moves.

    What is told then is the origin, too.
    """

    projection: Projection
    stays: bool
    announces_home: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class DefaultLink:
    """A link that is opened when none is named."""

    device: str
    is_ground: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkRules:
    """How a firmware treats its links.

    Attributes:
        defaults: the links of its own simulator, by the number of the drone, from 0.
        answers_ping: whether it answers a PING to everybody.
        takes_signing: whether it obeys SETUP_SIGNING; if not, signed frames are taken unchecked.
        ground_rates_hz: by message id, on a link to a ground station; None for those of any link.
    """

    defaults: Callable[[int], tuple[DefaultLink, ...]]
    answers_ping: bool
    takes_signing: bool
    ground_rates_hz: Mapping[int, float] | None
