"""What a MAVLink FTP server remembers, what a question is answered from, and in what the firmwares' servers differ."""

from dataclasses import dataclass

from link.ftp.store import EMPTY_STORE, Shown, Store, plain_path
from link.ftp.wire import Error, Question
from link.mavlink.dialect import Message


@dataclass(frozen=True, slots=True, kw_only=True)
class FtpRules:
    """In what the firmwares' servers differ.

    Attributes:
        own_session: whether the server, not the client, numbers the session of an open file: always 0.
        busy: refuses to open a second file.
        not_open: refuses to read or write without one.
        unknown: refuses what the server does not know.
        idle_s: after which an open file may be closed for another.
        burst_bytes: of one burst at most.
        burst_of_any_size: whether a client chooses how much each answer of a burst holds.
        burst_a_step: answers of a burst that are sent at once.
        truncates: whether it can cut files.
        is_read_only: whether clients can write nothing.
        entry_end: what follows each entry of a listing: ArduPilot's is twice as long as it need be.
        names_itself: whether a listing begins with two entries to be skipped, for the directory and the one above.
    """

    own_session: bool = True
    busy: Error = Error.NO_SESSIONS_AVAILABLE
    not_open: Error = Error.INVALID_SESSION
    unknown: Error = Error.UNKNOWN_COMMAND
    idle_s: float = 10.0
    burst_bytes: int = 35_000
    burst_of_any_size: bool = False
    burst_a_step: int = 12  # in 10 ms: some 290 kB/s
    truncates: bool = True
    is_read_only: bool = False
    entry_end: bytes = b"\0"
    names_itself: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Opened:
    """The open file: its path, what a reader reads, None for a writer, and the session."""

    path: str
    data: bytes | None
    session: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Burst:
    """A burst under way: where it is and ends, how much an answer holds, the next answer's number, and the client."""

    offset: int
    end: int
    size: int
    sequence: int
    partner: tuple[int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ftp:
    """What the server remembers; `last` is the last small answer, for a client that has missed it."""

    store: Store = EMPTY_STORE
    opened: Opened | None = None
    burst: Burst | None = None
    asked_ns: int = 0
    last: tuple[int, tuple[int, int], Message] | None = None


NO_FTP = Ftp()


class RefusedError(Exception):
    """The server says no, and why."""

    def __init__(self, error: Error) -> None:
        super().__init__(error.name)
        self.error = error


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A question, and what it is answered from."""

    question: Question
    shown: Shown
    rules: FtpRules

    @property
    def path(self) -> str:
        """The path that is asked about."""
        return plain_path(self.question.text.partition("\0")[0])
