"""Payloads on the companion's keys that it should not mind: random, cut, bit-flipped, and with absurd numbers."""

import random
import struct
from collections.abc import Iterator

from link.messages import Command, Fix, FixVelocity, Order, PadGeometry, PadSighting, Station, VehicleImu
from link.payloads import cdr, json_messages
from link.zenoh.keys import Keys

_BYTES_MAX = 300
_FLIPS_MAX = 8
_HEAD_BYTES = 4
_WEIRD = tuple(
    struct.pack("<d", value) for value in (float("nan"), float("inf"), -float("inf"), 1.8e308, -1.8e308, 5e-324, 0.0)
)
_LEVEL = (1.0, 0.0, 0.0, 0.0)
_SURE = (0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01)


def noise_payload(rng: random.Random) -> bytes:
    """Return bytes that are no message."""
    return rng.choice((b"", b"\0\1\0\0", b"{")) + rng.randbytes(rng.randrange(_BYTES_MAX))


def forged_samples(
    rng: random.Random, keys: Keys, t_ns: int, place_rad_m: tuple[float, float, float]
) -> Iterator[tuple[str, bytes]]:
    """Yield a sample for each key of the vehicle and of the detector, spoiled, as if taken about `t_ns` (UTC).

    Args:
        rng: of what is spoiled, and how.
        keys: of the Zenoh contract.
        t_ns: about now.
        place_rad_m: latitude, longitude and altitude of the vehicle.
    """
    stamp_ns = t_ns + rng.randrange(-2_000_000_000, 600_000_000)
    latitude_rad, longitude_rad, altitude_m = place_rad_m
    messages: dict[str, cdr.Message] = {
        keys.fix: Fix(t_ns=stamp_ns, latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m),
        keys.fix_velocity: FixVelocity(
            t_ns=stamp_ns, velocity_enu_m_s=(5.0, 0.3, 0.1), velocity_covariance_enu_m2_s2=_SURE
        ),
        keys.imu: VehicleImu(t_ns=stamp_ns, orientation_wxyz=_LEVEL, orientation_covariance_rad2=_SURE),
        keys.pad_pose: PadSighting(
            t_ns=stamp_ns, position_flu_m=(3.0, 0.5, -4.0), orientation_wxyz=_LEVEL, position_covariance_m2=_SURE
        ),
    }
    for key, message in messages.items():
        yield key, spoiled(rng, cdr.encode(message))


def forged_json(rng: random.Random) -> bytes:
    """Return a command or a pad's description, spoiled."""
    pad = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.5, 0.0, 0.1))
    follow = Order(command=Command.FOLLOW, station=Station(offset_m=(-5.0, 2.0, 3.0)))
    orders = [Order(command=command) for command in Command if command is not Command.FOLLOW]
    messages: tuple[json_messages.Message, ...] = (pad, follow, *orders)
    return spoiled(rng, json_messages.encode(rng.choice(messages)))


def spoiled(rng: random.Random, payload: bytes) -> bytes:
    """Return a payload with flipped bits, with numbers that are absurd or none, cut, or as it is."""
    changed = bytearray(payload)
    match rng.randrange(4):
        case 0:
            for _ in range(rng.randint(1, _FLIPS_MAX)):
                changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
        case 1 if len(changed) > _HEAD_BYTES + 8:
            for _ in range(rng.randint(1, _FLIPS_MAX)):
                place = _HEAD_BYTES + 8 * rng.randrange((len(changed) - _HEAD_BYTES) // 8)
                changed[place : place + 8] = rng.choice(_WEIRD)
        case 2:
            del changed[rng.randrange(len(changed)) :]
        case _:
            pass
    return bytes(changed)
