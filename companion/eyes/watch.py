"""Whether a camera still gives pictures, and whether they still change."""

from enum import Enum

from msgspec import Struct

from companion.eyes.picture import Gray

STOPPED_NS = 400_000_000  # with a turn of the loop half a second
_STEP = 16  # every so many pixels are compared: the noise of a living sensor changes some of them each time


class Failure(Enum):
    """What is wrong with a camera."""

    STOPPED = "no picture comes"
    FROZEN = "the picture does not change"


class CameraWatch(Struct, frozen=True, kw_only=True):
    """When the last frame came and when the picture changed last, on a monotonic clock, and its samples."""

    came_ns: int
    changed_ns: int
    samples: bytes = b""


def note_frame(watch: CameraWatch, shades: Gray, now_ns: int) -> CameraWatch:
    """Return the watch after a frame that came at `now_ns`."""
    samples = shades[::_STEP, ::_STEP].tobytes()
    changed_ns = watch.changed_ns if samples == watch.samples else now_ns
    return CameraWatch(came_ns=now_ns, changed_ns=changed_ns, samples=samples)


def failure_of(watch: CameraWatch, now_ns: int) -> Failure | None:
    """Return what is wrong at `now_ns`, None for nothing."""
    if now_ns - watch.came_ns >= STOPPED_NS:
        return Failure.STOPPED
    return Failure.FROZEN if now_ns - watch.changed_ns >= STOPPED_NS else None
