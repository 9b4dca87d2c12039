"""A periodic timer over a time that is given to it."""


class Timer:
    """Due once each period; a long pause makes it due once, not many times.

    Args:
        period_ns: between two times.
    """

    __slots__ = ("_due_ns", "period_ns")

    def __init__(self, period_ns: int) -> None:
        self.period_ns = period_ns
        self._due_ns: int | None = None

    def is_due(self, t_ns: int) -> bool:
        """Whether it is time; if so, the next time is set."""
        if self._due_ns is not None and t_ns < self._due_ns:
            return False
        in_step_ns = (self._due_ns if self._due_ns is not None else t_ns) + self.period_ns
        self._due_ns = in_step_ns if in_step_ns > t_ns else t_ns + self.period_ns
        return True

    def restart(self) -> None:
        """Makes it due at once."""
        self._due_ns = None
