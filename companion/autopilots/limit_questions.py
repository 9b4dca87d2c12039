"""Which of the autopilot's limits still have to be asked for; without I/O.

A limit that was never told is flown without, as if there were none, so what is known by none of its names is asked for
again, for as long as that takes. Some firmware has no parameter of one name or another: then the question costs little.
"""

from collections.abc import Set as AbstractSet

from companion.autopilots.driver import Driver

_ASK_AGAIN_NS = 5_000_000_000  # after six questions without an answer, as over a link that was silent


def named(driver: Driver) -> tuple[tuple[str, ...], ...]:
    """Return the parameters that the flight depends on, each by all of its names."""
    return (*driver.limit_names, *driver.gain_names, (driver.timeout_parameter,))


class LimitQuestions:
    """The questions that had no answer."""

    def __init__(self) -> None:
        self._due_ns: dict[str, int] = {}

    def unanswered(self, name: str, local_ns: int) -> None:
        """Take note that the autopilot has not answered for `name`."""
        self._due_ns[name] = local_ns + _ASK_AGAIN_NS

    def due(self, driver: Driver, known: AbstractSet[str], local_ns: int) -> list[str]:
        """Return the names to be asked for now, each once.

        Args:
            driver: of the autopilot.
            known: names of the parameters that it has told.
            local_ns: local time now.
        """
        due = [name for name, due_ns in self._due_ns.items() if local_ns >= due_ns]
        for name in due:
            del self._due_ns[name]
        return [name for name in due if any(name in names and known.isdisjoint(names) for names in named(driver))]
