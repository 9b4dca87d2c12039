"""The one home of pymavlink's message classes: MAVLink 2, every public dialect in one, and what these leave out.

Left out are, as drafts, messages that PX4 sends or a component hears or tells. A frame of a message that the dialect
does not hold cannot be checked, and its content is lost: PX4's reasons for not arming among them. Left out, too, are
the ids of the autopilot's events: the 32-bit FNV-1a hash of a name, cut to 24 bits, and the component above it.

Source: MAVLink common, messages 8, 80, 300, 380, 396, 397, 410, 411; wire order and checksum seed:
https://mavlink.io/en/guide/serialization.html. Events: https://mavlink.io/en/services/events.html; hash: RFC 9923.
"""

import struct
from collections.abc import Iterable
from typing import Any, NamedTuple, TypeAlias

from pymavlink.dialects.v20 import all as mavlink
from pymavlink.generator.mavcrc import x25crc

__all__ = [
    "COMMAND_CANCEL_ID",
    "COMPONENT_INFORMATION_BASIC_ID",
    "COMPONENT_METADATA_ID",
    "DRAFT_MESSAGES",
    "MAV_RESULT_CANCELLED",
    "Message",
    "crc_extra",
    "event_id",
    "mavlink",
]

Message: TypeAlias = mavlink.MAVLink_message

_FORMATS = {"uint8_t": "B", "uint16_t": "H", "uint32_t": "I", "int32_t": "i", "uint64_t": "Q", "char": "s"}


class _Field(NamedTuple):
    type: str
    name: str
    length: int = 0  # of an array

    @property
    def format(self) -> str:
        return f"{self.length or ''}{_FORMATS[self.type]}"


_DRAFTS = (
    (
        8,
        "LINK_NODE_STATUS",
        (
            _Field("uint64_t", "timestamp"),
            _Field("uint8_t", "tx_buf"),
            _Field("uint8_t", "rx_buf"),
            _Field("uint32_t", "tx_rate"),
            _Field("uint32_t", "rx_rate"),
            _Field("uint16_t", "rx_parse_err"),
            _Field("uint16_t", "tx_overflows"),
            _Field("uint16_t", "rx_overflows"),
            _Field("uint32_t", "messages_sent"),
            _Field("uint32_t", "messages_received"),
            _Field("uint32_t", "messages_lost"),
        ),
    ),
    (
        80,
        "COMMAND_CANCEL",
        (_Field("uint8_t", "target_system"), _Field("uint8_t", "target_component"), _Field("uint16_t", "command")),
    ),
    (
        380,
        "TIME_ESTIMATE_TO_TARGET",
        tuple(
            _Field("int32_t", name)
            for name in ("safe_return", "land", "mission_next_item", "mission_end", "commanded_action")
        ),
    ),
    (
        300,
        "PROTOCOL_VERSION",
        (
            _Field("uint16_t", "version"),
            _Field("uint16_t", "min_version"),
            _Field("uint16_t", "max_version"),
            _Field("uint8_t", "spec_version_hash", 8),
            _Field("uint8_t", "library_version_hash", 8),
        ),
    ),
    (
        396,
        "COMPONENT_INFORMATION_BASIC",
        (
            _Field("uint32_t", "time_boot_ms"),
            _Field("uint64_t", "capabilities"),
            _Field("uint32_t", "time_manufacture_s"),
            _Field("char", "vendor_name", 32),
            _Field("char", "model_name", 32),
            _Field("char", "software_version", 24),
            _Field("char", "hardware_version", 24),
            _Field("char", "serial_number", 32),
        ),
    ),
    (
        397,
        "COMPONENT_METADATA",
        (_Field("uint32_t", "time_boot_ms"), _Field("uint32_t", "file_crc"), _Field("char", "uri", 100)),
    ),
    (
        410,
        "EVENT",
        (
            _Field("uint8_t", "destination_component"),
            _Field("uint8_t", "destination_system"),
            _Field("uint32_t", "id"),
            _Field("uint32_t", "event_time_boot_ms"),
            _Field("uint16_t", "sequence"),
            _Field("uint8_t", "log_levels"),
            _Field("uint8_t", "arguments", 40),
        ),
    ),
    (411, "CURRENT_EVENT_SEQUENCE", (_Field("uint16_t", "sequence"), _Field("uint8_t", "flags"))),
)


