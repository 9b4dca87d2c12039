"""The source of frames that a user names."""

from dataclasses import dataclass
from pathlib import Path

from companion.eyes.capture_source import CaptureSource
from companion.eyes.file_source import FolderSource
from companion.eyes.frames import Source
from companion.eyes.zenoh_source import ZenohSource
from link.program.clock import SystemClock
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession

_ZENOH = "zenoh"


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceOptions:
    """How a source is opened: the size to ask a camera for, its latency, and the rate of pictures without times."""

    size_px: tuple[int, int] | None
    latency_s: float
    rate_hz: float


def open_source(address: str, options: SourceOptions, keys: Keys, zenoh: ZenohSession) -> Source:
    """Return the source at `address`: `zenoh`, a folder, or what OpenCV captures.

    Raises:
        UserError: there is none, or it gives no pictures.
    """
    if address == _ZENOH:
        return ZenohSource(zenoh, keys)
    clock = SystemClock()
    if Path(address).is_dir():
        return FolderSource(Path(address), start_ns=clock.now_ns(), rate_hz=options.rate_hz)
    return CaptureSource(address, clock, latency_s=options.latency_s, size_px=options.size_px)
