"""Each sender's sequence numbers: what was lost, and what came late."""

NUMBERS = 256
_WINDOW = 128  # a step of less than half the circle is forward, the others are looks back
_ALL_SEEN = (1 << _WINDOW) - 1


class SequenceTracker:
    """Follows one sender's sequence numbers; a message that comes late is taken back from the lost ones."""

    __slots__ = ("_newest", "_seen", "lost")

    def __init__(self) -> None:
        self.lost = 0
        self._newest: int | None = None
        self._seen = _ALL_SEEN  # bit n: the message n before the newest has come

    def follows(self, number: int) -> bool:
        """Return whether a number is the next one."""
        return self._newest is not None and number == (self._newest + 1) % NUMBERS

    def see(self, number: int) -> None:
        """Takes note of one message.

        Args:
            number: its sequence number, 0 to 255.
        """
        if self._newest is None:
            self._newest = number
            return
        step = (number - self._newest) % NUMBERS
        if 0 < step < _WINDOW:
            self._newest = number
            self.lost += step - 1
            self._seen = ((self._seen << step) | 1) & _ALL_SEEN
        else:
            self._look_back(-step % NUMBERS)

    def _look_back(self, steps: int) -> None:
        if steps < _WINDOW and not self._seen >> steps & 1:
            self._seen |= 1 << steps
            self.lost -= 1
