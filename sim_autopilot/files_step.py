"""Files and logs in the autopilot's step: MAVLink FTP, the log service, and the log of the flight."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from link.units import NS_PER_S
from sim_autopilot.files.flight_log import Row
from sim_autopilot.files.ftp import answer, burst_on
from sim_autopilot.files.ftp_wire import question_from_message
from sim_autopilot.files.logs import Logs, asked_for, entries, is_due, logged, pieces, shown_logs
from sim_autopilot.files.store import Shown
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.status_texts import status_text
from sim_autopilot.telemetry.motion import attitude, global_position_int, local_position_ned

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def shown_files(memory: AutopilotMemory, config: AutopilotConfig) -> Shown:
    """Return the files that the autopilot shows: its own, and its logs."""
    firmware = config.firmware
    own = firmware.files(firmware.parameters, memory.values)
    return {**own, **shown_logs(memory.services.logs, firmware.logs)}


def take_ftp(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after a FILE_TRANSFER_PROTOCOL meant for this autopilot, and the answer."""
    services, rules = memory.services, config.firmware.ftp
    question, shown = question_from_message(message), shown_files(memory, config)
    ftp, answers = answer(services.ftp, question, shown, rules, memory.now.boot_ns)
    return replace(memory, services=replace(services, ftp=ftp)), answers


def take_log_request(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after a message of the log service meant for this autopilot, and the answers."""
    refusal = config.firmware.logs.only_disarmed
    if refusal and memory.armed_ns is not None:
        return memory, (status_text(mavlink.MAV_SEVERITY_ERROR, refusal),)
    logs, answers = _LOG_HANDLERS[message.get_msgId()](memory, message, config)
    return _with_logs(memory, logs), answers


def log_flight(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory with this moment logged where it is time for that."""
    armed, logs = memory.armed_ns is not None, memory.services.logs
    if not is_due(logs, memory.now.boot_ns, armed=armed):
        return memory
    return _with_logs(
        memory, logged(logs, log_row(memory, config), memory.now.t_ns // NS_PER_S, config.firmware.logs, armed=armed)
    )


def send_on(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Return the memory one step on, and what of a burst goes to its client now."""
    services = memory.services
    if services.ftp.burst is None:
        return memory, ()
    ftp, messages = burst_on(services.ftp, config.firmware.ftp)
    return replace(memory, services=replace(services, ftp=ftp)), messages


def send_log(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Return the memory one step on, and what of a log goes on the link at hand now."""
    sending = memory.services.logs.sending
    if sending is None or sending.link != memory.link:
        return memory, ()
    logs, messages = pieces(memory.services.logs, config.firmware.logs)
    return _with_logs(memory, logs), messages


def _with_logs(memory: AutopilotMemory, logs: Logs) -> AutopilotMemory:
    return replace(memory, services=replace(memory.services, logs=logs))


def log_row(memory: AutopilotMemory, config: AutopilotConfig) -> Row:
    """Return this moment as logs tell it."""
    local, place, turned = (build(memory, config) for build in (local_position_ned, global_position_int, attitude))
    return Row(
        boot_ns=memory.now.boot_ns,
        position_ned_m=(local.x, local.y, local.z),
        velocity_ned_m_s=(local.vx, local.vy, local.vz),
        attitude_rad=(turned.roll, turned.pitch, turned.yaw),
        latitude_e7=place.lat,
        longitude_e7=place.lon,
        altitude_m=place.alt * 1e-3,
    )


_Handled = tuple[Logs, tuple[Message, ...]]


def _list(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> _Handled:
    logs = memory.services.logs
    return replace(logs, listed=True), entries(logs, message.start, message.end, config.firmware.logs)


def _send(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> _Handled:
    return asked_for(memory.services.logs, memory.link, message, config.firmware.logs), ()


def _end(memory: AutopilotMemory, _message: Message, _config: AutopilotConfig) -> _Handled:
    return replace(memory.services.logs, sending=None), ()


def _erase(memory: AutopilotMemory, _message: Message, _config: AutopilotConfig) -> _Handled:
    return replace(memory.services.logs, kept=(), sending=None), ()


_LOG_HANDLERS: Mapping[int, Callable[[AutopilotMemory, Message, AutopilotConfig], _Handled]] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_LOG_REQUEST_LIST: _list,
        mavlink.MAVLINK_MSG_ID_LOG_REQUEST_DATA: _send,
        mavlink.MAVLINK_MSG_ID_LOG_REQUEST_END: _end,
        mavlink.MAVLINK_MSG_ID_LOG_ERASE: _erase,
    }
)
LOG_IDS = frozenset(_LOG_HANDLERS)
"""The messages of the log service."""
