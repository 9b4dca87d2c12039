"""The wire loop of the simulated autopilot: sockets and the clock around the node, nothing else."""

import select
import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass

from link.messages import BodyTruth, RotorTruth
from link.payloads import cdr
from link.program.clock import ClockTick, ScaledClock, spare_present_objects
from link.transports.opening import Transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from sim_autopilot.air.air import Air
from sim_autopilot.plant.snapshot import drone_truth, rotor_truth
from sim_autopilot.runtime.node import AutopilotNode
from sim_autopilot.runtime.vehicle_view import VehicleView

_BEHIND_MAX_S = 0.5
"""Of wall time: farther behind than this, the clock restarts from here instead of running after it."""
_YIELD_S = 0.0001
"""Wall time for which a loop without a clock looks for bytes in each step, so that others can keep up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Links:
    """What the loop talks over; the transports are those of the node's links, in their order."""

    keys: Keys
    transports: Sequence[Transport]
    zenoh: ZenohSession


class WireLoop:
    """Runs an autopilot against the wall clock.

    Args:
        node: the autopilot.
        links: open ones.
        vehicle: the deck under the drone.
        air: at the drone.
        speed: simulated seconds a wall second, 0 for as many as it can.
    """

    def __init__(self, node: AutopilotNode, links: Links, vehicle: VehicleView, air: Air, *, speed: float) -> None:
        self._node = node
        self._links = links
        self._vehicle = vehicle
        self._air = air
        self._speed = speed
        self._stopping = False
        self._clock = self._new_clock()
        self._encodings = {kind: cdr.encoding_of(kind) for kind in (ClockTick, BodyTruth, RotorTruth)}

    def run(self) -> None:
        """Run until a signal asks for the end; a step under way is finished first."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        spare_present_objects()
        while not self._stopping:
            self._listen()
            self.step()

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def step(self) -> None:
        """Advance by one step and tell everybody."""
        node = self._node
        deck = self._vehicle.deck(node.next_ns)
        self._send(node.step(deck, self._air.advance(node.step_ns * 1e-9, node.state, deck)))
        self._publish()

    def _listen(self) -> None:
        """Take what comes until the next step is due."""
        if self._clock is None:
            self._take(_YIELD_S)
            return
        while (left_ns := self._node.next_ns - self._clock.now_ns()) > 0:
            self._take(self._clock.wall_s(left_ns * 1e-9))
        self._take(0.0)
        if self._clock.wall_s(-left_ns * 1e-9) > _BEHIND_MAX_S:
            self._clock = self._new_clock()

    def _take(self, timeout_s: float) -> None:
        """Wait for bytes on any link, and take what is there on each."""
        descriptors = [one for transport in self._links.transports if (one := transport.fileno()) >= 0]
        select.select(descriptors, [], [], timeout_s)
        for link, transport in enumerate(self._links.transports):
            for peer, data in transport.receive_by_peer(0.0):
                output = self._node.receive(data, self._now_ns(), link, peer, is_datagram=transport.is_datagram)
                self._send(output)

    def _send(self, output: Sequence[bytes]) -> None:
        for transport, data in zip(self._links.transports, output, strict=True):
            if data:
                transport.send(data)

    def _now_ns(self) -> int:
        """The present between the last step and the next."""
        last_ns = self._node.state.t_ns
        if self._clock is None:
            return last_ns
        return max(last_ns, min(self._clock.now_ns(), self._node.next_ns))

    def _new_clock(self) -> ScaledClock | None:
        if self._speed == 0.0:
            return None
        return ScaledClock(speed=self._speed, epoch_ns=self._node.state.t_ns, monotonic_ns=time.monotonic_ns)

    def _publish(self) -> None:
        state, keys = self._node.state, self._links.keys
        self._put(keys.drone_truth, drone_truth(state))
        self._put(keys.drone_rotors, rotor_truth(state))
        self._put(keys.clock, ClockTick(t_ns=state.t_ns))

    def _put(self, key: str, message: BodyTruth | RotorTruth | ClockTick) -> None:
        self._links.zenoh.publish(key, cdr.encode(message), self._encodings[type(message)])
