"""How a message's fields lie in its payload."""

import struct
from typing import NamedTuple

from link.mavlink.dialect import mavlink

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
