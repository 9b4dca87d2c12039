"""When a step is made, and its two times: UTC, and a monotonic clock that runs at UTC's rate."""

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
        self._utc_set_ns = 0
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

    def advance(self, utc_ns: int, local_ns: int, own_ns: int | None, utc_set_ns: int) -> None:
        """Take the time of a step.

        The map to UTC is refined all the time, and the step's own time never goes back with it. Where UTC is set, or
        becomes known, only UTC is: the monotonic time goes on, and so does the flight.

        Args:
            utc_ns: now, as far as it is known.
            local_ns: now, on the companion's own clock.
            own_ns: of the drone's state that the step begins with.
            utc_set_ns: by how much UTC was set in all, of which `utc_ns` knows.
        """
        if self._local_ns is None:
            self._utc_ahead_ns = utc_ns - local_ns
        else:
            self.t_ns += utc_set_ns - self._utc_set_ns
            self._utc_ahead_ns += utc_set_ns - self._utc_set_ns
        self._utc_set_ns = utc_set_ns
        self.t_ns = max(self.t_ns + 1, utc_ns)
        self.monotonic_ns = self.t_ns - self._utc_ahead_ns
        self._local_ns, self._own_ns = local_ns, own_ns
