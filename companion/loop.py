"""The wire loop of the companion: sockets and clocks around the node, nothing else."""

import queue
import signal
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import psutil  # type: ignore[import-untyped]  # it has no annotations
import structlog

from companion.node import CompanionNode
from companion.phases import Phase
from link import cdr, json_payloads
from link.clock import Clock, ClockTick, SimulatedClock, SystemClock
from link.errors import UserError
from link.keys import Keys
from link.mavlink.tlog import TlogWriter
from link.mavlink.transports import Transport
from link.messages import Command, CommandReply, PadGeometry
from link.payload_checks import PayloadError
from link.zenoh_session import Inbox, ZenohSession

_WAIT_MAX_S = 0.005  # for bytes; Zenoh samples wait no longer than this
_REPLY_WAIT_S = 2.0
_ASK_PAD_S = 1.0
_START_AGAIN_S = 0.5
_DURATIONS_MAX = 200_000  # steps whose durations are kept, over an hour's worth


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopOptions:
    """How the loop runs.

    Attributes:
        device: of the MAVLink link, for messages.
        timeout_s: without an autopilot or, with `start`, a vehicle; 0 waits for ever.
        start: start the landing without an operator.
        use_sim_time: follow `{ns}/clock` instead of the system's clock.
        tlog: file to record MAVLink into.
    """

    device: str
    timeout_s: float
    start: bool
    use_sim_time: bool
    tlog: Path | None


@dataclass(slots=True)
class Timings:
    """How long the loop took, in wall seconds."""

    state_to_setpoint_s: deque[float] = field(default_factory=lambda: deque(maxlen=_DURATIONS_MAX))
    started_s: float = field(default_factory=time.perf_counter)
    started_cpu_s: float = field(default_factory=time.process_time)

    def summary(self) -> dict[str, float | int]:
        """Return what belongs into a timing file."""
        ordered = sorted(self.state_to_setpoint_s)
        wall_s = time.perf_counter() - self.started_s

        def quantile_ms(share: float) -> float:
            return round(1e3 * ordered[min(int(share * len(ordered)), len(ordered) - 1)], 4) if ordered else 0.0

        return {
            "steps": len(ordered),
            "state_to_setpoint_median_ms": quantile_ms(0.5),
            "state_to_setpoint_p99_ms": quantile_ms(0.99),
            "state_to_setpoint_max_ms": quantile_ms(1.0),
            "cpu_share": round((time.process_time() - self.started_cpu_s) / wall_s, 4),
            "memory_mb": round(psutil.Process().memory_info().rss / 1e6, 1),
        }


class CommandDesk:
    """Takes operators' commands from Zenoh's threads to the loop, and the replies back."""

    def __init__(self) -> None:
        self._waiting: queue.SimpleQueue[tuple[Command, Future[CommandReply]]] = queue.SimpleQueue()
        self._asked: deque[Future[CommandReply]] = deque()

    def handle(self, payload: bytes) -> bytes:
        """Answer a query; called from a thread of Zenoh's."""
        try:
            command = json_payloads.decode(Command, payload)
        except PayloadError as error:
            return json_payloads.encode(CommandReply(accepted=False, reason=str(error)))
        reply: Future[CommandReply] = Future()
        self._waiting.put((command, reply))
        try:
            return json_payloads.encode(reply.result(timeout=_REPLY_WAIT_S))
        except TimeoutError:
            reply.cancel()  # what was answered by a refusal must not be done later
            return json_payloads.encode(CommandReply(accepted=False, reason="the companion made no step in time"))

    def pass_on(self, node: CompanionNode) -> None:
        """Give the oldest command to the node, one at a time."""
        while not self._asked:
            try:
                command, reply = self._waiting.get_nowait()
            except queue.Empty:
                return
            if reply.set_running_or_notify_cancel():
                node.request(command)
                self._asked.append(reply)

    def answer(self, replies: list[CommandReply]) -> None:
        """Give the replies to whom they belong, in order."""
        for reply in replies:
            if self._asked:
                self._asked.popleft().set_result(reply)


@dataclass(frozen=True, slots=True, kw_only=True)
class Links:
    """What connects the node with the world."""

    keys: Keys
    transport: Transport
    zenoh: ZenohSession


def run(node: CompanionNode, links: Links, options: LoopOptions) -> Timings:
    """Run until interrupted.

    Raises:
        UserError: no autopilot, no vehicle or no simulated clock within the time-out.
    """
    with ExitStack() as stack:
        tlog = stack.enter_context(TlogWriter(options.tlog)) if options.tlog is not None else None
        return _Loop(node, links, options, tlog).run()


