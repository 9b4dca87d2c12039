"""The wire loop of the companion: sockets and clocks around the node, nothing else."""

import signal
import time
from collections.abc import Callable
from contextlib import ExitStack

from companion.autopilots.choice import check_autopilot
from companion.runtime.claims import Claims
from companion.runtime.command_desk import CommandDesk
from companion.runtime.computer import ComputerWatch
from companion.runtime.live_state import Onlooker, onlookers
from companion.runtime.losses import Losses
from companion.runtime.node import CompanionNode
from companion.runtime.options import Links, LoopOptions, Timings
from companion.runtime.outbox import outbox
from companion.runtime.pad_watch import PadWatch
from companion.runtime.recorded_node import RecordingNode
from companion.runtime.sent_frames import SentFrames
from companion.runtime.start_and_handover import OwnStart, hand_over
from companion.situation.phases import Phase
from link.errors import UserError
from link.mavlink.pinned_peer import PinnedPeer
from link.mavlink.tlog import TlogFrames, TlogSink
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.program.clock import Clock, ClockTick, SimulatedClock, SystemClock, spare_present_objects
from link.program.service import Service
from link.recording.log import Log
from link.recording.recorder import BackgroundRecorder, Recorder
from link.zenoh.session import SENSOR_BYTES_MAX

_WAIT_MAX_S = 0.005  # for bytes; Zenoh samples wait no longer than this


def run(node: CompanionNode, links: Links, options: LoopOptions) -> Timings:
    """Run until interrupted.

    Raises:
        UserError: no autopilot, no vehicle or no simulated clock within the time-out.
    """
    with ExitStack() as stack:
        tlog: Recorder | None = None
        if options.tlog is not None:
            tlog = BackgroundRecorder(TlogSink(options.tlog), size_of=TlogFrames.size)
            stack.callback(tlog.close)
        lookers = onlookers(stack, links.zenoh, links.keys, options.device)
        publications = outbox(links.zenoh)
        stack.callback(publications.close)
        log = Log("companion")
        stack.callback(log.close)
        return _Loop(node, links, options, tlog=tlog, lookers=lookers, log=log, outbox=publications).run()


