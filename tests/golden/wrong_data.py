"""Vehicles that send what is not so, for flights that are to be broken off."""

from link.messages import FixVelocity
from link.payloads import cdr
from link.records import replace
from scenarios.faults.flight import FaultFlight


def velocity_is_in_ned(flight: FaultFlight) -> None:
    """Let the vehicle exchange the axes of its velocity from now on."""
    take = flight.companion.receive_sample

    def receive(key: str, payload: bytes) -> None:
        if key.endswith("/fix_velocity"):
            message = cdr.decode(FixVelocity, payload)
            east_m_s, north_m_s, up_m_s = message.velocity_enu_m_s
            payload = cdr.encode(replace(message, velocity_enu_m_s=(north_m_s, east_m_s, -up_m_s)))
        take(key, payload)

    flight.companion.receive_sample = receive  # type: ignore[method-assign]  # what the vehicle sends is changed
