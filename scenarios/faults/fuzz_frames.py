"""Frames that no autopilot should mind: random, truncated, replayed, bit-flipped, and valid ones with absurd fields.

None of them is a valid order to the autopilot under test: what could rightly move the drone is for another system.
"""

import random
from collections.abc import Iterator

from link.mavlink.contents import field_offsets, with_checksum
from link.mavlink.dialect import mavlink

_POOL = 4000
_NOISE_BYTES_MAX = 300
_FLIPS_MAX = 8
_OURS = (1, 1)  # system and component of the autopilot under test
_TARGETS = {"target_system": 0, "target": 0, "target_component": 1}
_QUESTIONS = frozenset(
    {
        mavlink.MAVLINK_MSG_ID_TIMESYNC,
        mavlink.MAVLINK_MSG_ID_PING,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST,
        mavlink.MAVLINK_MSG_ID_MISSION_ACK,
        mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL,
    }
)
"""What may be asked of the autopilot itself, with any fields, without moving it."""
_WEIRD = (b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f", b"\x00\x00\x80\xff", b"\xff\xff\x7f\x7f", b"\xff" * 4, b"\0" * 4)


def fuzz_frames(seed: int, *, forges: bool = False) -> Iterator[bytes]:
    """Yield frames without end; the same ones for the same seed.

    Args:
        seed: of them.
        forges: half of them say that they are the autopilot's.
    """
    rng = random.Random(seed)  # noqa: S311 (reproducible, not secret)
    ids = sorted(mavlink.mavlink_map)
    pool = [_absurd(rng, rng.choice(ids), forges=forges) for _ in range(_POOL)]
    makers = (_replay, _truncate, _flip, _noise)
    while True:
        yield rng.choice(makers)(rng, pool)


def _replay(rng: random.Random, pool: list[bytes]) -> bytes:
    return rng.choice(pool)


def _truncate(rng: random.Random, pool: list[bytes]) -> bytes:
    frame = rng.choice(pool)
    return frame[: rng.randrange(len(frame))]


def _flip(rng: random.Random, pool: list[bytes]) -> bytes:
    frame = bytearray(rng.choice(pool))
    for _ in range(rng.randint(1, _FLIPS_MAX)):
        frame[rng.randrange(len(frame))] ^= 1 << rng.randrange(8)
    return bytes(frame)


def _noise(rng: random.Random, _pool: list[bytes]) -> bytes:
    return rng.randbytes(rng.randrange(_NOISE_BYTES_MAX))


def _absurd(rng: random.Random, message_id: int, *, forges: bool) -> bytes:
    """A frame with a right checksum, its fields random or not even numbers."""
    kind = mavlink.mavlink_map[message_id]
    payload = bytearray(rng.randbytes(kind.unpacker.size))
    for start in range(0, len(payload) - 3, 4):
        if rng.random() < 0.5:
            payload[start : start + 4] = rng.choice(_WEIRD)
    target = _target(rng, message_id)
    for name, offset in field_offsets(message_id).items():
        if name in _TARGETS:
            payload[offset] = target[_TARGETS[name]]
    sender = (rng.randrange(256), rng.randrange(256), rng.randrange(256))  # sequence number, system, component
    if forges and rng.random() < 0.5:
        sender = (sender[0], *_OURS)
    if message_id <= 255 and rng.random() < 0.2:
        head = bytes((mavlink.PROTOCOL_MARKER_V1, len(payload), *sender, message_id))
    else:
        head = bytes((mavlink.PROTOCOL_MARKER_V2, len(payload), 0, 0, *sender)) + message_id.to_bytes(3, "little")
    return with_checksum(head + payload, message_id)


def _target(rng: random.Random, message_id: int) -> tuple[int, int]:
    if message_id in _QUESTIONS and rng.random() < 0.5:
        return _OURS
    return rng.randrange(2, 256), rng.randrange(256)
