"""The wire loop of the simulated vehicle: Zenoh and a clock around the node, nothing else."""

import signal
import time
from typing import TypeVar

import structlog

from link.errors import UserError
from link.messages import BodyTruth
from link.payloads import cdr, json_messages
from link.payloads.checks import PayloadError
from link.program.clock import Clock, ClockTick, SystemClock, TickFilter
from link.zenoh.keys import Keys
from link.zenoh.session import Inbox, ZenohSession
from scenarios.simulation.vehicle_node import STEP_PERIOD_NS, VehicleNode

_STOP_CHECK_S = 0.2

M = TypeVar("M", BodyTruth, ClockTick)


class VehicleLoop:
    """Steps the node and publishes what it says, on the simulation's ticks or every 10 ms of the system's clock.

    Args:
        node: the vehicle.
        keys: of the Zenoh contract.
        zenoh: an open session.
        use_sim_time: step when `{ns}/clock` ticks, at its time.
        timeout_s: for the first tick; 0 waits for ever.
    """

    def __init__(
        self, node: VehicleNode, keys: Keys, zenoh: ZenohSession, *, use_sim_time: bool, timeout_s: float
    ) -> None:
        self.bad_payloads = 0
        self._node = node
        self._keys = keys
        self._zenoh = zenoh
        self._timeout_s = timeout_s
        self._drone: BodyTruth | None = None
        self._truths = zenoh.subscribe(keys.drone_truth)
        self._ticks = zenoh.subscribe(keys.clock) if use_sim_time else None
        self._stopping = False
        self._log = structlog.get_logger("ground-vehicle")
        if not node.is_silent:
            pad = json_messages.encode(node.pad)
            zenoh.serve(keys.pad, lambda _: pad)
            zenoh.declare_alive(keys.alive)

    def run(self) -> None:
        """Run until a signal comes.

        Raises:
            UserError: no simulated clock within the time-out.
        """
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        self._log.info("ready", vehicle=self._keys.vehicle)
        if self._ticks is None:
            self._run_on_clock(SystemClock())
        else:
            self._run_on_ticks(self._ticks)
        self._log.info("stopped", bad_payloads=self.bad_payloads)

    def _stop(self, *_: object) -> None:
        self._stopping = True  # seen within a step or _STOP_CHECK_S; a handler must not take the wake-up's lock

    def _run_on_clock(self, clock: Clock) -> None:
        due_ns = clock.now_ns()
        while not self._stopping:
            now_ns = clock.now_ns()
            if now_ns < due_ns:
                self._zenoh.wake_up.wait((due_ns - now_ns) * 1e-9)
                continue
            self._step(now_ns)
            due_ns = max(due_ns + STEP_PERIOD_NS, now_ns)

    def _run_on_ticks(self, ticks: Inbox) -> None:
        started_s, ticked, believed = time.monotonic(), False, TickFilter()
        while not self._stopping:
            for sample in ticks.take():
                tick = self._decode(ClockTick, sample.payload)
                if tick is not None and believed.accepts(tick.t_ns):
                    ticked = True
                    self._step(tick.t_ns)
            if not ticked and self._timeout_s and time.monotonic() - started_s > self._timeout_s:
                raise UserError(f"no simulated clock on {self._keys.clock}: start the simulation")
            self._zenoh.wake_up.wait(_STOP_CHECK_S)

    def _step(self, t_ns: int) -> None:
        truths = self._truths.take()
        if truths:
            self._drone = self._decode(BodyTruth, truths[-1].payload) or self._drone
        for publication in self._node.step(t_ns, self._drone):
            self._zenoh.publish(publication.key, publication.payload, publication.encoding)

    def _decode(self, kind: type[M], payload: bytes) -> M | None:
        try:
            return cdr.decode(kind, payload)
        except PayloadError:
            self.bad_payloads += 1
            return None