class _Loop:
    def __init__(self, node: CompanionNode, links: Links, options: LoopOptions, tlog: TlogWriter | None) -> None:
        self._node = node
        self._keys = keys = links.keys
        self._transport = links.transport
        self._zenoh = zenoh = links.zenoh
        self._options = options
        self._tlog = tlog
        self._log = structlog.get_logger("companion")
        self._desk = CommandDesk()
        self._timings = Timings()
        self._inbox = zenoh.subscribe(keys.fix)
        self._inboxes = [self._inbox, *(zenoh.subscribe(key) for key in (keys.fix_velocity, keys.imu, keys.pad_pose))]
        self._ticks = zenoh.subscribe(keys.clock) if options.use_sim_time else None
        self._alive = zenoh.watch_alive(keys.alive)
        self._stopping = False
        self._asked_pad_s = -_ASK_PAD_S
        self._start_pending = options.start
        self._fix_seen = False
        self._pads: Inbox | None = None
        self._link_was_up: bool | None = None

    def run(self) -> Timings:
        """Run until a signal comes."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        clock = self._clock()
        self._zenoh.serve(self._keys.landing_command, self._desk.handle)
        self._log.info("ready", device=self._options.device)
        while not self._stopping:
            self._turn(clock)
        self._send_rest()
        return self._timings

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def _clock(self) -> Clock:
        if self._ticks is None:
            return SystemClock()
        clock = SimulatedClock()
        self._wait_for(lambda: self._tick(clock), f"no simulated clock on {self._keys.clock}")
        return clock

    def _tick(self, clock: SimulatedClock) -> bool:
        if self._ticks is not None:
            for sample in self._ticks.take():
                try:
                    self._node.bad_payloads += not clock.tick(cdr.decode(ClockTick, sample.payload).t_ns)
                except PayloadError:
                    self._node.bad_payloads += 1
        return clock.ready

    def _wait_for(self, is_there: Callable[[], bool], message: str) -> None:
        started_s = time.monotonic()
        while not is_there() and not self._stopping:
            if self._options.timeout_s and time.monotonic() - started_s > self._options.timeout_s:
                raise UserError(
                    f"{message} within {self._options.timeout_s:g} s: start the simulation, or check --ns and -e"
                )
            time.sleep(0.01)

    def _turn(self, clock: Clock) -> None:
        """Wait for bytes, take what has come, step if due, send."""
        if isinstance(clock, SimulatedClock):
            self._tick(clock)
        data = self._transport.receive(min(_WAIT_MAX_S, clock.wall_s(_WAIT_MAX_S)))
        received_s = time.perf_counter()
        local_ns = clock.now_ns()
        if data:
            self._node.receive_mavlink(data, local_ns)
            self._record(self._node.autopilot.session.take_input(), local_ns)
        self._take_samples()
        self._desk.pass_on(self._node)
        stepped = self._node.poll(local_ns)
        self._send_frames(local_ns)
        if stepped:
            self._timings.state_to_setpoint_s.append(time.perf_counter() - received_s)
            self._after_step()

    def _take_samples(self) -> None:
        for inbox in self._inboxes:
            for sample in inbox.take():
                self._fix_seen = self._fix_seen or inbox is self._inbox
                self._node.receive_sample(sample.key, sample.payload)
        self._node.receive_liveliness(alive=self._alive.alive)

    def _send_frames(self, local_ns: int) -> None:
        frames = self._node.take_frames()
        for frame in frames:
            self._transport.send(frame)
        self._record(frames, local_ns)

    def _record(self, frames: list[bytes], local_ns: int) -> None:
        if self._tlog is not None and frames:
            utc_ns = self._node.autopilot.session.clock.local_to_utc_ns(local_ns)
            for frame in frames:
                self._tlog.write(frame, utc_ns)

    def _after_step(self) -> None:
        """Publish, reply, log; and see to what is still missing."""
        for publication in self._node.take_publications():
            self._zenoh.publish(publication.key, publication.payload, publication.encoding)
        self._desk.answer(self._node.take_replies())
        outputs = self._node.outputs
        if outputs is not None and outputs.text is not None:
            self._log.info(outputs.status.phase, reason=outputs.status.reason)
        for text in self._node.autopilot.take_texts():
            self._log.info("autopilot", text=text)
        self._say_link()
        self._ask_for_pad()
        self._start_by_itself()
        self._check_time_out()

    def _say_link(self) -> None:
        """Say when the autopilot is found, lost and found again."""
        is_up = self._node.autopilot.session.link_up
        if is_up and not self._link_was_up:
            self._log.info("autopilot found" if self._link_was_up is None else "autopilot found again")
        elif self._link_was_up and not is_up:
            self._log.warning("autopilot lost")
        self._link_was_up = is_up if is_up or self._link_was_up is not None else None

    def _ask_for_pad(self) -> None:
        """Ask the vehicle for its pad until it has answered."""
        now_s = time.monotonic()
        if self._pads is not None:
            for sample in self._pads.take():
                try:
                    self._node.receive_pad(json_payloads.decode(PadGeometry, sample.payload))
                except PayloadError:
                    self._node.bad_payloads += 1
        if not self._node.pad_known and self._alive.alive and now_s - self._asked_pad_s >= _ASK_PAD_S:
            self._asked_pad_s = now_s
            self._pads = self._zenoh.ask(self._keys.pad, b"", _ASK_PAD_S)

    def _start_by_itself(self) -> None:
        if not self._start_pending or not self._fix_seen or not self._node.pad_known:
            return
        if self._node.memory.phase is not Phase.IDLE:
            self._start_pending = False
        elif self._node.is_ready_to_start():
            self._node.request(Command.START)

    def _check_time_out(self) -> None:
        """Say what is missing when nothing has come within the time-out; not once a flight has begun."""
        waited_s = time.perf_counter() - self._timings.started_s
        if not self._options.timeout_s or waited_s < self._options.timeout_s:
            return
        session = self._node.autopilot.session
        if session.target_system_id is None:
            raise UserError(
                f"no heartbeat of an autopilot within {self._options.timeout_s:g} s on {self._options.device}: "
                f"{_seen(session.statistics)}; check --mavlink and the autopilot's port"
            )
        if self._start_pending and not self._fix_seen:
            raise UserError(
                f"no vehicle fix on {self._keys.fix} within {self._options.timeout_s:g} s: start the vehicle, "
                "or check --ns, --vehicle and -e"
            )

    def _send_rest(self) -> None:
        for frame in self._node.take_frames():
            self._transport.send(frame)


def _seen(statistics: object) -> str:
    codec = getattr(statistics, "codec", None)
    received = getattr(codec, "bytes_received", 0)
    if not received:
        return "nothing was received"
    return f"{received} bytes received, {getattr(codec, 'messages_received', 0)} messages, none of them its heartbeat"
