"""The loop of a real vehicle: a transport, a receiver and Zenoh, nothing else."""

import signal
import time

from link.errors import UserError
from link.messages import Fix, FixVelocity, PadGeometry, VehicleImu
from link.payloads import cdr, json_messages
from link.payloads.cdr import encoding_of
from link.payloads.checks import PayloadError
from link.program.service import Service
from link.recording.log import Log
from link.transports.tcp_transport import TcpClientTransport
from link.transports.transport import Transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.vehicle_sources.channel import FileTransport, OpenTransport
from scenarios.vehicle_sources.health import Health
from scenarios.vehicle_sources.receiver import Reading, Receiver

_WAIT_S = 0.1  # for bytes; a signal is seen within it
_GAP_MAX_S, _BACK_MAX_S = 60.0, 1.0  # between readings of a recording; a receiver begins with a date that is years off


class ReceiverLoop:
    """Publishes what a receiver tells until a signal comes or a recording ends.

    Args:
        receiver: that understands the bytes.
        open_transport: opens the device, and again when it has fallen silent.
        device: its name in messages.
        keys: of the Zenoh contract.
        zenoh: an open session.
        pad: that the vehicle tells.
        service: the service manager.
        log: whose lines cost the loop nothing.

    Raises:
        UserError: the device cannot be opened.
    """

    def __init__(
        self,
        receiver: Receiver,
        open_transport: OpenTransport,
        device: str,
        *,
        keys: Keys,
        zenoh: ZenohSession,
        pad: PadGeometry,
        service: Service,
        log: Log,
    ) -> None:
        self._receiver = receiver
        self._open = open_transport
        self._device = device
        self._zenoh = zenoh
        self._service = service
        self._keys = {Fix: keys.fix, FixVelocity: keys.fix_velocity, VehicleImu: keys.imu}
        self._stopping = False
        self._was_connected = False
        self._unsendable = self._fixes = 0
        self._began: tuple[int, float] | None = None  # a recording: its first stamp, and when that was told
        self._newest_ns = 0  # of a recording, the stamp that was told last
        self._log = log
        payload = json_messages.encode(pad)
        zenoh.serve(keys.pad, lambda _: payload)
        zenoh.declare_alive(keys.alive)

    def run(self) -> None:
        """Run until a signal asks for the end, or to the end of a recording.

        Raises:
            UserError: a recording holds no fix.
        """
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        transport = self._open()
        try:
            health = Health(self._device, time.monotonic_ns())
            self._log.info("ready", device=self._device)
            while not self._stopping:
                self._turn(transport, health)
                if isinstance(transport, FileTransport):
                    self._stopping = self._stopping or transport.is_at_end
                elif isinstance(transport, TcpClientTransport) and health.is_silent(time.monotonic_ns()):
                    health.closed(time.monotonic_ns())
                    transport = self._open_again(transport)
        finally:
            transport.close()
        self._service.stopping()
        self._service.close()
        self._log.info("stopped", fixes=self._fixes, unsendable=self._unsendable, **self._receiver.counts)
        if isinstance(transport, FileTransport) and transport.is_at_end and not self._fixes:
            raise UserError(f"{self._device}: holds no fix; name a recording of what a receiver sends")

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def _open_again(self, transport: Transport) -> Transport:
        """Return a new transport: the old one may be a connection whose other end has gone without a word."""
        self._was_connected = False
        try:
            opened = self._open()
        except UserError as error:  # its name is unknown for now
            self._log.warning("cannot be opened now", error=str(error))
            return transport
        transport.close()
        return opened

    def _turn(self, transport: Transport, health: Health) -> None:
        """Send what is due, wait for bytes, publish what they tell."""
        is_connected = transport.fileno() >= 0
        if is_connected and not self._was_connected:
            self._receiver.connected()
        self._was_connected = is_connected
        if is_connected and (request := self._receiver.to_send(time.monotonic_ns())):
            transport.send(request)
        data = transport.receive(_WAIT_S)
        now_ns = time.monotonic_ns()
        readings = self._receiver.take(data, now_ns) if data else []
        if isinstance(transport, FileTransport):
            self._publish_in_time(readings)
        else:
            self._publish(readings)
        has_fix = any(isinstance(reading, Fix) for reading in readings)
        news = health.update(
            now_ns,
            is_connected=transport.fileno() >= 0,
            heard=bool(data),
            has_fix=has_fix,
            complaint=self._receiver.complaint,
        )
        if news is not None:
            (self._log.info if news.is_good else self._log.warning)(news.text)
            self._service.status(news.text)
        if has_fix:
            self._service.ready()
        self._service.alive(now_ns)

    def _publish(self, readings: list[Reading]) -> None:
        for reading in readings:
            try:
                payload = cdr.encode(reading)
            except PayloadError:
                self._unsendable += 1
                continue
            self._zenoh.publish(self._keys[type(reading)], payload, encoding_of(type(reading)))
            self._fixes += isinstance(reading, Fix)

    def _publish_in_time(self, readings: list[Reading]) -> None:
        """Publish a recording's readings as far apart as they were; where its clock was set, it goes on at once."""
        for reading in readings:
            passed_s = (reading.t_ns - self._newest_ns) * 1e-9
            if self._began is None or not -_BACK_MAX_S <= passed_s <= _GAP_MAX_S:
                self._began = (reading.t_ns, time.monotonic())
            self._newest_ns = reading.t_ns
            first_ns, told_s = self._began
            while not self._stopping and (wait_s := told_s + (reading.t_ns - first_ns) * 1e-9 - time.monotonic()) > 0.0:
                self._zenoh.wake_up.wait(min(wait_s, _WAIT_S))
                self._service.alive(time.monotonic_ns())
            if not self._stopping:
                self._publish([reading])
