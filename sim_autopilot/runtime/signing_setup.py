"""SETUP_SIGNING as ArduPilot obeys it: only while disarmed, at once on all links, without an acknowledgement.

Source: ArduPilot's GCS_MAVLink/GCS_Signing.cpp, and as seen on its simulation.
"""

from collections.abc import Iterable

from link.mavlink.dialect import Message, mavlink
from link.mavlink.signing import Signing, Streams

_TRUSTED_LINK = 0  # a cable, by which a lost key can be replaced
_TIMESTAMP_MAX = (1 << 48) - 1


def last_setup(messages: Iterable[Message], system_id: int) -> Message | None:
    """Return the last SETUP_SIGNING for us among `messages`."""
    found = None
    for message in messages:
        if message.get_msgId() == mavlink.MAVLINK_MSG_ID_SETUP_SIGNING and message.target_system in {0, system_id}:
            found = message
    return found


def link_signings(setup: Message, links: int) -> list[Signing | None]:
    """Return how each link signs and checks after `setup`; a key of zeros ends it."""
    key = bytes(setup.secret_key)
    if not any(key):
        return [None] * links
    timestamp, streams = min(setup.initial_timestamp, _TIMESTAMP_MAX), Streams()
    return [
        Signing(key, link, timestamp, takes_unsigned=link == _TRUSTED_LINK, streams=streams) for link in range(links)
    ]
