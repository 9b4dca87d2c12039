"""The companion's files over MAVLink FTP: its metadata, which clients can only read."""

from companion.component.metadata import shown_files
from link.ftp.server import answer, burst_on
from link.ftp.state import NO_FTP, FtpRules
from link.ftp.wire import question_from_message
from link.mavlink.dialect import Message

_RULES = FtpRules(is_read_only=True, burst_a_step=1)  # setpoints share the link


class FileServer:
    """Answers clients, one after the other."""

    def __init__(self) -> None:
        self._ftp = NO_FTP

    def answer(self, message: Message, local_ns: int) -> tuple[Message, ...]:
        """Take a FILE_TRANSFER_PROTOCOL; return its answer."""
        self._ftp, answers = answer(self._ftp, question_from_message(message), shown_files(), _RULES, local_ns)
        return answers

    def continue_burst(self) -> tuple[Message, ...]:
        """Return what of a burst under way goes now."""
        self._ftp, messages = burst_on(self._ftp, _RULES)
        return messages
