"""Names the links by which a stranger could take part in a landing."""

from link.transports.device import opening_of
from link.zenoh.library_config import openings
from link.zenoh.options import ZenohOptions


def open_links(zenoh: ZenohOptions, device: str, *, signs: bool) -> tuple[str, ...]:
    """Return which links are open to somebody without a key, in words.

    Args:
        zenoh: how the Zenoh session was opened.
        device: of the MAVLink link.
        signs: whether MAVLink is signed.
    """
    mavlink = opening_of(device, signs=signs)
    return (*openings(zenoh), *(() if mavlink is None else (mavlink,)))
