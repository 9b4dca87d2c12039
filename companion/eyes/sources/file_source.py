"""Frames from a folder of pictures, one after the other."""

from pathlib import Path

from companion.eyes.sources.frames import Captured, gray_of_file
from link.errors import UserError
from link.messages import CompressedPicture
from link.payloads.checks import PayloadError
from link.units import NS_PER_S

_SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm"}
_STAMP_DIGITS = range(15, 20)  # are a stamp in nanoseconds, as EuRoC's and kalibr's folders have them; more are a date


class FolderSource:
    """The pictures of a folder in the order of their names, each as soon as it is asked for.

    A name that is a number of nanoseconds is the picture's time; others follow each other at a rate.

    Args:
        folder: of the pictures.
        start_ns: time of the first one, where names tell none.
        rate_hz: of the pictures, where names tell no time.
        latency_s: by which the times in names are late.

    Raises:
        UserError: there is no picture in it.
    """

    is_live = False

    def __init__(self, folder: Path, *, start_ns: int, rate_hz: float, latency_s: float = 0.0) -> None:
        self.name = str(folder)
        self._files = sorted(path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES)
        if not self._files:
            raise UserError(f"{folder}: there is no picture in it ({', '.join(sorted(_SUFFIXES))})")
        self._start_ns = start_ns
        self._latency_ns = round(latency_s * NS_PER_S)
        self._period_ns = NS_PER_S / rate_hz
        self._next = 0
        self.refused_why: str | None = None

    def take(self, timeout_s: float) -> Captured | None:  # noqa: ARG002 (a file is there at once)
        """Return the next picture; one that cannot be read is passed over, and told by `refused_why`."""
        while self._next < len(self._files):
            path, index = self._files[self._next], self._next
            self._next += 1
            t_ns = self._time_of(path, index)
            try:
                picture = CompressedPicture(t_ns=t_ns, format=path.suffix[1:], data=path.read_bytes())
                return Captured(t_ns=t_ns, shades=gray_of_file(picture))
            except (OSError, PayloadError) as error:
                self.refused_why = f"{path.name}: {error}"
        return None

    def _time_of(self, path: Path, index: int) -> int:
        if path.stem.isdigit() and len(path.stem) in _STAMP_DIGITS:
            return int(path.stem) - self._latency_ns
        return self._start_ns + round(index * self._period_ns)

    def has_ended(self) -> bool:
        """Return whether the last picture was taken."""
        return self._next >= len(self._files)

    def restart(self) -> None:
        """Do nothing: files do not stop."""

    def close(self) -> None:
        """Do nothing: each file is closed once it is read."""
