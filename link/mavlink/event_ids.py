"""The ids of the autopilot's events: the 32-bit FNV-1a hash of a name, cut to 24 bits, and the component above it.

Source: MAVLink events interface, https://mavlink.io/en/services/events.html; hash: RFC 9923.
"""

_OFFSET_BASIS = 0x811C9DC5
_PRIME = 0x01000193
_NAME_BITS = 0x00FF_FFFF
_AUTOPILOT = 1 << 24


def event_id(name: str) -> int:
    """Return the id of the autopilot's event called `name`."""
    value = _OFFSET_BASIS
    for byte in name.encode("ascii"):
        value = (value ^ byte) * _PRIME & 0xFFFF_FFFF
    return value & _NAME_BITS | _AUTOPILOT
