"""What a person is told about a receiver: connected, silent, without fix, and fixes again; no I/O."""

from dataclasses import dataclass

_PATIENCE_NS = 5_000_000_000
_REMIND_NS = 30_000_000_000
_SILENT_NS = 10_000_000_000
_LOST_NS = 2_000_000_000  # a connection may be rebuilt in between without a word


@dataclass(frozen=True, slots=True, kw_only=True)
class News:
    """One line for the log."""

    text: str
    is_good: bool


class Health:
    """Follows a receiver.

    Args:
        device: its name in messages.
        t_ns: local time now.
    """

    def __init__(self, device: str, t_ns: int) -> None:
        self._device = device
        self._connected_ns: int | None = None
        self._lost_ns = t_ns - _LOST_NS
        self._waiting_since_ns = t_ns
        self._heard_ns = t_ns
        self._told: str | None = "nothing yet"
        self._told_ns = t_ns

    def is_silent(self, t_ns: int) -> bool:
        """Return whether a connection is there that has brought nothing for so long that it may be a dead one."""
        return self._connected_ns is not None and t_ns - max(self._heard_ns, self._connected_ns) > _SILENT_NS

    def closed(self, t_ns: int) -> None:
        """Take note that the device was closed."""
        self._connected_ns, self._lost_ns = None, t_ns

    def update(
        self, t_ns: int, *, is_connected: bool, heard: bool, has_fix: bool, complaint: str | None
    ) -> News | None:
        """Take what has happened by `t_ns`, and return what is to be said now, if anything.

        Args:
            t_ns: local time now.
            is_connected: whether the device is open.
            heard: whether bytes have come.
            has_fix: whether they told a place.
            complaint: of the receiver.
        """
        if is_connected and self._connected_ns is None:
            self._connected_ns = t_ns
        elif not is_connected and self._connected_ns is not None:
            self.closed(t_ns)
        if heard:
            self._heard_ns = t_ns
        if has_fix:
            self._waiting_since_ns = t_ns
            return self._said(None, f"fixes from {self._device}", t_ns)
        if t_ns - self._waiting_since_ns < _PATIENCE_NS:
            return None
        trouble = self._trouble(t_ns, complaint)
        return self._said(trouble, trouble, t_ns)

    def _trouble(self, t_ns: int, complaint: str | None) -> str:
        if self._connected_ns is None and t_ns - self._lost_ns >= _LOST_NS:
            return (
                f"{self._device} does not answer, trying again: is it plugged in, switched on, and the address right?"
            )
        if t_ns - self._heard_ns >= _PATIENCE_NS:
            return f"nothing is received from {self._device}: check baud rate, cable and the receiver's output"
        return f"no fix from {self._device}: {complaint or 'it has stopped sending its place'}"

    def _said(self, trouble: str | None, text: str, t_ns: int) -> News | None:
        if trouble == self._told and (trouble is None or t_ns - self._told_ns < _REMIND_NS):
            return None
        self._told, self._told_ns = trouble, t_ns
        return News(text=text, is_good=trouble is None)
