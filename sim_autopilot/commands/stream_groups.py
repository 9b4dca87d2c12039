"""REQUEST_DATA_STREAM: the older way to ask for groups of messages, each at one rate.

ArduPilot keeps a group's rate of each link in a parameter, such as SR0_EXTRA1. Source: GCS_MAVLINK's
handle_request_data_stream.
"""

from collections.abc import Mapping

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.boot import tune
from sim_autopilot.commands.addressees import is_ours
from sim_autopilot.core.streams import with_interval
from sim_autopilot.interfaces import AutopilotConfig, Result
from sim_autopilot.memory import AutopilotMemory, with_link

_STOPS, _STARTS = 0, 1
_ALL = int(mavlink.MAV_DATA_STREAM_ALL)


def request_data_stream(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Start or stop the messages of a group on the link at hand, and keep the rate in the group's parameter."""
    group = config.firmware.streams.groups.get(message.req_stream_id)
    if group is None or message.start_stop not in {_STOPS, _STARTS} or not is_ours(message, config):
        return memory, ()
    asked_hz = message.req_message_rate if message.start_stop == _STARTS else 0
    rate_hz = min(float(asked_hz), config.firmware.streams.rate_max_hz)
    interval_ns = round(1e9 / rate_hz) if rate_hz > 0.0 else None
    streams = memory.links.here.streams
    for message_id in group:
        streams = with_interval(streams, message_id, interval_ns, memory.now.boot_ns)
    memory = with_link(memory, replace(memory.links.here, streams=streams))
    changed = _rate_parameters(message.req_stream_id, float(asked_hz), memory, config)
    return replace(memory, tuning=tune(config, {**memory.tuning.values, **changed})) if changed else memory, ()


def _rate_parameters(
    group: int, rate_hz: float, memory: AutopilotMemory, config: AutopilotConfig
) -> Mapping[str, float]:
    """Return the parameters of the link at hand that a request sets; a link beyond the table has none."""
    named = config.firmware.streams.group_parameters
    names = named.values() if group == _ALL else (named[group],) if group in named else ()
    whole = (f"SR{memory.links.at_hand}_{name}" for name in names)
    return {name: rate_hz for name in whole if name in memory.tuning.values}
