"""NMEA sentences of a car that drives east-north-east near Zurich, for the tests of receivers."""

from functools import reduce
from operator import xor

UTC_NS = 1_794_225_600_000_000_000
"""2026-11-09 12:00:00, the first instant; `date -u -d @1794225600` agrees."""
LATITUDE_DEG, LONGITUDE_DEG = 47.0 + 17.11399 / 60.0, 8.0 + 33.91590 / 60.0
ALTITUDE_M = 499.6 + 48.0  # over the sea, and the geoid's
SPEED_KNOTS, COURSE_DEG = 9.719, 77.52
PERIOD_NS = 200_000_000


def sentence(body: str) -> bytes:
    """Return `body` with its checksum."""
    return f"${body}*{reduce(xor, body.encode()):02X}\r\n".encode()


def time_text(index: int) -> str:
    """Return the time of day of instant `index`."""
    fifths = index % 5
    return f"1200{index // 5:02d}.{20 * fifths:02d}"


def epoch(index: int) -> list[bytes]:
    """Return the sentences of one instant, in a receiver's usual order."""
    time = time_text(index)
    return [
        sentence(f"GNGGA,{time},4717.11399,N,00833.91590,E,4,12,0.8,499.6,M,48.0,M,1.0,0000"),
        sentence(f"GNRMC,{time},A,4717.11399,N,00833.91590,E,{SPEED_KNOTS},{COURSE_DEG},091126,,,R"),
        sentence(f"GNGST,{time},0.02,0.030,0.020,30.0,0.0278,0.0229,0.040"),
        sentence("GNHDT,77.6,T"),
    ]


def drive(epochs: int) -> bytes:
    """Return the sentences of `epochs` instants at 5 Hz."""
    return b"".join(b"".join(epoch(index)) for index in range(epochs))
