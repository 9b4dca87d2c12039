"""Reads parameters by name, asking again until they come or it has been enough."""

from collections.abc import Callable
from dataclasses import dataclass

from link.mavlink.dialect import Message
from link.mavlink.events import ParameterMissing, ParameterRead
from link.mavlink.parameters import NAME_LENGTH_MAX, parameter_value
from link.mavlink.session_config import SessionConfig, duration_ns


@dataclass(slots=True)
class _Question:
    attempts: int
    due_ns: int


class ParameterReader:
    """The parameters asked for.

    Args:
        send: called with a parameter's name to put a PARAM_REQUEST_READ on its way.
        config: patience.
    """

    def __init__(self, send: Callable[[str], None], config: SessionConfig) -> None:
        self.retried = 0
        self._send = send
        self._retry_ns = duration_ns(config.parameter_retry_s)
        self._attempts_max = config.parameter_attempts
        self._questions: dict[str, _Question] = {}

    def read(self, name: str, t_ns: int) -> None:
        """Asks for a parameter, unless it has been asked for already.

        Raises:
            ValueError: No parameter can have this name.
        """
        if not (0 < len(name) <= NAME_LENGTH_MAX and name.isascii()):
            raise ValueError(f"a parameter's name has 1 to {NAME_LENGTH_MAX} ASCII characters, not {name!r}")
        if name not in self._questions:
            self._questions[name] = _Question(attempts=1, due_ns=t_ns + self._retry_ns)
            self._send(name)

    def received(self, message: Message, autopilot: int, t_ns: int) -> list[ParameterRead]:
        """Takes a PARAM_VALUE, which may be one that nobody asked for."""
        name: str = message.param_id
        value = parameter_value(message, autopilot)
        if name not in self._questions or value is None:
            return []
        del self._questions[name]
        return [ParameterRead(t_ns=t_ns, name=name, value=value)]

    def poll(self, t_ns: int) -> list[ParameterMissing]:
        """Asks again for what did not come and gives up what was asked for often enough."""
        due = [(name, question) for name, question in self._questions.items() if t_ns >= question.due_ns]
        return [ParameterMissing(t_ns=t_ns, name=name) for name, question in due if not self._asked_again(name, t_ns)]

    def start_over(self, t_ns: int) -> None:
        """Asks for everything outstanding anew, as after a restart."""
        for name in self._questions:
            self._questions[name] = _Question(attempts=1, due_ns=t_ns + self._retry_ns)
            self._send(name)

    def _asked_again(self, name: str, t_ns: int) -> bool:
        question = self._questions[name]
        if question.attempts >= self._attempts_max:
            del self._questions[name]
            return False
        question.attempts += 1
        question.due_ns = t_ns + self._retry_ns
        self.retried += 1
        self._send(name)
        return True
