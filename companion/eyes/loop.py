"""The loop of the detector: a source of frames and Zenoh around the node, nothing else."""

import signal
import time
from enum import Enum

import numpy as np
from msgspec import Struct

from companion.eyes.node import EyesNode
from companion.eyes.picture import Gray
from companion.eyes.recording import PERIOD_NS, PictureRecord
from companion.eyes.sources.frames import Captured, Source
from link.errors import UserError
from link.messages import CompressedPicture
from link.payloads import cdr
from link.program.clock import spare_present_objects
from link.program.service import Service
from link.recording.log import Log
from link.recording.recorder import Recorder
from link.units import NS_PER_S
from link.zenoh.keys import Keys
from link.zenoh.pad_question import PadQuestion
from link.zenoh.session import ZenohSession

STOPPED_NS = 400_000_000  # with a turn of the loop half a second

BEGIN_MAX_NS = 5_000_000_000
"""From opening a camera to its first picture. Some set their exposure first, and a stream waits for a whole picture."""
_GAPS = 2
_SLOW_NS = 250_000_000  # from one picture to the next: clearly fewer than the five a second of `companion check`


class Failure(Enum):
    """What is wrong with a camera."""

    STOPPED = "no picture comes"
    FROZEN = "the picture does not change"


class CameraWatch(Struct, frozen=True, kw_only=True):
    """When the last frame came and when the picture changed last, on a monotonic clock, and that picture's shades.

    `gaps_ns` are the last two from one frame to the next; the shorter one is the camera's own, an outage is the other.
    """

    came_ns: int
    changed_ns: int
    shades: Gray | None = None
    gaps_ns: tuple[int, ...] = ()

    @property
    def period_ns(self) -> int | None:
        """From one frame to the next, None while too few have come."""
        return min(self.gaps_ns) if len(self.gaps_ns) == _GAPS else None


def note_frame(watch: CameraWatch, shades: Gray, now_ns: int) -> CameraWatch:
    """Return the watch after a frame that came at `now_ns`."""
    gaps_ns = () if watch.shades is None else (*watch.gaps_ns, now_ns - watch.came_ns)[-_GAPS:]
    is_repeated = watch.shades is not None and np.array_equal(watch.shades, shades)
    changed_ns = watch.changed_ns if is_repeated else now_ns
    return CameraWatch(came_ns=now_ns, changed_ns=changed_ns, shades=shades, gaps_ns=gaps_ns)


def failure_of(watch: CameraWatch, now_ns: int) -> Failure | None:
    """Return what is wrong at `now_ns`, None for nothing; a slow camera fails once two of its frames are missing."""
    limit_ns = STOPPED_NS
    if watch.shades is not None:
        limit_ns = BEGIN_MAX_NS if watch.period_ns is None else max(STOPPED_NS, 2 * watch.period_ns)
    if now_ns - watch.came_ns >= limit_ns:
        return Failure.STOPPED
    return Failure.FROZEN if now_ns - watch.changed_ns >= limit_ns else None


_WAIT_S = 0.05
_TRY_AGAIN_NS = 1_000_000_000  # after one that could not be opened
_OWN = "own"