class _Loop:
    def __init__(
        self,
        node: CompanionNode,
        links: Links,
        options: LoopOptions,
        *,
        tlog: Recorder | None,
        lookers: list[Onlooker],
        log: Log,
        outbox: Recorder,
    ) -> None:
        self._node = node
        self._keys = keys = links.keys
        self._transport = links.transport
        self._signing = links.signing
        self._peer = PinnedPeer(links.transport, node.autopilot.session)
        self._zenoh = zenoh = links.zenoh
        self._options = options
        self._sent = SentFrames(links.transport, node.autopilot.session, tlog)
        self._onlookers = lookers
        self._log, self._outbox = log, outbox
        self._service = Service()
        self._desk = CommandDesk()
        self._timings = Timings()
        told = (keys.fix, keys.fix_velocity, keys.imu, keys.pad_pose)
        self._inboxes = [zenoh.subscribe(key, sample_bytes_max=SENSOR_BYTES_MAX) for key in told]
        self._ticks = zenoh.subscribe(keys.clock) if options.use_sim_time else None
        self._alive = zenoh.watch_alive(keys.alive)
        self._claims = Claims(zenoh, keys, dry_run=options.dry_run)
        self._stopping = False
        self._start = OwnStart(wanted=options.start)
        self._is_silent = node.system.config.silent_vehicle is not None
        self._fix_seen = self._is_silent  # of a vehicle that tells nothing no fix is awaited
        self._pad_watch = PadWatch(zenoh, keys.pad)
        self._link_was_up: bool | None = None
        self._strangers_told = False
        self._losses = Losses(node, self._sent, zenoh, log, signing=links.signing)
        self._computer = ComputerWatch()

    def run(self) -> Timings:
        """Run until a signal comes."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        clock = self._clock()
        self._zenoh.serve_later(self._keys.landing_command, self._desk.take)
        spare_present_objects()
        self._log.info("ready", device=self._options.device)
        self._node.open_to_strangers = self._options.open_to_strangers
        for opening in self._options.open_to_strangers:
            self._log.warning("open to strangers", what=opening)
        while not self._stopping:
            self._turn(clock)
        self._service.stopping()
        hand_over(self._node, lambda: self._turn(clock), self._log)
        self._sent.send(self._node.take_frames(), clock.now_ns(), time.perf_counter())
        self._service.close()
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
                    if not clock.tick(cdr.decode(ClockTick, sample.payload).t_ns):
                        self._node.vehicle.refuse("clock", "stray", "far from the ticks before")
                except PayloadError as error:
                    self._node.vehicle.refuse("clock", "unreadable", str(error))
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
        self._service.alive(time.monotonic_ns())
        if self._signing is not None:
            self._signing.poll(time.monotonic_ns())
        if isinstance(clock, SimulatedClock):
            self._tick(clock)
        received = self._transport.receive_by_peer(min(_WAIT_MAX_S, clock.wall_s(_WAIT_MAX_S)))
        received_s = time.perf_counter()
        local_ns = clock.now_ns()
        for data in self._peer.heard(received):
            self._node.receive_mavlink(data, local_ns, is_datagram=self._transport.is_datagram)
        self._sent.record(self._node.autopilot.session.take_input(), local_ns)
        self._take_samples()
        self._desk.pass_on(self._node, local_ns)
        stepped = self._node.poll(local_ns)
        self._sent.send(self._node.take_frames(), local_ns, received_s)
        if stepped:
            self._note_time(time.perf_counter() - received_s)
            for onlooker in self._onlookers:
                onlooker.tell(self._node, local_ns)
            self._after_step()
        if (load := self._computer.poll()) is not None:
            self._node.tell_load(load, local_ns)

    def _note_time(self, state_to_setpoint_s: float) -> None:
        self._timings.state_to_setpoint_s.append(state_to_setpoint_s)
        if isinstance(self._node, RecordingNode):
            self._node.record_step_time(state_to_setpoint_s)

    def _take_samples(self) -> None:
        for inbox in self._inboxes:
            for sample in inbox.take():
                self._fix_seen = self._fix_seen or sample.key == self._keys.fix
                self._node.receive_sample(sample.key, sample.payload)
        self._node.receive_liveliness(alive=self._alive.alive)
        self._node.receive_rival(self._claims.rival)

    def _after_step(self) -> None:
        """Publish, reply, log; and see to what is still missing."""
        for publication in self._node.take_publications():
            self._outbox.put(publication)
        if self._node.inputs is not None and self._start.commanded(self._node.inputs.command):
            self._log.info("start called off")
        self._desk.answer(self._start.answered(self._node.take_replies()))
        outputs = self._node.outputs
        if outputs is not None and outputs.text is not None:
            self._log.info(outputs.status.phase, reason=outputs.status.reason)
            self._service.status(f"{outputs.status.phase}: {outputs.status.reason}")
        for text in self._node.autopilot.take_texts():
            self._log.info("autopilot", text=text)
        for refused in self._node.vehicle.refusals.news(time.monotonic_ns()):
            self._log.warning("data refused", what=refused)
        self._claims.update(self._node.phase, armed=self._node.autopilot.state.view.armed)
        self._say_link()
        self._losses.say()
        self._ask_for_pad()
        if self._start.follow(self._node, fix_seen=self._fix_seen):
            self._log.warning("start called off: another companion is there for this drone")
        self._check_time_out()

    def _say_link(self) -> None:
        """Say when the autopilot is found, lost and found again."""
        is_up = self._node.autopilot.session.link_up
        if is_up and not self._link_was_up:
            self._log.info("autopilot found" if self._link_was_up is None else "autopilot found again")
            self._service.ready()
        elif self._link_was_up and not is_up:
            self._log.warning("autopilot lost")
        if not self._strangers_told and self._transport.statistics.strangers:
            self._strangers_told = True
            self._log.warning("somebody else sends to the autopilot's link, and is not listened to")
        self._link_was_up = is_up if is_up or self._link_was_up is not None else None

    def _ask_for_pad(self) -> None:
        """Ask the vehicle for its pad, and say why an answer is refused."""
        if self._is_silent:
            return
        alive, seen = self._alive.alive, self._fix_seen
        why = self._pad_watch.poll(self._node, time.monotonic(), alive=alive, fix_seen=seen)
        if why is not None:
            self._log.warning("the vehicle's description of its pad is refused", why=why)

    def _check_time_out(self) -> None:
        """Say what is missing when nothing has come within the time-out; not once a flight has begun."""
        waited_s = time.perf_counter() - self._timings.started_s
        if not self._options.timeout_s or waited_s < self._options.timeout_s or self._node.phase is not Phase.IDLE:
            return
        timeout_s = self._options.timeout_s
        check_autopilot(self._node.autopilot.session, self._options.device, timeout_s)
        self._start.check_vehicle(
            self._keys, timeout_s, fix_seen=self._fix_seen, pad_known=self._node.vehicle.knows_pad
        )
