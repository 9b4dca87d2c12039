"""The checksum of a MAVLink frame.

Source: MAVLink serialization, https://mavlink.io/en/guide/serialization.html#checksum.
"""

import struct
from collections.abc import Iterable

from fastcrc.crc16 import mcrf4xx

from link.mavlink.dialect import mavlink

_CHECKSUM = struct.Struct("<H")
_SEED = 0xFFFF


def checksum(data: bytes) -> int:
    """CRC-16/MCRF4XX, by the library that pymavlink's own class calls."""
    return mcrf4xx(data, _SEED)


def with_checksum(head_and_payload: bytes | bytearray, message_id: int) -> bytes:
    """The frame, from its marker on, with the checksum of a known message appended."""
    crc = checksum(bytes(head_and_payload[1:]) + bytes((mavlink.mavlink_map[message_id].crc_extra,)))
    return bytes(head_and_payload) + _CHECKSUM.pack(crc)


def crc_extra(name: str, fields: Iterable[tuple[str, str, int]]) -> int:
    """The byte that stands for a message's definition: its name, and each field's type, name and array length.

    Args:
        name: of the message.
        fields: those that are no extensions, in the order in which they are sent; the length is 0 for no array.

    Returns:
        0 to 255.
    """
    crc = mavlink.x25crc(f"{name} ".encode())
    for kind, field, length in fields:
        crc.accumulate(f"{kind} {field} ".encode())
        if length:
            crc.accumulate(bytes((length,)))
    return int((crc.crc & 0xFF) ^ (crc.crc >> 8))
