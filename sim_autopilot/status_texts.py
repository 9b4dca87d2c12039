"""STATUSTEXT: what the autopilot says in words."""

from link.mavlink.dialect import Message, mavlink

_TEXT_BYTES = 50


def status_text(severity: int, text: str) -> Message:
    """Return a STATUSTEXT; what is longer than 50 bytes is cut off."""
    return mavlink.MAVLink_statustext_message(severity, text.encode()[:_TEXT_BYTES])


def status_texts(severity: int, text: str, number: int) -> tuple[Message, ...]:
    """Return the STATUSTEXTs of a text; a long one comes in pieces that `number`, not 0, holds together."""
    encoded = text.encode()
    if len(encoded) <= _TEXT_BYTES:
        return (status_text(severity, text),)
    pieces = range(0, len(encoded), _TEXT_BYTES)
    return tuple(
        mavlink.MAVLink_statustext_message(severity, encoded[begin : begin + _TEXT_BYTES], number, place)
        for place, begin in enumerate(pieces)
    )
