"""What a frame of either version holds: how a message's fields lie in its payload, and its checksum.

pymavlink itself finds out again for each frame how its kind of message is laid out, and makes a message's header twice,
which takes half of its time; here a layout is found out once for each kind. Its classes and its checksum are used as
they are. Version 1 is for clients that speak nothing newer: message ids up to 255, no extension fields, and trailing
zeros are not left out.

Source: https://mavlink.io/en/guide/serialization.html#checksum, https://mavlink.io/en/guide/mavlink_2.html.
"""

import struct
from collections.abc import Callable
from functools import cache
from operator import attrgetter, itemgetter
from typing import Any, NamedTuple

from fastcrc.crc16 import mcrf4xx

from link.mavlink.dialect import Message, crc_extra, mavlink

_CHECKSUM = struct.Struct("<H")
_SEED = 0xFFFF


def checksum(data: bytes) -> int:
    """CRC-16/MCRF4XX, by the library that pymavlink's own class calls."""
    return mcrf4xx(data, _SEED)


def with_checksum(head_and_payload: bytes | bytearray, message_id: int) -> bytes:
    """The frame, from its marker on, with the checksum of a known message appended."""
    crc = checksum(bytes(head_and_payload[1:]) + bytes((mavlink.mavlink_map[message_id].crc_extra,)))
    return bytes(head_and_payload) + _CHECKSUM.pack(crc)


_FORMATS = {
    "char": "<c",
    "uint8_t": "<B",
    "int8_t": "<b",
    "uint16_t": "<H",
    "int16_t": "<h",
    "uint32_t": "<I",
    "int32_t": "<i",
    "uint64_t": "<Q",
    "int64_t": "<q",
    "float": "<f",
    "double": "<d",
}


class Field(NamedTuple):
    """A field of `kind`, an array when `length` is not 0."""

    kind: str
    name: str
    length: int

    @property
    def size(self) -> int:
        """In bytes."""
        return struct.calcsize(_FORMATS[self.kind]) * (self.length or 1)


def fields_in_order(message_id: int) -> list[Field]:
    """Returns a message's fields in the order in which they are sent, extensions last."""
    kind = mavlink.mavlink_map[message_id]
    kinds = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
    return [
        Field(kinds[name], name, length)
        for name, length in zip(kind.ordered_fieldnames, kind.array_lengths, strict=True)
    ]


def field_offsets(message_id: int) -> dict[str, int]:
    """Returns where in the payload each field begins."""
    offsets, start = {}, 0
    for field in fields_in_order(message_id):
        offsets[field.name] = start
        start += field.size
    return offsets


class _Layout(NamedTuple):
    """How the values of a kind of message lie in its payload.

    Attributes:
        kind: its class.
        crc_extra: what its definition adds to the checksum.
        values_of: gives of the unpacked values those of the class's fields in its own order, an array's as a tuple.
        arrays: which of the fields are arrays of numbers.
        texts: which of them are texts.
        fields_of: a message's fields in the order of the payload.
        lengths: how long the arrays of numbers among these fields are, by their place.
    """

    kind: type[Message]
    crc_extra: bytes
    values_of: Callable[[tuple[Any, ...]], tuple[Any, ...]]
    arrays: tuple[int, ...]
    texts: tuple[int, ...]
    fields_of: Callable[[Message], tuple[Any, ...]]
    lengths: dict[int, int]


_HEAD = struct.Struct("<BBBBBBBHB")


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
    crc = checksum(bytes(frame[1:end]) + layout.crc_extra)
    if frame[end] | frame[end + 1] << 8 != crc:
        return None
    # The zeros at the end of a payload are not sent, and a newer definition may have made it longer.
    unpacker = layout.kind.unpacker
    values = unpacker.unpack(frame[start:end].ljust(unpacker.size, b"\0")[: unpacker.size])
    fields = list(layout.values_of(values))
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


def frame_of(message: Message, sequence: int, system_id: int, component_id: int) -> bytes:
    """Return the MAVLink 2 frame of a message, not signed.

    Raises:
        struct.error: a field does not fit its type, or an array is too short.
        TypeError: what should be an array is not one.
        KeyError: the dialect does not have the message.
    """
    message_id = message.get_msgId()
    layout = _layout(message_id)
    values = layout.fields_of(message)
    if layout.lengths:
        flat: list[Any] = []
        for place, value in enumerate(values):
            flat += value[: layout.lengths[place]] if place in layout.lengths else (value,)
        values = tuple(flat)
    payload = layout.kind.unpacker.pack(*values).rstrip(b"\0") or b"\0"  # zeros at the end are not sent
    head = _HEAD.pack(
        mavlink.PROTOCOL_MARKER_V2,
        len(payload),
        0,
        0,
        sequence,
        system_id,
        component_id,
        message_id & 0xFFFF,
        message_id >> 16,
    )
    crc = checksum(head[1:] + payload + layout.crc_extra)
    return head + payload + _CHECKSUM.pack(crc)


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
    fields = fields_in_order(message_id)
    names = [f"_{one.name}_raw" if one.kind == "char" else one.name for one in fields]
    lengths = {place: one.length for place, one in enumerate(fields) if one.length and one.kind != "char"}
    crc_extra = bytes((kind.crc_extra,))
    return _Layout(kind, crc_extra, _chooser(places), tuple(arrays), tuple(texts), _getter(names), lengths)


def _getter(names: list[str]) -> Callable[[Message], tuple[Any, ...]]:
    """Return what gives these attributes, of which `attrgetter` does not make a tuple when there is one."""
    get = attrgetter(*names)
    return get if len(names) > 1 else lambda message: (get(message),)


def _chooser(places: list[int | slice]) -> Callable[[tuple[Any, ...]], tuple[Any, ...]]:
    """Return what gives the values at these places, of which `itemgetter` does not make a tuple when there is one."""
    choose = itemgetter(*places)
    return choose if len(places) > 1 else lambda values: (choose(values),)


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
