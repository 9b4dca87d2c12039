"""Everything in which one firmware differs from another, as data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from link.frames.local_frame import Projection
from sim_autopilot.files.flight_log import PX4_LOGS, LogRules
from sim_autopilot.files.ftp_state import PX4_FTP, FtpRules
from sim_autopilot.files.store import Shown
from sim_autopilot.firmware.identity import Identity
from sim_autopilot.flight.modes import Mode
from sim_autopilot.missions.rules import PX4_MISSIONS, MissionRules
from sim_autopilot.parameters import Parameter, Values
from sim_autopilot.settings import FlightSettings
from sim_autopilot.streams import Stream


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
class Text:
    """What a STATUSTEXT says."""

    severity: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EventCode:
    """An EVENT: its name, its log levels (internal in the upper four bits) and its packed arguments.

    `said` is what ground stations get as a text: empty is nothing, None what it says itself.
    """

    name: str
    levels: int
    arguments: bytes = b""
    said: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Texts:
    """What is said when.

    Attributes:
        everybody: whether they go to whoever speaks, or only to ground stations.
        severity: of refusals.
        boot: (seconds since boot, text) of the start-up.
        not_ready: (until so many seconds since boot, text) of an arming refused.
        unarmable: the mode's name goes in for `{}`.
        no_setpoints: arming in OFFBOARD without setpoints.
        disarm_refused: in the air; None says nothing.
        armed, disarmed: None says nothing.
        battery: by the level that the battery has come to, 1 is low.
        failsafe: that a failsafe has begun; empty says nothing.
        obeyed: to the command that asks for a mode.
        high_enough: a take-off to where the drone is already, or lower.
        no_such_mode: the number goes in for `{}`; empty says nothing.
        no_mission: MISSION_START without a mission; None says nothing.
    """

    everybody: bool
    severity: int
    boot: tuple[tuple[float, Text], ...]
    not_ready: tuple[tuple[float, str], ...]
    unarmable: str
    no_setpoints: str
    disarm_refused: str | None
    armed: Text | None
    disarmed: Text | None
    battery: Mapping[int, str] = field(default_factory=dict)
    failsafe: str = ""
    obeyed: Mapping[Mode, str] = field(default_factory=dict)
    high_enough: str | None = None
    no_such_mode: str = ""
    no_mission: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFlags:
    """The SYS_STATUS bit masks: sensors present, enabled, healthy.

    Attributes:
        present: all of them.
        enabled: likewise.
        health: of those that work from the start.
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
class Firmware:
    """An autopilot firmware.

    Attributes:
        name: as `--firmware` takes it.
        autopilot_id: MAV_AUTOPILOT.
        capabilities: MAV_PROTOCOL_CAPABILITY flags.
        version: flight_sw_version of AUTOPILOT_VERSION.
        modes: codes of the modes it has.
        boot_mode: in which it starts.
        unarmable_modes: in which it refuses to arm.
        loiter_mode: which MAV_CMD_NAV_LOITER_UNLIM asks for.
        fix_type: GPS_FIX_TYPE, once there is a fix.
        statuses, texts: of HEARTBEAT and of STATUSTEXT.
        vtol_state: of EXTENDED_SYS_STATE.
        current_ca: that the battery tells, centiampere; None for what empties it evenly, with what it has given.
        streams: every message that it can send, by id, with default rates.
        stream_groups: message ids by the MAV_DATA_STREAM that starts them.
        contact_streams: message ids that begin only when somebody has spoken.
        stream_rate_max_hz: that a SET_MESSAGE_INTERVAL gets at most.
        readiness, results: after boot, and of refusals.
        sensors: of SYS_STATUS.
        parameters: in index order; what the flight does not obey is kept and answered all the same.
        system_id_parameter: the name of the one that holds the MAVLink system.
        lenient_parameters: whether a PARAM_SET is taken whatever its type and range.
        settings: the flight settings that parameter values amount to.
        setpoint_frames: MAV_FRAMEs of setpoints it takes.
        setpoint_stream_s: how long setpoints must have come before they may fly; None asks for none.
        guided: whether OFFBOARD is ArduCopter's GUIDED: setpoints move a shaped path, and never time out of the mode.
        projection, keeps_origin: how its local frame is laid out, and whether the origin, once there, moves no more.
        announces_home: whether it tells the origin and home when home moves.
        takes_off_by_setpoint: whether a setpoint above lifts it off the ground.
        mode_answered_twice: whether DO_SET_MODE is accepted at once, and answered for good a step later.
        answers_other_components: whether it answers what is for another component of its system, and commands for all.
        leaves_landing_modes: whether it goes back, when the motors stop, to the last mode asked for that lets arm.
        tells_modes: whether a change of mode sends a heartbeat at once.
        set_mode_answered_as: the MAV_CMD that the COMMAND_ACK to a SET_MODE names; None answers nothing.
        tells_indices: whether a parameter that was asked for or set by name is answered with its index.
        plain_answers: the MAV_RESULT of commands that change nothing here, None for no answer, by MAV_CMD.
        missions, logs: of the mission protocol and of the log service.
        events: that it sends besides texts, by their text.
        lists_modes, has_shell: whether it sends AVAILABLE_MODES, and answers SERIAL_CONTROL.
        tells_flights: whether it says what a flight comes to: `flight_texts`.
        reposition_mode: in which a DO_REPOSITION is flown.
        files, ftp: that it shows over MAVLink FTP, by its parameters and their values, and of that server.
        banner, identity: texts that follow a PARAM_REQUEST_LIST, and of AUTOPILOT_VERSION.
        silent_messages: ids that it can be asked for, and has nothing to tell of.
    """

    name: str
    autopilot_id: int
    capabilities: int
    version: int
    modes: Mapping[Mode, ModeCode]
    boot_mode: Mode
    unarmable_modes: frozenset[Mode]
    loiter_mode: Mode
    statuses: Statuses
    fix_type: int
    texts: Texts
    vtol_state: int
    current_ca: int | None
    streams: Mapping[int, Stream]
    stream_groups: Mapping[int, tuple[int, ...]]
    contact_streams: frozenset[int]
    stream_rate_max_hz: float
    readiness: Readiness
    results: Results
    sensors: SensorFlags
    parameters: tuple[Parameter, ...] = field(repr=False)  # hundreds
    system_id_parameter: str
    lenient_parameters: bool
    settings: Callable[[Values], FlightSettings]
    setpoint_frames: frozenset[int]
    setpoint_stream_s: float | None
    guided: bool
    projection: Projection
    keeps_origin: bool
    announces_home: bool
    takes_off_by_setpoint: bool
    mode_answered_twice: bool
    answers_other_components: bool
    leaves_landing_modes: bool
    tells_modes: bool
    set_mode_answered_as: int | None
    tells_indices: bool
    plain_answers: Mapping[int, int | None]
    missions: MissionRules = PX4_MISSIONS
    events: Mapping[str, EventCode] = field(default_factory=dict)
    has_shell: bool = False
    lists_modes: bool = False
    tells_flights: bool = False
    reposition_mode: Mode = Mode.HOLD
    files: Callable[[tuple[Parameter, ...], Values], Shown]
    ftp: FtpRules = PX4_FTP
    banner: tuple[str, ...] = ()
    identity: Identity = field(default_factory=Identity)
    silent_messages: frozenset[int] = frozenset()
    logs: LogRules = PX4_LOGS
