"""What a frame holds, as one of pymavlink's messages.

pymavlink's own decoder finds out anew for each frame how its kind of message is laid out, which takes half of its time;
here that is found out once for each kind. Its classes and its checksum are used as they are.
"""

from functools import cache
from typing import NamedTuple

from link.mavlink.dialect import Message, mavlink


class _Layout(NamedTuple):
    """How the values of a kind of message lie in its payload.

    Attributes:
        kind: its class.
        crc_extra: what its definition adds to the checksum.
        places: of each of the class's fields among the values, a slice for an array.
        arrays: which of the fields are arrays of numbers.
        texts: which of them are texts.
    """

    kind: type[Message]
    crc_extra: bytes
    places: tuple[int | slice, ...]
    arrays: tuple[int, ...]
    texts: tuple[int, ...]


def message_of(frame: bytearray, message_id: int) -> Message | None:
    """Return the message in a whole frame of either version, None when its checksum is wrong.

    Args:
        frame: from its marker on.
        message_id: one that the dialect has.
    """
    is_version1 = frame[0] == mavlink.PROTOCOL_MARKER_V1
    start = mavlink.HEADER_LEN_V1 if is_version1 else mavlink.HEADER_LEN_V2
    end = start + frame[1]
    layout = _layout(message_id)
    crc = mavlink.x25crc(bytes(frame[1:end]) + layout.crc_extra).crc
    if frame[end] | frame[end + 1] << 8 != crc:
        return None
    # The zeros at the end of a payload are not sent, and a newer definition may have made it longer.
    unpacker = layout.kind.unpacker
    values = unpacker.unpack(frame[start:end].ljust(unpacker.size, b"\0")[: unpacker.size])
    fields = [values[place] for place in layout.places]
    for field in layout.arrays:
        fields[field] = list(fields[field])
    for field in layout.texts:
        fields[field] = fields[field].rstrip(b"\0")
    message = layout.kind(*fields)
    message._msgbuf, message._crc = frame, crc  # noqa: SLF001 (as its own decoder does; there is no other way in)
    header = message.get_header()
    header.mlen = frame[1]
    if is_version1:
        header.seq, header.srcSystem, header.srcComponent = frame[2:5]
    else:
        header.incompat_flags, header.compat_flags, header.seq, header.srcSystem, header.srcComponent = frame[2:7]
    return message


@cache
def _layout(message_id: int) -> _Layout:
    """Return the layout of a kind of message."""
    kind = mavlink.mavlink_map[message_id]
    places: list[int | slice] = []
    arrays, texts = [], []
    for field, order in enumerate(kind.orders):
        first, length = sum(kind.lengths[:order]), kind.lengths[order]
        is_text = kind.fieldtypes[field] == "char"
        places.append(first if is_text or length == 1 else slice(first, first + length))
        if is_text:
            texts.append(field)
        elif length > 1:
            arrays.append(field)
    return _Layout(kind, bytes((kind.crc_extra,)), tuple(places), tuple(arrays), tuple(texts))
