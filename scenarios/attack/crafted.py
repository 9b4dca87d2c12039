"""Bytes that are made to be slow to decode."""

import random
import statistics
import time
from collections.abc import Iterator, Mapping

from link.mavlink.codec import MavlinkCodec
from scenarios.attack.attempt import Attempt

DATAGRAM_BYTES = 65_000  # about the largest
COST_MAX = 5.0
"""Times what as many random bytes cost."""
CRAFTED: Mapping[str, bytes] = {
    "version 1 markers": b"\xfe",
    "version 2 markers": b"\xfd",
    "version 1 frames of 254 bytes, one in three bytes": b"\xfe\xfe\x6e",
    "version 1 heartbeats, one in three bytes": b"\xfe\x09\x00",
    "version 2 heartbeats of 255 bytes, one in five bytes": b"\xfd\xff\0\0\0",
    "unknown messages without a payload": b"\xfd" + bytes(6) + b"\xfd\0\xfd\0\0",
}
"""What is repeated, by a name."""
_TRIES = 7  # of which the quickest count: what else the machine does only adds


def datagram_of(kind: str) -> bytes:
    """Return the largest datagram of one of `CRAFTED`."""
    pattern = CRAFTED[kind]
    return (pattern * (DATAGRAM_BYTES // len(pattern) + 1))[:DATAGRAM_BYTES]


def cost_ratio(kind: str, *, is_datagram: bool) -> float:
    """Return how many times as much processor time crafted bytes take as random ones, the median of pairs."""
    noise = random.Random(3).randbytes(DATAGRAM_BYTES)  # noqa: S311 (reproducible, not secret)
    crafted = datagram_of(kind)
    return statistics.median(
        _cost_s(crafted, is_datagram=is_datagram) / _cost_s(noise, is_datagram=is_datagram) for _ in range(_TRIES)
    )


def _cost_s(data: bytes, *, is_datagram: bool) -> float:
    codec, began_s = MavlinkCodec(1, 191), time.process_time()
    codec.decode(data, is_datagram=is_datagram)
    return time.process_time() - began_s


def attempts() -> Iterator[Attempt]:
    """Decode each kind, as datagrams and as a stream."""
    expected = f"costs at most {COST_MAX:g} times what random bytes do"
    for is_datagram in (True, False):
        for kind in CRAFTED:
            ratio = cost_ratio(kind, is_datagram=is_datagram)
            yield Attempt(
                by="MAVLink, datagrams" if is_datagram else "MAVLink, a stream",
                what=f"{DATAGRAM_BYTES} bytes of {kind}",
                expected=expected,
                seen=expected if ratio < COST_MAX else f"costs {ratio:.1f} times what random bytes do",
            )
