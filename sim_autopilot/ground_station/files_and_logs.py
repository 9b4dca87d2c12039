"""Files and logs in the autopilot's step: MAVLink FTP, the log service, and the log of the flight."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from link.ftp.server import answer, burst_on
from link.ftp.state import FtpRules
from link.ftp.store import Shown
from link.ftp.wire import question_from_message
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from link.units import NS_PER_S
from sim_autopilot.core.status_texts import status_text
from sim_autopilot.ground_station.logs.flight_log import LogRules, Row
from sim_autopilot.ground_station.logs.logs import Logs, add_row, begin_download, entries, is_due, pieces, shown_logs
from sim_autopilot.ground_station.memory import station_of, with_station
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.motion import attitude, global_position_int, local_position_ned

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def take_ftp(memory: AutopilotMemory, message: Message, own: Shown, rules: FtpRules, logs: LogRules) -> Result:
    """Return the memory after a FILE_TRANSFER_PROTOCOL, and the answer; its own files and its logs are shown."""
    station, question = station_of(memory), question_from_message(message)
    shown = {**own, **shown_logs(station.logs, logs)}
    ftp, answers = answer(station.ftp, question, shown, rules, memory.now.boot_ns)
    return with_station(memory, replace(station, ftp=ftp)), answers


def take_log_request(memory: AutopilotMemory, message: Message, rules: LogRules) -> Result:
    """Return the memory after a message of the log service, and the answers."""
    if rules.only_disarmed and memory.armed_ns is not None:
        return memory, (status_text(mavlink.MAV_SEVERITY_ERROR, rules.only_disarmed),)
    logs, answers = _LOG_HANDLERS[message.get_msgId()](memory, message, rules)
    return _with_logs(memory, logs), answers


def log_flight(memory: AutopilotMemory, config: AutopilotConfig, rules: LogRules) -> AutopilotMemory:
    """Return the memory with this moment logged where it is time for that."""
    armed, logs = memory.armed_ns is not None, station_of(memory).logs
    if not is_due(logs, memory.now.boot_ns, armed=armed):
        return memory
    row, now_s = log_row(memory, config), memory.now.t_ns // NS_PER_S
    return _with_logs(memory, add_row(logs, row, now_s, rules, armed=armed))


def send_burst(memory: AutopilotMemory, rules: FtpRules) -> Result:
    """Return the memory one step on, and what of a burst goes to its client now."""
    station = station_of(memory)
    if station.ftp.burst is None:
        return memory, ()
    ftp, messages = burst_on(station.ftp, rules)
    return with_station(memory, replace(station, ftp=ftp)), messages


def send_log(memory: AutopilotMemory, rules: LogRules) -> Result:
    """Return the memory one step on, and what of a log goes on the link at hand now."""
    logs = station_of(memory).logs
    if logs.sending is None or logs.sending.link != memory.links.at_hand:
        return memory, ()
    logs, messages = pieces(logs, rules)
    return _with_logs(memory, logs), messages


def _with_logs(memory: AutopilotMemory, logs: Logs) -> AutopilotMemory:
    return with_station(memory, replace(station_of(memory), logs=logs))


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


def _list(memory: AutopilotMemory, message: Message, rules: LogRules) -> _Handled:
    logs = station_of(memory).logs
    return replace(logs, listed=True), entries(logs, message.start, message.end, rules)


def _send(memory: AutopilotMemory, message: Message, rules: LogRules) -> _Handled:
    return begin_download(station_of(memory).logs, memory.links.at_hand, message, rules), ()


def _end(memory: AutopilotMemory, _message: Message, _rules: LogRules) -> _Handled:
    return replace(station_of(memory).logs, sending=None), ()


def _erase(memory: AutopilotMemory, _message: Message, _rules: LogRules) -> _Handled:
    return replace(station_of(memory).logs, kept=(), sending=None), ()


_LOG_HANDLERS: Mapping[int, Callable[[AutopilotMemory, Message, LogRules], _Handled]] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_LOG_REQUEST_LIST: _list,
        mavlink.MAVLINK_MSG_ID_LOG_REQUEST_DATA: _send,
        mavlink.MAVLINK_MSG_ID_LOG_REQUEST_END: _end,
        mavlink.MAVLINK_MSG_ID_LOG_ERASE: _erase,
    }
)
LOG_IDS = frozenset(_LOG_HANDLERS)
"""The messages of the log service."""