def crc_extra(name: str, fields: Iterable[tuple[str, str, int]]) -> int:
    """The byte that stands for a message's definition: its name, and each field's type, name and array length.

    Args:
        name: of the message.
        fields: those that are no extensions, in the order in which they are sent; the length is 0 for no array.

    Returns:
        0 to 255.
    """
    crc = x25crc(f"{name} ".encode())
    for kind, field, length in fields:
        crc.accumulate(f"{kind} {field} ".encode())
        if length:
            crc.accumulate(bytes((length,)))
    return int((crc.crc & 0xFF) ^ (crc.crc >> 8))


class _Draft(mavlink.MAVLink_message):  # type: ignore[misc]  # pymavlink has no annotations
    """What the generator writes for each message, once for all of them."""

    def __init__(self, *values: Any) -> None:
        super().__init__(type(self).msg_id, type(self).msgname)
        self._fieldnames = type(self).fieldnames
        for name, kind, value in zip(self.fieldnames, self.fieldtypes, values, strict=True):
            setattr(self, name, value)
            if kind == "char":
                setattr(self, f"_{name}_raw", value)

    def pack(self, mav: Any, force_mavlink1: bool = False) -> bytes:
        """Return the frame."""
        values: list[int | bytes] = []
        for name in self.ordered_fieldnames:
            value = getattr(self, name)
            values += value if isinstance(value, list) else [value]
        packed = self.unpacker.pack(*values)
        return bytes(self._pack(mav, self.crc_extra, packed, force_mavlink1=force_mavlink1))


def _draft(message_id: int, name: str, fields: tuple[_Field, ...]) -> type[_Draft]:
    ordered = sorted(fields, key=lambda field: -struct.calcsize(_FORMATS[field.type]))
    layout = "<" + "".join(field.format for field in ordered)
    return type(
        f"MAVLink_{name.lower()}_message",
        (_Draft,),
        {
            "msg_id": message_id,
            "msgname": name,
            "fieldnames": [field.name for field in fields],
            "ordered_fieldnames": [field.name for field in ordered],
            "fieldtypes": [field.type for field in fields],
            "native_format": bytearray(
                "<" + "".join(_FORMATS[field.type] for field in ordered).replace("s", "c"), "ascii"
            ),
            "orders": [ordered.index(field) for field in fields],
            "lengths": [1 if field.type == "char" else max(field.length, 1) for field in ordered],
            "array_lengths": [field.length for field in ordered],
            "crc_extra": crc_extra(name, ordered),
            "unpacker": struct.Struct(layout),
        },
    )


DRAFT_MESSAGES = {message_id: _draft(message_id, name, fields) for message_id, name, fields in _DRAFTS}
"""The messages' classes by id; their constructors take the fields in order."""


mavlink.mavlink_map.update(DRAFT_MESSAGES)

COMMAND_CANCEL_ID, COMPONENT_INFORMATION_BASIC_ID, COMPONENT_METADATA_ID = 80, 396, 397
"""Of drafts, which the dialect has no names for."""
MAV_RESULT_CANCELLED = 6
"""Of a draft, which the dialect has no name for."""


_OFFSET_BASIS = 0x811C9DC5
_PRIME = 0x01000193
_EVENT_BITS = 0x00FF_FFFF
_AUTOPILOT = 1 << 24


def event_id(name: str) -> int:
    """Return the id of the autopilot's event called `name`."""
    value = _OFFSET_BASIS
    for byte in name.encode("ascii"):
        value = (value ^ byte) * _PRIME & 0xFFFF_FFFF
    return value & _EVENT_BITS | _AUTOPILOT
