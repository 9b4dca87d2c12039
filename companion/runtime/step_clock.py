"""When a step is made, and its two times: UTC, and a monotonic clock that runs at UTC's rate."""

from companion.autopilots.link import CLOCK_SET_NS

_EARLY = 0.75  # of a period: a new state of the drone starts the next step from here on
_LATE = 2.0  # periods without a new state after which the step is made without one


class StepClock:
    """The time of the newest step, and of the next.

    Args:
        rate_hz: of the steps.

    Attributes:
        t_ns: UTC; it only goes back where UTC is set back.
        monotonic_ns: for spans of time.
    """

    def __init__(self, rate_hz: float) -> None:
        self.t_ns = 0
        self.monotonic_ns = 0
        self._utc_ahead_ns = 0  # of the monotonic clock, by what UTC has been set to
        self._local_ns: int | None = None
        self._own_ns: int | None = None
        self._rate_hz = rate_hz

    def is_due(self, local_ns: int, own_ns: int | None) -> bool:
        """Return whether it is time for a step: one follows each new state of the drone, and waits no longer than that.

        Args:
            local_ns: now, on the companion's own clock.
            own_ns: of the drone's newest state.
        """
        if self._local_ns is None:
            return True
        periods = (local_ns - self._local_ns) * 1e-9 * self._rate_hz
        return periods >= (_EARLY if own_ns is not None and own_ns != self._own_ns else _LATE)

    def advance(self, utc_ns: int, local_ns: int, own_ns: int | None) -> None:
        """Take the time of a step.

        The map to UTC is refined all the time, and the step's own time never goes back with it. Where UTC is set, or
        becomes known, only UTC is: the monotonic time goes on, and so does the flight.

        Args:
            utc_ns: now, as far as it is known.
            local_ns: now, on the companion's own clock.
            own_ns: of the drone's state that the step begins with.
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
        self._local_ns, self._own_ns = local_ns, own_ns