class EyesLoop:
    """Looks at each frame and publishes what it shows, until a signal comes or a file ends.

    Args:
        node: the detector.
        source: of frames.
        keys: of the Zenoh contract.
        zenoh: an open session.
        log: whose lines cost the loop nothing.
        recorder: takes a frame now and then, None where nothing is recorded.
    """

    def __init__(
        self,
        node: EyesNode,
        source: Source,
        keys: Keys,
        *,
        zenoh: ZenohSession,
        log: Log,
        recorder: Recorder | None = None,
    ) -> None:
        self._node = node
        self._source = source
        self._keys = keys
        self._zenoh = zenoh
        zenoh.declare_alive(keys.detector_alive)
        self._own = zenoh.subscribe(keys.record(_OWN))
        self._view_encoding = cdr.encoding_of(CompressedPicture)
        self._pad_question = PadQuestion(zenoh, keys.pad)
        self._failed: Failure | None = None
        self._has_told_slow = False
        self._refused_why: str | None = None
        self._restart_due_ns = 0
        self._recorder = recorder
        self._recorded_ns = 0
        self._stopping = False
        self._service = Service()
        self._log = log

    def run(self) -> None:
        """Run until a signal comes.

        Raises:
            UserError: the first frame is not of the calibration's size, the board is not that of the vehicle's pad, or
                none of the files that were given is a picture.
        """
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        spare_present_objects()
        self._log.info("ready", source=self._source.name)
        self._service.ready()
        now_ns = time.monotonic_ns()
        self._restart_due_ns = now_ns + BEGIN_MAX_NS
        watch = CameraWatch(came_ns=now_ns, changed_ns=now_ns)
        while not self._stopping and not self._source.has_ended():
            watch = self._turn(watch)
        self._service.stopping()
        self._service.close()
        counts = self._node.counts
        if not counts.frames and self._source.has_ended():
            raise UserError(f"{self._source.name}: no picture in it can be read")
        self._log.info("stopped", frames=counts.frames, seen=counts.seen, tracked=counts.tracked)

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def _turn(self, watch: CameraWatch) -> CameraWatch:
        """Wait for a frame, look at it, publish."""
        captured = self._source.take(_WAIT_S)
        for sample in self._own.take():
            self._node.receive_own(sample.payload)
        now_ns = time.monotonic_ns()
        self._service.alive(now_ns)
        if captured is not None:
            watch = note_frame(watch, captured.shades, now_ns)
            if watch.changed_ns == now_ns or not self._source.is_live:
                self._look(captured, now_ns)
        self._tell_refused()
        for line in self._node.take_news():
            self._log.info(line)
        pad = self._pad_question.poll(now_ns * 1e-9)
        if pad is not None:
            self._node.receive_pad(pad)
        return self._look_after(watch, now_ns) if self._source.is_live else watch

    def _look(self, captured: Captured, now_ns: int) -> None:
        shows = self._zenoh.is_heard(self._keys.pad_view, self._view_encoding)
        for publication in self._node.look(captured, shows=shows):
            self._zenoh.publish(publication.key, publication.payload, publication.encoding)
        self._record(captured, now_ns)

    def _tell_refused(self) -> None:
        """Say of what came and was no picture why, once for each reason."""
        why = self._source.refused_why
        if why is not None and why != self._refused_why:
            self._refused_why = why
            self._log.warning("no picture", why=why)

    def _record(self, captured: Captured, now_ns: int) -> None:
        if self._recorder is not None and now_ns - self._recorded_ns >= PERIOD_NS:
            self._recorded_ns = now_ns
            self._recorder.put(PictureRecord(captured=captured, drawing=self._node.drawing()))

    def _tell_slow(self, watch: CameraWatch) -> None:
        """Say once that pictures come, or are worked off, so seldom that the pad moves far from one to the next."""
        period_ns = watch.period_ns
        if period_ns is None or period_ns < _SLOW_NS or self._has_told_slow:
            return
        self._has_told_slow = True
        self._log.warning(
            "slow pictures",
            rate_hz=round(NS_PER_S / period_ns, 1),
            why="five a second or more are needed: set the camera's rate, use smaller pictures or more light",
        )

    def _look_after(self, watch: CameraWatch, now_ns: int) -> CameraWatch:
        """Say when the camera fails and when it is back, and start it again; one just started is left time to begin."""
        failure = failure_of(watch, now_ns)
        if failure is not self._failed:
            if failure is None:
                self._log.info("camera is back", source=self._source.name)
            else:
                self._log.warning("camera failed", source=self._source.name, why=failure.value)
            self._failed = failure
        self._tell_slow(watch)
        if failure is None and watch.shades is not None:  # it gives pictures: if it stops, it is started again at once
            self._restart_due_ns = now_ns
        elif failure is not None and now_ns >= self._restart_due_ns:
            try:
                self._source.restart()
                self._restart_due_ns = time.monotonic_ns() + BEGIN_MAX_NS
            except UserError as error:
                self._log.warning("camera cannot be started", why=str(error))
                self._restart_due_ns = time.monotonic_ns() + _TRY_AGAIN_NS
        return watch
