"""A client of MAVLink FTP for tests, in bytes only."""

import struct
from collections.abc import Callable

from link.ftp.wire import DATA_MAX, Opcode
from link.mavlink.dialect import Message, mavlink

_HEAD = struct.Struct("<HBBBBBxI")


class FileClient:
    """It asks one question after the other; `told` is an answer's opcode, session, offset and data.

    Args:
        exchange: sends a message to the server and returns what comes back at once.
        target: the server's system and component.
    """

    def __init__(self, exchange: Callable[[Message], list[Message]], target: tuple[int, int] = (1, 1)) -> None:
        self._exchange, self._target = exchange, target
        self.sequence = 0
        self.session = 0

    def send(self, opcode: Opcode, data: bytes = b"", *, offset: int = 0, size: int | None = None) -> list[Message]:
        """Send a question and return the answers of this step."""
        head = _HEAD.pack(self.sequence, self.session, opcode, len(data) if size is None else size, 0, 0, offset)
        self.sequence += 2
        payload = list((head + data).ljust(_HEAD.size + DATA_MAX, b"\0"))
        replies = self._exchange(mavlink.MAVLink_file_transfer_protocol_message(0, *self._target, payload))
        return [reply for reply in replies if reply.get_type() == "FILE_TRANSFER_PROTOCOL"]

    def ask(self, opcode: Opcode, data: bytes = b"", *, offset: int = 0, size: int | None = None) -> tuple[int, bytes]:
        """Ask, and return whether it was granted, as the opcode says, and the data."""
        (answer,) = self.send(opcode, data, offset=offset, size=size)
        return told(answer)[0], told(answer)[3]

    def names(self, path: bytes = b"/") -> list[str]:
        """The lines of a listing, without the entries to be skipped."""
        listed: list[bytes] = []
        while True:
            opcode, data = self.ask(Opcode.LIST_DIRECTORY, path, offset=len(listed))
            if opcode == Opcode.NAK:
                return [line.decode() for line in listed if line != b"S"]
            listed += filter(None, data.split(b"\0"))

    def read(self, path: bytes) -> bytes:
        """A whole file, read piece by piece."""
        opcode, _ = self.ask(Opcode.OPEN_FILE_RO, path)
        assert opcode == Opcode.ACK
        data = b""
        while True:
            opcode, part = self.ask(Opcode.READ_FILE, offset=len(data), size=DATA_MAX)
            if opcode == Opcode.NAK:
                break
            data += part
        self.ask(Opcode.TERMINATE_SESSION)
        return data


def told(answer: Message) -> tuple[int, int, int, bytes]:
    """Opcode, session, offset and data of an answer."""
    payload = bytes(answer.payload)
    _, session, opcode, size, _, _, offset = _HEAD.unpack_from(payload)
    return opcode, session, offset, payload[_HEAD.size :][:size]
