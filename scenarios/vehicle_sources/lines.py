"""A stream of bytes cut into lines, however it comes in pieces."""

_LINE_BYTES_MAX = 16384  # gpsd's longest report, with all satellites in view, is about 10 kB


class Lines:
    """Collects lines; one that never ends is thrown away and counted in `overlong`."""

    def __init__(self) -> None:
        self.overlong = 0
        self._rest = b""
        self._is_skipping = False

    def clear(self) -> None:
        """Forget the line that has begun."""
        self._rest, self._is_skipping = b"", False

    def take(self, data: bytes) -> list[bytes]:
        """Return the lines that `data` completes, without their ends and without empty ones."""
        *whole, self._rest = (self._rest + data).replace(b"\r", b"\n").split(b"\n")
        if whole and self._is_skipping:
            del whole[0]
            self._is_skipping = False
        if len(self._rest) > _LINE_BYTES_MAX:
            self.overlong += not self._is_skipping
            self._rest, self._is_skipping = b"", True
        return [line for line in whole if line]
