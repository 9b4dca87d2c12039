"""The check's loop: a transport, a Zenoh session and the system's clock around the readers."""

import time
from dataclasses import dataclass

from companion.autopilots.choice import check_autopilot
from companion.check.detector import DetectorReader
from companion.check.observation import DetectorFacts, VehicleFacts
from companion.check.reading import Reader
from companion.check.vehicle_reading import VehicleReader
from companion.config.autopilot import UtcOf
from companion.config.integrity import IntegrityConfig
from link.mavlink.parameters import parameter_set_message
from link.mavlink.pinned_peer import PinnedPeer
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import Signing
from link.program.clock import SystemClock
from link.transports.transport import Transport
from link.zenoh.keys import Keys
from link.zenoh.pad_question import PadQuestion
from link.zenoh.session import Inbox, ZenohSession

_WAIT_S = 0.005
_PARAMETERS_MAX_S = 10.0
_PAD_MAX_S = 3.0
_SET_ATTEMPTS = 5
_EQUAL = 1e-4  # parameters are 32-bit floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Inboxes:
    """Where the samples of a vehicle and of a detector arrive."""

    fix: Inbox
    velocity: Inbox
    imu: Inbox
    pad: PadQuestion
    sightings: Inbox


def open_check(
    transport: Transport, device: str, *, system_id: int, signing: Signing | None = None, utc: UtcOf = UtcOf.AUTOPILOT
) -> "CheckSession":
    """Return a conversation that has not begun.

    Args:
        transport: to the autopilot.
        device: its name, for messages.
        system_id: MAVLink's, of the drone.
        signing: by a key shared with the autopilot; None sends unsigned and takes everything.
        utc: whose time of day is taken for it.
    """
    session = MavlinkSession(
        system_id, target_system_id=system_id, signing=signing, takes_own_utc=utc is UtcOf.COMPUTER
    )
    return CheckSession(Reader(session), transport, device)


class CheckSession:
    """A conversation with an autopilot, and with a vehicle beside it.

    Args:
        reader: of the autopilot.
        transport: to it.
        device: its name, for messages.
    """

    def __init__(self, reader: Reader, transport: Transport, device: str) -> None:
        self.reader = reader
        self._transport = transport
        self._peer = PinnedPeer(transport, reader.session)
        self._device = device
        self._clock = SystemClock()  # a session's time never runs back, and the date may be set meanwhile

    def find(self, timeout_s: float) -> None:
        """Wait for the autopilot.

        Raises:
            UserError: there is none within `timeout_s`; 0 waits for ever.
        """
        end_s = time.monotonic() + timeout_s if timeout_s else float("inf")
        while self.reader.session.autopilot is None:
            if time.monotonic() > end_s:
                check_autopilot(self.reader.session, self._device, timeout_s)
            self.turn()

    def listen(
        self, duration_s: float, zenoh: ZenohSession, keys: Keys, config: IntegrityConfig
    ) -> tuple[VehicleFacts, DetectorFacts]:
        """Count messages for `duration_s`, read all parameters, and return what vehicle and detector told meanwhile.

        A vehicle that is heard and has not answered for its pad is listened to for some seconds more.
        """
        self.reader.count_anew(self._clock.now_ns())
        vehicle, detector = VehicleReader(keys.fix, config), DetectorReader()
        detector_alive = zenoh.watch_alive(keys.detector_alive)
        inboxes = Inboxes(
            fix=zenoh.subscribe(keys.fix),
            velocity=zenoh.subscribe(keys.fix_velocity),
            imu=zenoh.subscribe(keys.imu),
            pad=PadQuestion(zenoh, keys.pad),
            sightings=zenoh.subscribe(keys.pad_pose),
        )
        patience_s = time.monotonic() + duration_s + _PARAMETERS_MAX_S
        pad_patience_s = time.monotonic() + duration_s + _PAD_MAX_S
        while time.monotonic() <= patience_s:
            awaits_pad = vehicle.is_heard and not inboxes.pad.is_answered and time.monotonic() <= pad_patience_s
            if self.reader.listened_s >= duration_s and self.reader.parameters_done and not awaits_pad:
                break
            self._hear(vehicle, detector, inboxes)
            self.turn()
        return vehicle.facts(inboxes.pad), detector.facts(is_alive=detector_alive.alive)

    def set_parameter(self, name: str, value: float) -> bool:
        """Write a parameter and return whether the autopilot then says that it has this value."""
        session = self.reader.session
        autopilot, target = session.autopilot, session.target_system_id
        kind = self.reader.parameter_types.get(name)
        if autopilot is None or target is None or kind is None:
            return False
        for _ in range(_SET_ATTEMPTS):
            session.send(parameter_set_message(name, value, kind, autopilot, target))
            now = self._read(name)
            if now is not None and abs(now - value) < _EQUAL:
                return True
        return False

    def read_parameter(self, name: str) -> float | None:
        """Return a parameter's present value, None when the autopilot does not answer for it."""
        return self._read(name)

    def turn(self) -> None:
        """Take what has come and send what is due."""
        received = self._transport.receive_by_peer(_WAIT_S)
        t_ns = self._clock.now_ns()
        for data in self._peer.heard(received):
            self.reader.receive(data, t_ns, is_datagram=self._transport.is_datagram)
        self.reader.poll(t_ns)
        for frame in self.reader.session.take_output():
            self._transport.send(frame)

    def _read(self, name: str) -> float | None:
        self.reader.read_again(name, self._clock.now_ns())
        end_s = time.monotonic() + _PARAMETERS_MAX_S
        while not self.reader.parameters_done and time.monotonic() < end_s:
            self.turn()
        return self.reader.value(name)

    def _hear(self, vehicle: VehicleReader, detector: DetectorReader, inboxes: Inboxes) -> None:
        now_ns, clock = self._clock.now_ns(), self.reader.session.clock
        utc_ns = clock.local_to_utc_ns(now_ns) if clock.is_utc_known else None
        for sample in inboxes.fix.take():
            vehicle.fix(sample.payload, now_ns, utc_ns)
        for sample in inboxes.imu.take():
            vehicle.imu(sample.payload)
        for sample in inboxes.velocity.take():
            vehicle.velocity(sample.payload)
        for sample in inboxes.sightings.take():
            detector.sighting(sample.payload, now_ns, utc_ns)
        inboxes.pad.poll(time.monotonic())
