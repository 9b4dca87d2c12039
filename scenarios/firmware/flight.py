"""The wire loop beside a firmware's own simulation: its truth, a vehicle or its ship, and the companion's status."""

import time

from companion.situation.phases import Phase
from link.payloads import json_messages
from link.transports.opening import Transport
from link.zenoh.keys import Keys, Publication
from link.zenoh.session import ZenohSession
from scenarios.config import Scenario
from scenarios.firmware.options import FlyOptions
from scenarios.firmware.ship import ASTERN_M, PATH_RADIUS_M, ship_at, ship_at_rest, ship_parameters
from scenarios.firmware.watch import FirmwareWatch
from scenarios.processes.programs import ProcessGroup
from scenarios.recordings.recording import EndWatch, Recording
from scenarios.recordings.run_folder import Progress
from scenarios.recordings.watcher import Watcher
from scenarios.simulation.vehicle import VehicleState
from scenarios.simulation.vehicle_node import STEP_PERIOD_NS, VehicleNode, datum_of

_WAIT_S = 0.004  # for bytes
_PROGRESS_S = 0.2


def listen(watch: FirmwareWatch, transport: Transport) -> int:
    """Take what comes within a few milliseconds; return the local time."""
    received = transport.receive_by_peer(_WAIT_S)
    local_ns = time.time_ns()
    for _, data in received:
        watch.receive(data, local_ns, is_datagram=transport.is_datagram)
    watch.session.poll(local_ns)
    for frame in watch.session.take_output():
        transport.send(frame)
    return local_ns


class FirmwareFlight:
    """A landing, the companion having been told to start.

    Args:
        scenario: about the drone's place.
        options: how the flight is made.
        watch: on the simulation.
        keys: of the Zenoh contract.
        zenoh: an open session.

    Attributes:
        recording: of truth and status.
    """

    ship_begins_m = ASTERN_M

    def __init__(
        self, scenario: Scenario, options: FlyOptions, watch: FirmwareWatch, keys: Keys, zenoh: ZenohSession
    ) -> None:
        self.recording = Recording()
        self._watch = watch
        self._ship_speed_m_s = options.ship_speed_m_s
        self._zenoh = zenoh
        self._vehicle = VehicleNode(scenario, options.seed, keys)
        self._state: VehicleState | None = None
        self._watcher = Watcher(zenoh, keys, self.recording)
        self._end = EndWatch(scenario.run.time_limit_s)
        self._datum = datum_of(scenario.run.datum)
        self._stepped_ns = 0
        self._ship_lies = self._ship_sails = False
        pad = json_messages.encode(self._vehicle.pad)
        zenoh.serve(keys.pad, lambda _: pad)
        zenoh.declare_alive(keys.alive)

    def run(self, transport: Transport, processes: ProcessGroup, progress: Progress) -> str:
        """Return why the flight ended."""
        shown_s = 0.0
        while (reason := self._over()) is None:
            local_ns = listen(self._watch, transport)
            processes.check()
            for truth in self._watch.take_truths():
                self.recording.add(truth)
            self._step(local_ns)
            self._watcher.take()
            self._operate()
            if time.monotonic() - shown_s >= _PROGRESS_S:
                shown_s = time.monotonic()
                progress(self.recording, 1.0)
        return reason

    @property
    def phase(self) -> Phase | None:
        """The companion's, as it told last; None before it told any."""
        status = self.recording.status
        return None if status is None else Phase(status.phase)

    def _over(self) -> str | None:
        return self._end.reason(self.recording)

    def _operate(self) -> None:
        """Order what an operator would now."""
        if self._end.must_break_off(self.recording):
            self._watcher.break_off()

    def _awaits_ship(self) -> bool:
        """Return whether the drone is where the ship may begin."""
        return self.phase is Phase.WAITING

    def _step(self, local_ns: int) -> None:
        t_ns = self._watch.utc_ns(local_ns)
        if t_ns is None or t_ns - self._stepped_ns < STEP_PERIOD_NS:
            return
        self._stepped_ns = t_ns
        for publication in self._publications(t_ns):
            self._zenoh.publish(publication.key, publication.payload, publication.encoding)

    def _publications(self, t_ns: int) -> list[Publication]:
        if self._ship_speed_m_s is None:
            publications = self._vehicle.step(t_ns, self._watch.drone)
            self._state = self._vehicle.state
            return publications
        self._set_sail(self._ship_speed_m_s)
        self._state = self._ship(t_ns, self._ship_speed_m_s)
        return self._vehicle.published(self._state, self._watch.drone)

    def _set_sail(self, speed_m_s: float) -> None:
        """Let the ship begin once the drone awaits it; first it only reports, lest it leap to its first report."""
        if not self._ship_lies and self._awaits_ship():
            self._ship_lies = True
            for name, value in ship_parameters(self.ship_begins_m).items():
                self._watch.set_parameter(name, value)
        elif self._watch.ship is not None and not self._ship_sails:
            self._ship_sails = True
            self._watch.set_parameter("SIM_SHIP_SPEED", speed_m_s)

    def _ship(self, t_ns: int, ordered_m_s: float) -> VehicleState:
        report, clock = self._watch.ship, self._watch.session.clock
        reported_ns = None if report is None else clock.boot_to_utc_ns(report.boot_ns)
        if report is None or reported_ns is None:
            return ship_at_rest(t_ns, self.ship_begins_m)
        return ship_at(report, reported_ns, t_ns, self._datum, turn_radius_m=PATH_RADIUS_M, ordered_m_s=ordered_m_s)
