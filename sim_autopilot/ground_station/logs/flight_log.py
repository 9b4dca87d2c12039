"""The log of a flight: rows of where the drone was, as ULog for PX4 and as DataFlash for ArduCopter.

Source: ULog file format, https://docs.px4.io/main/en/dev_log/ulog_file_format.html; DataFlash: the FMT message of
ArduPilot's logs. Only position, velocity and attitude are in it: what the autopilot believed, in NED.
"""

import struct
from collections.abc import Callable
from math import degrees

from msgspec import Struct

_ULOG_MAGIC = b"ULog\x01\x12\x35\x01"
_ULOG_ROW = struct.Struct("<HQ7f")
_ULOG_POSITION = "vehicle_local_position"
_ULOG_FIELDS = "uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;float heading;"
_DATAFLASH_HEAD = b"\xa3\x95"
_FMT, _POSITION, _ATTITUDE = 128, 129, 130
_FMT_BODY = struct.Struct("<BB4s16s64s")
_POSITION_BODY = struct.Struct("<Qiiff")
_ATTITUDE_BODY = struct.Struct("<Qfff")


class Row(Struct, frozen=True, kw_only=True):
    """One moment of a flight: ns since boot, NED about the origin, roll, pitch and yaw, and where on the globe."""

    boot_ns: int
    position_ned_m: tuple[float, float, float]
    velocity_ned_m_s: tuple[float, float, float]
    attitude_rad: tuple[float, float, float]
    latitude_e7: int
    longitude_e7: int
    altitude_m: float


def ulog_head(first: Row) -> bytes:
    """Return what stands before the rows in a log of PX4."""
    parts = [_ULOG_MAGIC, struct.pack("<Q", first.boot_ns // 1000), _ulog_message(b"B", bytes(40))]
    parts.append(_ulog_message(b"F", f"{_ULOG_POSITION}:{_ULOG_FIELDS}".encode()))
    parts += [_ulog_information("sys_name", "PX4"), _ulog_information("ver_hw", "PX4_SITL")]
    parts.append(_ulog_message(b"A", struct.pack("<BH", 0, 0) + _ULOG_POSITION.encode()))
    return b"".join(parts)


def ulog_row(row: Row) -> bytes:
    """Return a row as PX4 logs it."""
    numbers = (*row.position_ned_m, *row.velocity_ned_m_s, row.attitude_rad[2])
    return _ulog_message(b"D", _ULOG_ROW.pack(0, row.boot_ns // 1000, *numbers))


def _ulog_message(kind: bytes, body: bytes) -> bytes:
    return struct.pack("<H", len(body)) + kind + body


def _ulog_information(name: str, value: str) -> bytes:
    key = f"char[{len(value)}] {name}".encode()
    return _ulog_message(b"I", bytes([len(key)]) + key + value.encode())


def dataflash_head(_first: Row) -> bytes:
    """Return what stands before the rows in a log of ArduCopter."""
    return (
        _format(_FMT, _FMT_BODY.size, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns")
        + _format(_POSITION, _POSITION_BODY.size, b"POS", b"QLLff", b"TimeUS,Lat,Lng,Alt,RelOriginAlt")
        + _format(_ATTITUDE, _ATTITUDE_BODY.size, b"ATT", b"Qfff", b"TimeUS,Roll,Pitch,Yaw")
    )


def dataflash_row(row: Row) -> bytes:
    """Return a row as ArduCopter logs it."""
    time_us, up_m = row.boot_ns // 1000, -row.position_ned_m[2]
    place = _POSITION_BODY.pack(time_us, row.latitude_e7, row.longitude_e7, row.altitude_m, up_m)
    attitude = _ATTITUDE_BODY.pack(time_us, *map(degrees, row.attitude_rad))
    return _dataflash_message(_POSITION, place) + _dataflash_message(_ATTITUDE, attitude)


def _dataflash_message(kind: int, body: bytes) -> bytes:
    return _DATAFLASH_HEAD + bytes([kind]) + body


def _format(kind: int, size: int, name: bytes, form: bytes, columns: bytes) -> bytes:
    return _dataflash_message(_FMT, _FMT_BODY.pack(kind, size + 3, name, form, columns))


class LogRules(Struct, frozen=True, kw_only=True):
    """In what the firmwares' logs differ.

    Attributes:
        head: of a file, by its first row.
        row: of a file.
        first_id: of the oldest log.
        told_empty: whether a list without logs is answered, by an entry of zeros.
        only_disarmed: refuses lists and downloads while armed, by this text; empty refuses nothing.
        path: of a log as a file, from when it began and its number.
    """

    head: Callable[[Row], bytes]
    row: Callable[[Row], bytes]
    first_id: int
    told_empty: bool
    only_disarmed: str
    path: str
