"""MAVLink FTP on the wire: the 251 bytes of FILE_TRANSFER_PROTOCOL as questions and answers.

Source: https://mavlink.io/en/services/ftp.html.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum

from link.mavlink.dialect import Message, mavlink

DATA_MAX = 239
_HEAD = struct.Struct("<HBBBBBxI")
_SEQUENCES = 1 << 16


class Opcode(IntEnum):
    """What is asked, and the two answers."""

    NONE = 0
    TERMINATE_SESSION = 1
    RESET_SESSIONS = 2
    LIST_DIRECTORY = 3
    OPEN_FILE_RO = 4
    READ_FILE = 5
    CREATE_FILE = 6
    WRITE_FILE = 7
    REMOVE_FILE = 8
    CREATE_DIRECTORY = 9
    REMOVE_DIRECTORY = 10
    OPEN_FILE_WO = 11
    TRUNCATE_FILE = 12
    RENAME = 13
    CALC_FILE_CRC32 = 14
    BURST_READ_FILE = 15
    ACK = 128
    NAK = 129


class Error(IntEnum):
    """Why something is refused; behind FAIL_ERRNO stands the system's own number."""

    FAIL = 1
    FAIL_ERRNO = 2
    INVALID_DATA_SIZE = 3
    INVALID_SESSION = 4
    NO_SESSIONS_AVAILABLE = 5
    END_OF_FILE = 6
    UNKNOWN_COMMAND = 7
    FILE_EXISTS = 8
    FILE_PROTECTED = 9
    FILE_NOT_FOUND = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What a client asks; `size` is that of the data, or how much it wants to read."""

    sequence: int
    session: int
    opcode: int
    size: int
    offset: int
    data: bytes
    system: int
    component: int

    @property
    def text(self) -> str:
        """The path, or the paths, that the data are."""
        return self.data[: self.size].decode("utf-8", "replace")


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """What answers: the data, or the error and, behind it, a number of the system."""

    session: int
    asked: int
    offset: int = 0
    data: bytes = b""
    is_refusal: bool = False
    is_last_of_burst: bool = False


def question_from_message(message: Message) -> Question:
    """Return what a FILE_TRANSFER_PROTOCOL asks."""
    payload = bytes(message.payload)
    sequence, session, opcode, size, _, _, offset = _HEAD.unpack_from(payload)
    return Question(
        sequence=sequence,
        session=session,
        opcode=opcode,
        size=size,
        offset=offset,
        data=payload[_HEAD.size :],
        system=message.get_srcSystem(),
        component=message.get_srcComponent(),
    )


def reply_message(reply: Reply, sequence: int, system: int, component: int) -> Message:
    """Return the FILE_TRANSFER_PROTOCOL number `sequence` that carries a reply to a client."""
    opcode = Opcode.NAK if reply.is_refusal else Opcode.ACK
    head = _HEAD.pack(
        sequence % _SEQUENCES,
        reply.session,
        opcode,
        len(reply.data),
        reply.asked,
        reply.is_last_of_burst,
        reply.offset,
    )
    payload = list((head + reply.data).ljust(_HEAD.size + DATA_MAX, b"\0"))
    return mavlink.MAVLink_file_transfer_protocol_message(0, system, component, payload)
