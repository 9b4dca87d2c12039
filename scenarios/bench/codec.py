"""What our framing costs beside pymavlink's own, both timed in turns within one run."""

import statistics
import time
from collections.abc import Callable

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink

_MESSAGES = 400
_REPEATS = 15


def codec_ratios() -> dict[str, float]:
    """Return how long encoding and parsing take over what pymavlink's pack and parse_buffer take, medians."""
    messages = _messages()
    ours, theirs = MavlinkCodec(1, 1), mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    theirs.robust_parsing = True
    data = b"".join(ours.encode(message) for message in messages)
    return {
        "encode_ratio": _ratio(
            lambda: [ours.encode(message) for message in messages],
            lambda: [message.pack(theirs) for message in messages],
        ),
        "parse_ratio": _ratio(lambda: ours.decode(data), lambda: theirs.parse_buffer(data)),
    }


def _ratio(ours: Callable[[], object], theirs: Callable[[], object]) -> float:
    pairs = [(_duration_s(ours), _duration_s(theirs)) for _ in range(_REPEATS)]
    return round(statistics.median(mine / other for mine, other in pairs), 3)


def _duration_s(work: Callable[[], object]) -> float:
    began_s = time.process_time()
    work()
    return time.process_time() - began_s


def _messages() -> list[Message]:
    """What an autopilot streams most of, and setpoints."""
    kinds = (
        lambda i: mavlink.MAVLink_attitude_quaternion_message(i, 1.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
        lambda i: mavlink.MAVLink_local_position_ned_message(i, 1.0, 2.0, -3.0, 0.1, 0.2, 0.3),
        lambda i: mavlink.MAVLink_heartbeat_message(2, 12, 81, i, 3, 3),
        lambda i: mavlink.MAVLink_set_position_target_local_ned_message(
            i, 1, 1, 1, 0, 1.0, 2.0, -3.0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.5, 0.0
        ),
    )
    return [kinds[i % len(kinds)](i) for i in range(_MESSAGES)]
