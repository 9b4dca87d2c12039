"""Messages about what the autopilot is: its version and its protocol, and since when it flies."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.status import boot_ms

PROTOCOL_VERSION = 300
"""A message that pymavlink names nowhere."""
_MAVLINK = (200, 100, 203)
"""The version times a hundred, and which it takes, as PX4 tells them."""
_NO_HASH = [0] * 8


def protocol_version(_memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return PROTOCOL_VERSION."""
    return mavlink.mavlink_map[PROTOCOL_VERSION](*_MAVLINK, _NO_HASH, _NO_HASH)


def autopilot_version(_memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return AUTOPILOT_VERSION."""
    identity, no_hash = config.firmware.identity, (0,) * 8
    version, commit = identity.version, tuple(identity.custom_version)
    system = identity.os_version
    return mavlink.MAVLink_autopilot_version_message(
        identity.capabilities,
        version,
        version if system else 0,
        system,
        identity.board_version,
        commit,
        commit if system else no_hash,
        no_hash,
        0,
        0,
        identity.uid,
        tuple(identity.uid2),
    )


def flight_information(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return FLIGHT_INFORMATION: since when it is armed, by the boot clock as PX4 tells it; of take-off nothing."""
    armed_us = 0 if memory.armed_ns is None else max(memory.armed_ns // 1000, 1)
    number = round(memory.tuning.values["COM_FLIGHT_UUID"])
    return mavlink.MAVLink_flight_information_message(boot_ms(memory), armed_us, 0, number)
