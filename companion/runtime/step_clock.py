"""The two clocks that a step is told: UTC, which may be set, and one that goes as UTC does and is never set."""

from companion.autopilots.link import CLOCK_SET_NS


class StepClock:
    """The time of the newest step.

    Attributes:
        t_ns: UTC; it only goes back where UTC is set back.
        monotonic_ns: for spans of time.
    """

    def __init__(self) -> None:
        self.t_ns = 0
        self.monotonic_ns = 0
        self._utc_ahead_ns = 0  # of the monotonic clock, by what UTC has been set to
        self._local_ns: int | None = None

    def advance(self, utc_ns: int, local_ns: int) -> None:
        """Take the time of a step.

        The map to UTC is refined all the time, and the step's own time never goes back with it. Where UTC is set, or
        becomes known, only UTC is: the monotonic time goes on, and so does the flight.

        Args:
            utc_ns: now, as far as it is known.
            local_ns: now, on the companion's own clock.
        """
        if self._local_ns is None:
            self._utc_ahead_ns = utc_ns - local_ns
        else:
            set_by_ns = utc_ns - (self.t_ns + local_ns - self._local_ns)
            if abs(set_by_ns) > CLOCK_SET_NS:
                self.t_ns += set_by_ns
                self._utc_ahead_ns += set_by_ns
        self.t_ns = max(self.t_ns + 1, utc_ns)
        self.monotonic_ns = self.t_ns - self._utc_ahead_ns
        self._local_ns = local_ns
