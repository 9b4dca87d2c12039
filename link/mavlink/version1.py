"""MAVLink 1 frames for clients that speak nothing newer.

Source: https://mavlink.io/en/guide/mavlink_2.html: version 1 has message ids up to 255, no extension fields, and does
not leave out trailing zeros.
"""

from functools import cache

from link.mavlink.checksum import crc_extra, with_checksum
from link.mavlink.dialect import mavlink
from link.mavlink.layout import fields_in_order

_ID_MAX = 255


def as_version1(frame: bytes) -> bytes | None:
    """Returns a MAVLink 2 frame of a known message as MAVLink 1, None when version 1 does not have the message."""
    message_id = int.from_bytes(frame[7:10], "little")
    if message_id > _ID_MAX:
        return None
    size = base_size(message_id)
    payload = frame[mavlink.HEADER_LEN_V2 : mavlink.HEADER_LEN_V2 + frame[1]][:size].ljust(size, b"\0")
    head = bytes((mavlink.PROTOCOL_MARKER_V1, size, frame[4], frame[5], frame[6], message_id))
    return with_checksum(head + payload, message_id)


@cache
def base_size(message_id: int) -> int:
    """Returns the payload size of a message without its extension fields.

    The dialect does not say where these begin, but its CRC_EXTRA is made of the fields before them.
    """
    kind, fields = mavlink.mavlink_map[message_id], fields_in_order(message_id)
    for count in range(len(fields), 0, -1):
        if crc_extra(kind.msgname, [(one.kind, one.name, one.length) for one in fields[:count]]) == kind.crc_extra:
            return sum(one.size for one in fields[:count])
    raise ValueError(f"{kind.msgname} does not match its CRC_EXTRA")
