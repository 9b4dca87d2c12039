"""Messages about what the autopilot is: its version, its protocol, and where its metadata are."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.files.ftp_handlers import checksum
from sim_autopilot.files_step import shown_files
from sim_autopilot.firmware.component_metadata import COMPONENT_METADATA, GENERAL_PATH, PROTOCOL_VERSION
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.telemetry.status import boot_ms

_MAVLINK = (200, 100, 203)
"""The version times a hundred, and which it takes, as PX4 tells them."""
_NO_HASH = [0] * 8


def protocol_version(_memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return PROTOCOL_VERSION."""
    return mavlink.mavlink_map[PROTOCOL_VERSION](*_MAVLINK, _NO_HASH, _NO_HASH)


def component_metadata(memory: AutopilotMemory, config: AutopilotConfig) -> Message | None:
    """Return COMPONENT_METADATA, where there are any."""
    general = shown_files(memory, config).get(GENERAL_PATH)
    if general is None:
        return None
    uri = f"mftp://{GENERAL_PATH}".encode()
    return mavlink.mavlink_map[COMPONENT_METADATA](boot_ms(memory), checksum(general()), uri)


def autopilot_version(_memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return AUTOPILOT_VERSION."""
    firmware, identity, no_hash = config.firmware, config.firmware.identity, (0,) * 8
    version, commit = firmware.version, tuple(identity.custom_version)
    system = identity.os_version
    return mavlink.MAVLink_autopilot_version_message(
        firmware.capabilities,
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
    number = round(memory.values["COM_FLIGHT_UUID"])
    return mavlink.MAVLink_flight_information_message(boot_ms(memory), armed_us, 0, number)
