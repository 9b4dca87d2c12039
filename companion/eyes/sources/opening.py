"""The source of frames that a user names."""

from dataclasses import dataclass
from pathlib import Path

from companion.eyes.sources.capture_source import CaptureSource
from companion.eyes.sources.file_source import FolderSource
from companion.eyes.sources.frames import Source
from companion.eyes.sources.picamera_source import PiCameraSource, open_picamera
from companion.eyes.sources.zenoh_source import ZenohSource
from link.errors import UserError
from link.program.clock import DateClock
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession

_ZENOH, _PICAMERA = "zenoh", "picamera"
ARRIVAL_LATENCY_S = 0.03
"""Of a frame that is stamped as it arrives, where nobody has measured it: a frame's time at 30 Hz."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceOptions:
    """How a source is opened: the size and latency of a camera, its readout, and the rate of pictures without times.

    A latency that is None was not measured: what comes with its own times is believed.
    """

    size_px: tuple[int, int] | None
    latency_s: float | None
    rate_hz: float
    readout_s: float = 0.0


def open_source(address: str, options: SourceOptions, keys: Keys, zenoh: ZenohSession) -> Source:
    """Return the source at `address`: `zenoh`, `picamera`, a folder, or what OpenCV captures.

    Raises:
        UserError: there is none, or it gives no pictures.
    """
    own_s = options.latency_s or 0.0
    if address == _ZENOH:
        return ZenohSource(zenoh, keys, latency_s=own_s)
    clock = DateClock()  # a computer without a clock chip gets the date long after its start
    if address == _PICAMERA:
        size_px = options.size_px
        if size_px is None:
            raise UserError("--source picamera needs --size WIDTH HEIGHT: it gives pictures of any size")
        return PiCameraSource(
            lambda: open_picamera(size_px), clock, size_px=size_px, readout_s=options.readout_s, latency_s=own_s
        )
    if Path(address).is_dir():
        return FolderSource(Path(address), start_ns=clock.now_ns(), rate_hz=options.rate_hz, latency_s=own_s)
    arrival_s = ARRIVAL_LATENCY_S if options.latency_s is None else options.latency_s
    return CaptureSource(address, clock, latency_s=arrival_s, size_px=options.size_px)
