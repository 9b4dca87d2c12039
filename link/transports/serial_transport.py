"""A serial port, opened again when its plug was out for a while."""

import errno
import os
import termios
import time
from typing import Any

from link.errors import UserError
from link.transports.device import SerialDevice
from link.transports.send_queue import WAITING_MAX_S, SendQueue
from link.transports.transport import Transport, held_bytes, wait_readable

_REOPEN_S = 1.0
_BITS_PER_BYTE = 10  # with start and stop bit


class SerialTransport(Transport):
    """A serial port with 8 data bits, no parity, one stop bit.

    Args:
        device: its path and baud rate.

    Raises:
        UserError: It is missing, not ours to use, open in another program, or does not know the baud rate.
    """

    def __init__(self, device: SerialDevice) -> None:
        super().__init__()
        self._device = device
        self._next_attempt_s = 0.0
        self._queue = SendQueue()
        try:
            self._port: Any = _open(device)
        except (OSError, ValueError) as error:
            raise UserError(f"{device}: {_problem(error, device)}") from error

    def receive(self, timeout_s: float) -> bytes:
        """Waits for bytes and takes all that are there."""
        if self._port is None:
            self._reopen(timeout_s)
            return b""
        self._flush()
        try:
            if not wait_readable(self.fileno(), timeout_s):
                return b""
            received: bytes = self._port.read(max(self._port.in_waiting, 1))
        except OSError:
            self._lose()
            return b""
        return received

    def send(self, data: bytes) -> None:
        """Sends bytes if there is somebody to send them to."""
        if self._port is None or not self._queue.put(data, time.monotonic()):
            self._dropped += 1
        self._flush()

    def _flush(self) -> None:
        """Sends what the line takes and keeps the rest; pyserial's own write would spin on a full line."""
        if self._port is None:
            return
        now_s = time.monotonic()
        try:
            self._dropped += self._queue.write(self._write, now_s)
            if not self._queue.is_overdue(held_bytes(self.fileno()), now_s):
                return
            self._port.reset_output_buffer()  # else it arrives late, and closing would wait for it
        except (OSError, termios.error):
            pass  # the port is lost, which ends it just so
        self._dropped += len(self._queue)
        self._lose()

    def _write(self, data: bytes) -> int:
        """Gives the system no more than the line takes in time: there a slow line's frames would grow old unseen."""
        if held_bytes(self.fileno()) > self._device.baud / _BITS_PER_BYTE * WAITING_MAX_S:
            raise BlockingIOError
        return os.write(self.fileno(), data)

    def fileno(self) -> int:
        """The descriptor to wait on for input, -1 while there is none."""
        return -1 if self._port is None else int(self._port.fileno())

    def close(self) -> None:
        """Gives the device back."""
        if self._port is not None:
            self._port.close()
        self._port = None
        self._queue = SendQueue()
        self._next_attempt_s = float("inf")

    def _lose(self) -> None:
        self._errors += 1
        self.close()
        self._next_attempt_s = time.monotonic() + _REOPEN_S

    def _reopen(self, timeout_s: float) -> None:
        pause_s = self._next_attempt_s - time.monotonic()
        if pause_s > 0.0:
            wait_readable(-1, min(pause_s, timeout_s))
            return
        try:
            self._port = _open(self._device)
        except (OSError, ValueError):
            self._errors += 1
            self._next_attempt_s = time.monotonic() + _REOPEN_S


def _open(device: SerialDevice) -> Any:
    # Imported here, since a flight over UDP needs no serial port. SerialException is an OSError.
    import serial  # noqa: PLC0415 (see above)

    try:
        # Two programs on one port would get half of the stream each.
        return serial.Serial(device.path, device.baud, timeout=0, exclusive=True)
    except termios.error as error:  # of a port that goes while it is opened, which pyserial lets through
        raise OSError(*error.args) from error


def _problem(error: OSError | ValueError, device: SerialDevice) -> str:
    if not os.path.exists(device.path):  # noqa: PTH110 - a device node, not a file of ours
        return "there is no such device; is it plugged in?"
    if not os.access(device.path, os.R_OK | os.W_OK):
        return "no permission; join the group that owns it, often dialout"
    if isinstance(error, OSError) and error.errno == errno.EWOULDBLOCK:
        return "another program has it open; end that one first, a companion that runs as a service perhaps"
    return f"cannot be opened as a serial port ({error}); check path and baud rate"
