"""The component's identity, phase and computer load as messages.

Source: MAVLink component information protocol, https://mavlink.io/en/services/component_information.html.
"""

import platform
from importlib.metadata import version

from msgspec import Struct

from companion.situation.phases import FLYING_PHASES, Phase
from link.mavlink.dialect import COMPONENT_INFORMATION_BASIC_ID, Message, mavlink

PHASE_NUMBERS = {
    Phase.IDLE: 0,
    Phase.TAKEOFF: 1,
    Phase.WAITING: 2,
    Phase.CHASE: 3,
    Phase.ALIGN: 4,
    Phase.DESCEND: 5,
    Phase.TOUCHDOWN: 6,
    Phase.SECURED: 7,
    Phase.ABORT: 8,
    Phase.HOLD: 9,
    Phase.PILOT: 10,
    Phase.ON_DECK: 11,
    Phase.LIFT_OFF: 12,
    Phase.FOLLOW: 13,
    Phase.RETURN: 14,
    Phase.RALLY: 15,
}
"""The custom mode of the heartbeat: these numbers stay."""

_CAPABILITIES = (
    mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    | mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
)
_VERSION_SIZE, _MODEL_SIZE = 24, 32
_NO_U8, _NO_I8, _NO_I16, _NO_U32 = 0xFF, 0x7F, 0x7FFF, 0xFFFF_FFFF
"""What says that a field is not known."""
_CORES, _SLICES, _GPUS, _FANS, _STORAGES, _LINKS = 8, 10, 4, 4, 4, 6


class ComputerLoad(Struct, frozen=True, kw_only=True):
    """What the computer does.

    Attributes:
        cores_percent: how busy each core is.
        ram_used_mib: mebibytes.
        ram_total_mib: mebibytes.
        uptime_ms: since it was started.
        temperature_c: of its processor, None where it does not tell.
    """

    cores_percent: tuple[float, ...]
    ram_used_mib: int
    ram_total_mib: int
    uptime_ms: int
    temperature_c: float | None


def heartbeat_state(phase: Phase, *, dry_run: bool = False) -> tuple[int, int]:
    """Return MAV_STATE and custom mode of the heartbeat; a dry run is in a phase, and flies nothing."""
    flies = phase in FLYING_PHASES and not dry_run
    status = mavlink.MAV_STATE_ACTIVE if flies else mavlink.MAV_STATE_STANDBY
    return int(status), PHASE_NUMBERS[phase]


def tells_of_flight(heartbeat: Message) -> bool:
    """Return whether the companion whose heartbeat this is flies the drone: its state and phase say so together."""
    told = heartbeat.system_status, heartbeat.custom_mode
    return told in {heartbeat_state(phase) for phase in FLYING_PHASES}


def component_information(boot_ms: int) -> Message:
    """Return the COMPONENT_INFORMATION_BASIC, `boot_ms` after the autopilot's start."""
    texts = (
        (b"Decklander", _MODEL_SIZE),
        (b"companion", _MODEL_SIZE),
        (version("decklander").encode("ascii", "replace"), _VERSION_SIZE),
        (platform.machine().encode("ascii", "replace"), _VERSION_SIZE),
        (b"", _MODEL_SIZE),
    )
    kind = mavlink.mavlink_map[COMPONENT_INFORMATION_BASIC_ID]
    return kind(boot_ms & _NO_U32, _CAPABILITIES, 0, *(text[:size] for text, size in texts))


def computer_status(load: ComputerLoad, utc_ns: int) -> Message:
    """Return the ONBOARD_COMPUTER_STATUS."""
    cores = [min(round(one), 100) for one in load.cores_percent[:_CORES]]
    temperature = _NO_I8 if load.temperature_c is None else max(-128, min(round(load.temperature_c), _NO_I8 - 1))
    return mavlink.MAVLink_onboard_computer_status_message(
        time_usec=utc_ns // 1000,
        uptime=load.uptime_ms & _NO_U32,
        type=0,  # primary
        cpu_cores=cores + [_NO_U8] * (_CORES - len(cores)),
        cpu_combined=[_NO_U8] * _SLICES,
        gpu_cores=[_NO_U8] * _GPUS,
        gpu_combined=[_NO_U8] * _SLICES,
        temperature_board=_NO_I8,
        temperature_core=[temperature] + [_NO_I8] * (_CORES - 1),
        fan_speed=[_NO_I16] * _FANS,
        ram_usage=load.ram_used_mib,
        ram_total=load.ram_total_mib,
        storage_type=[_NO_U32] * _STORAGES,
        storage_usage=[_NO_U32] * _STORAGES,
        storage_total=[_NO_U32] * _STORAGES,
        link_type=[_NO_U32] * _LINKS,
        link_tx_rate=[_NO_U32] * _LINKS,
        link_rx_rate=[_NO_U32] * _LINKS,
        link_tx_max=[_NO_U32] * _LINKS,
        link_rx_max=[_NO_U32] * _LINKS,
    )
