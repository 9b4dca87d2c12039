"""The wire loop of `scenarios world`: the simulated autopilot with the vehicle in it, in one process."""

import signal
import sys
import time

from link.messages import BodyTruth, RotorTruth
from link.payloads import cdr, json_messages
from link.program.clock import ClockTick, ScaledClock
from link.transports.opening import Transport
from link.units import NS_PER_S
from link.zenoh.keys import Keys, Publication
from link.zenoh.session import ZenohSession
from scenarios.config import Scenario
from scenarios.simulation.simulation import STEP_NS, Simulation, SimulationOutputs


class WorldLoop:
    """Runs the simulated side of a scenario against the wall clock.

    Args:
        scenario: what is flown.
        seed: of everything random.
        keys: of the Zenoh contract.
        transport: to the companion.
        zenoh: open session.
        speed: simulated seconds per wall second.
    """

    def __init__(
        self, scenario: Scenario, seed: int, keys: Keys, transport: Transport, zenoh: ZenohSession, *, speed: float
    ) -> None:
        start_ns = time.time_ns() // STEP_NS * STEP_NS
        Simulation(
            scenario, seed, keys, start_ns, has_eyes=False
        ).step()  # loads the compiled physics before time starts to count
        self._simulation = Simulation(scenario, seed, keys, start_ns, has_eyes=False)
        self._keys = keys
        self._transport = transport
        self._zenoh = zenoh
        self._speed = speed
        self._stopping = False
        if not self._simulation.vehicle.is_silent:
            pad = json_messages.encode(self._simulation.vehicle.pad)
            zenoh.serve(keys.pad, lambda _: pad)
            zenoh.declare_alive(keys.alive)

    def run(self) -> None:
        """Run until interrupted."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        sys.stderr.write("ready\n")
        clock = ScaledClock(speed=self._speed, epoch_ns=self._simulation.t_ns)
        while not self._stopping:
            self._listen(clock)
            self._publish(self._simulation.step())

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def _listen(self, clock: ScaledClock) -> None:
        """Take what the companion sends until the next step is due."""
        while True:
            left_s = (self._simulation.t_ns + STEP_NS - clock.now_ns()) / NS_PER_S
            for peer, data in self._transport.receive_by_peer(max(clock.wall_s(left_s), 0.0)):
                answer = self._simulation.receive(data, peer, is_datagram=self._transport.is_datagram)
                if answer:
                    self._transport.send(answer)
            if left_s <= 0.0 or self._stopping:
                return

    def _publish(self, outputs: SimulationOutputs) -> None:
        if outputs.mavlink:
            self._transport.send(outputs.mavlink)
        own = (
            (self._keys.drone_truth, outputs.drone),
            (self._keys.drone_rotors, outputs.rotors),
            (self._keys.clock, ClockTick(t_ns=self._simulation.t_ns)),
        )
        for publication in (*(_publication(key, message) for key, message in own), *outputs.publications):
            self._zenoh.publish(publication.key, publication.payload, publication.encoding)


def _publication(key: str, message: BodyTruth | RotorTruth | ClockTick) -> Publication:
    return Publication(key, cdr.encode(message), cdr.encoding_of(type(message)))
