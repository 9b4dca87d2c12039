"""Everything in which one firmware differs from another, as data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sim_autopilot.modes import Mode
from sim_autopilot.parameters import Parameter, Values
from sim_autopilot.settings import FlightSettings
from sim_autopilot.streams import Stream


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeCode:
    """How a mode is named on the wire.

    Attributes:
        base_mode: MAV_MODE_FLAGs of the heartbeat, without the armed one.
        custom_mode: of the heartbeat.
        request: parameters 2 and 3 of the MAV_CMD_DO_SET_MODE that asks for it.
    """

    base_mode: int
    custom_mode: int
    request: tuple[int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """The MAV_RESULTs of refusals."""

    arm_refused: int
    disarm_in_the_air: int
    mode_refused: int
    no_such_message: int
    no_such_stream: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Readiness:
    """When after boot things begin to work."""

    fix_s: float
    position_s: float
    arming_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorFlags:
    """The SYS_STATUS bit masks: sensors present, enabled, healthy, and the health bit that says it can arm."""

    present: int
    enabled: int
    health: int
    arming_health: int


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
        streams: every message that it can send, by id, with default rates.
        stream_rate_max_hz: that a SET_MESSAGE_INTERVAL gets at most.
        readiness: after boot.
        results: of refusals.
        sensors: of SYS_STATUS.
        parameters: in index order.
        settings: the flight settings that parameter values amount to.
        setpoint_frames: MAV_FRAMEs of setpoints it takes.
        setpoint_stream_s: how long setpoints must have come before they may fly.
        takes_off_by_setpoint: whether a setpoint above lifts it off the ground.
        mode_answered_twice: whether DO_SET_MODE is accepted at once, and answered for good a step later.
        answers_other_components: whether it answers commands for another component of its system.
    """

    name: str
    autopilot_id: int
    capabilities: int
    version: int
    modes: Mapping[Mode, ModeCode]
    boot_mode: Mode
    unarmable_modes: frozenset[Mode]
    streams: Mapping[int, Stream]
    stream_rate_max_hz: float
    readiness: Readiness
    results: Results
    sensors: SensorFlags
    parameters: tuple[Parameter, ...]
    settings: Callable[[Values], FlightSettings]
    setpoint_frames: frozenset[int]
    setpoint_stream_s: float
    takes_off_by_setpoint: bool
    mode_answered_twice: bool
    answers_other_components: bool
