"""NMEA 0183 sentences as text: checksum, fields, numbers.

Source: NMEA 0183 version 4.11; the checksum is the exclusive or of all bytes between $ and *.
"""

from datetime import UTC, date, datetime
from functools import reduce
from math import radians
from operator import xor
from typing import NamedTuple

from scenarios.vehicle_sources.receiver import drop_implausible

NANOSECONDS_PER_DAY = 86_400 * 10**9
_SECOND_MAX = 60  # a leap second
_DIGITS_NS = 9
_YEAR_DIGITS = 4
_DEGREE_DIGITS = 3


class Sentence(NamedTuple):
    """A sentence: its kind, such as GGA, whoever says it, and its fields."""

    kind: str
    fields: tuple[str, ...]

    def text(self, index: int) -> str:
        """Return a field, empty where the sentence is shorter."""
        return self.fields[index] if index < len(self.fields) else ""

    def number(self, index: int) -> float | None:
        """Return a field as a number, None when it is empty or none."""
        try:
            return drop_implausible(float(self.text(index)))
        except ValueError:
            return None


def parse_sentence(line: bytes) -> Sentence | None:
    """Return the sentence of a line, None when it is broken; a line that begins in the middle of one is read on."""
    body, star, checksum = line[line.rfind(b"$") + 1 :].partition(b"*")
    if not star or b"$" not in line or not body.isascii():
        return None
    if checksum.strip().upper() != b"%02X" % reduce(xor, body, 0):
        return None
    address, *fields = body.decode("ascii").split(",")
    return Sentence(address if address.startswith("P") else address[-3:], tuple(fields))


def time_of_day_ns(text: str) -> int | None:
    """Return hhmmss.sss as nanoseconds since midnight, None when it is no time."""
    whole, _, fraction = text.partition(".")
    if len(whole) != 6 or not whole.isdigit() or (fraction and not fraction.isdigit()):
        return None
    hours, minutes, seconds = int(whole[:2]), int(whole[2:4]), int(whole[4:])
    if hours > 23 or minutes > 59 or seconds > _SECOND_MAX:
        return None
    return (hours * 3600 + minutes * 60 + seconds) * 10**9 + int(fraction[:_DIGITS_NS].ljust(_DIGITS_NS, "0"))


def day_ns(year: int, month: int, day: int) -> int | None:
    """Return the UTC of a day's beginning, None when there is no such day."""
    try:
        found = date(year, month, day)
    except ValueError:
        return None
    return int(datetime(found.year, found.month, found.day, tzinfo=UTC).timestamp()) * 10**9


def date_of(sentence: Sentence) -> int | None:
    """Return the UTC of the beginning of the day that RMC or ZDA names, None when it is not said."""
    if sentence.kind == "RMC":
        text = sentence.text(8)
        parts = (text[:2], text[2:4], "20" + text[4:]) if len(text) == 6 else ("", "", "")
    else:
        parts = (sentence.text(1), sentence.text(2), sentence.text(3))
    if not all(_is_whole(part, _YEAR_DIGITS) for part in parts):
        return None
    return day_ns(int(parts[2]), int(parts[1]), int(parts[0]))


def _is_whole(text: str, digits_max: int) -> bool:
    """Return whether a text is a whole number of so many digits at most; a longer one is none that is meant."""
    return text.isdigit() and len(text) <= digits_max


def angle_rad(value: str, hemisphere: str) -> float | None:
    """Return a latitude (ddmm.mmm) or longitude (dddmm.mmm) with its hemisphere, None when it is none."""
    point = value.find(".") if "." in value else len(value)
    whole, minutes = value[: max(point - 2, 0)], value[max(point - 2, 0) :]
    largest = 90 if hemisphere in ("N", "S") else 180
    if hemisphere not in ("N", "S", "E", "W") or not _is_whole(whole, _DEGREE_DIGITS):
        return None
    if not minutes.replace(".", "", 1).isdigit():
        return None
    degrees = int(whole) + float(minutes) / 60.0
    if degrees > largest or float(minutes) >= 60.0:
        return None
    return radians(-degrees if hemisphere in ("S", "W") else degrees)
