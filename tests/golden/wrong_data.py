"""Vehicles that send what is not so, for flights that are to be broken off."""

from collections.abc import Callable
from itertools import count

from link.messages import FixVelocity, PadSighting
from link.payloads import cdr
from link.records import replace
from scenarios.faults.flight import FaultFlight

_BESIDE_M = 2.0
_LATE_NS = 50_000_000  # from the exposure to the picture's arrival


def velocity_is_in_ned(flight: FaultFlight) -> None:
    """Let the vehicle exchange the axes of its velocity from now on."""

    def exchange(payload: bytes) -> bytes:
        message = cdr.decode(FixVelocity, payload)
        east_m_s, north_m_s, up_m_s = message.velocity_enu_m_s
        return cdr.encode(replace(message, velocity_enu_m_s=(north_m_s, east_m_s, -up_m_s)))

    _change(flight, "/fix_velocity", exchange)


def every_third_sighting_is_beside(flight: FaultFlight) -> None:
    """Let the detector take something else for the pad now and then."""
    numbers = count()

    def shift(payload: bytes) -> bytes:
        sighting = cdr.decode(PadSighting, payload)
        x_m, y_m, z_m = sighting.position_flu_m
        beside_m = 0.0 if next(numbers) % 3 else _BESIDE_M
        return cdr.encode(replace(sighting, position_flu_m=(x_m, y_m + beside_m, z_m)))

    _change(flight, "/pad_pose", shift)


def sightings_are_stamped_late(flight: FaultFlight) -> None:
    """Let the detector stamp a picture when it has it, rather than with the time of its exposure."""

    def shift(payload: bytes) -> bytes:
        sighting = cdr.decode(PadSighting, payload)
        return cdr.encode(replace(sighting, t_ns=sighting.t_ns + _LATE_NS))

    _change(flight, "/pad_pose", shift)


def _change(flight: FaultFlight, key_end: str, change: Callable[[bytes], bytes]) -> None:
    take = flight.companion.receive_sample

    def receive(key: str, payload: bytes) -> None:
        take(key, change(payload) if key.endswith(key_end) else payload)

    flight.companion.receive_sample = receive  # type: ignore[method-assign]  # what is sent is changed
