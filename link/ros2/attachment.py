"""What rmw_zenoh hangs on each sample: its number, when it was published, and by whom.

33 bytes: the sequence number and the UTC in ns, each a little-endian int64, a length of 16, and as many bytes of the
publisher's id. rmw_zenoh drops samples that come without an attachment.
Source: ros2/rmw_zenoh, docs/design.md, "Publishers"; the id in `Entity::Entity` of liveliness_utils.cpp.
"""

import struct

import xxhash
from msgspec import Struct

_LAYOUT = struct.Struct("<qqB16s")
_ID_BYTES = 16
_HALF = (1 << 64) - 1


class Attachment(Struct, frozen=True, kw_only=True):
    """The number of a sample, counted from 1, its time of publication and its publisher's id."""

    sequence: int
    source_time_ns: int
    publisher_id: bytes


def publisher_id(token_key: str) -> bytes:
    """Return the 16 bytes that stand for an entity: XXH3-128 of its token's key, the low half first, little-endian."""
    number = xxhash.xxh3_128_intdigest(token_key.encode())
    return (number & _HALF).to_bytes(8, "little") + (number >> 64).to_bytes(8, "little")


def encode(attachment: Attachment) -> bytes:
    """Return the bytes of an attachment."""
    return _LAYOUT.pack(attachment.sequence, attachment.source_time_ns, _ID_BYTES, attachment.publisher_id)


def decode(data: bytes) -> Attachment | None:
    """Return the attachment in `data`, None if it is none."""
    if len(data) != _LAYOUT.size:
        return None
    sequence, source_time_ns, length, publisher = _LAYOUT.unpack(data)
    if length != _ID_BYTES:
        return None
    return Attachment(sequence=sequence, source_time_ns=source_time_ns, publisher_id=publisher)
