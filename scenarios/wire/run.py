"""A run over the wire: three programs as processes, real UDP and real Zenoh, watched and scored."""

import json
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, nullcontext
from pathlib import Path
from typing import Any

from link.errors import UserError
from link.program.extras import require
from link.program.toml_config import dump_toml
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.config import Scenario
from scenarios.lockstep.warm_up import compile_once
from scenarios.processes.programs import MODULES, ProcessGroup, Program, free_tcp_endpoint, free_udp_port
from scenarios.recordings.recording import EndWatch, Recording
from scenarios.recordings.result import result_table, write_text
from scenarios.recordings.run_folder import Progress, RunOptions, RunOutcome, count_lost, write_outcome
from scenarios.recordings.truth_file import TruthFile
from scenarios.recordings.watcher import Watcher
from scenarios.simulation.drone import sim_autopilot_config

_POLL_S = 0.02
_COMPANION_TIMING = "companion.json"
_PROGRESS_S = 0.2
_SETTLING_S = 1.0  # of wall time after the first truth, not counted in the real-time factor
_FIRST_TRUTH_S = 60.0  # of wall time


def run_over_wire(scenario: Scenario, options: RunOptions, progress: Progress) -> RunOutcome:
    """Run a scenario to its end, score it on truth and write the run's folder.

    Raises:
        UserError: a program could not start or ended by itself.
    """
    compile_once()
    keys = Keys()
    endpoint = free_tcp_endpoint()
    recording = Recording()
    truth = TruthFile(options.folder, scenario, options.seed, keys) if options.record else None
    with (
        closing(truth) if truth is not None else nullcontext(),
        # The watcher listens and the programs come to it, so that it misses nothing while they start.
        open_session(ZenohOptions(listen=(endpoint,))) as zenoh,
        ProcessGroup(_programs(scenario, options, endpoint), options.folder) as processes,
        ProcessGroup(_view(options, endpoint), options.folder),  # not checked: a landing needs no page
    ):
        watcher = Watcher(zenoh, keys, recording)

        def keep(recording: Recording, factor: float) -> None:
            if truth is not None:
                truth.take(recording)
            progress(recording, factor)

        with interrupted_between_polls() as check_interrupt:
            ended, factor = _watch(watcher, processes, EndWatch(scenario.run.time_limit_s), keep, check_interrupt)
    result = result_table(scenario, options.seed, recording, ended)
    timing = {"real_time_factor": round(factor, 4), "speed": options.speed, **_companion_timing(options.folder)}
    return write_outcome(options.folder, result, timing | count_lost(truth))


def _programs(scenario: Scenario, options: RunOptions, endpoint: str) -> list[Program]:
    """Write each program's configuration into the folder and return how they are started."""
    folder = options.folder
    drone = sim_autopilot_config(scenario, options.seed, instant=False)
    for name, config in (("scenario", scenario), ("sim-autopilot", drone), ("companion", scenario.system.companion)):
        write_text(folder / f"{name}.toml", dump_toml(config))
    port = free_udp_port()
    arguments = {
        "ground-vehicle": [
            *("--scenario", str(folder / "scenario.toml"), "--seed", str(options.seed)),
            *("--use-sim-time", "-e", endpoint),
        ],
        "sim-autopilot": [
            *("--config", str(folder / "sim-autopilot.toml"), "--speed", str(options.speed)),
            *("--mavlink", f"udpout:127.0.0.1:{port}", "-e", endpoint),
        ],
        "companion": [
            *("--config", str(folder / "companion.toml"), "--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint),
            *("--use-sim-time", "--start", "--tlog", str(folder / "flight.tlog")),
            *("--timing", str(folder / _COMPANION_TIMING)),
            *(("--record", str(folder)) if options.record else ()),
        ],
    }
    programs = [Program(name=name, module=MODULES[name], arguments=words) for name, words in arguments.items()]
    return [*programs, *_eyes(scenario, options, endpoint)]


def _eyes(scenario: Scenario, options: RunOptions, endpoint: str) -> list[Program]:
    """Return how the simulated camera and the real detector are started, if the scenario has a camera."""
    if not scenario.has_camera:
        return []
    require("camera", "+camera")
    from scenarios.simulation.camera_scene import (  # noqa: PLC0415 (OpenCV is an extra)
        detector_arguments,
        write_camera_files,
    )

    write_camera_files(scenario, options.seed, options.folder)
    seen = ["camera", str(options.folder / "scenario.toml"), "--seed", str(options.seed), "-e", endpoint]
    kept = ("--record", str(options.folder)) if options.record else ()
    sees = ["run", "--source", "zenoh", *detector_arguments(options.folder), "-e", endpoint, *kept]
    return [
        Program(name="camera", module=MODULES["scenarios"], arguments=seen),
        Program(name="pad-detector", module=MODULES["pad-detector"], arguments=sees),
    ]


def _view(options: RunOptions, endpoint: str) -> list[Program]:
    """Return how the page is started, if it is."""
    if options.view_port is None:
        return []
    road = ("--road", str(options.folder / "scenario.toml"), "--seed", str(options.seed))
    words = ["view", "-e", endpoint, "--port", str(options.view_port), *road]
    return [Program(name="view", module=MODULES["scenarios"], arguments=words)]


class Pace:
    """Simulated seconds per wall second, once a simulator that starts late has caught up."""

    def __init__(self) -> None:
        self._seen_s: float | None = None
        self._from = (0.0, 0.0)
        self.factor = 0.0

    def update(self, now_s: float, elapsed_s: float) -> None:
        """Take the wall time and the simulated time since the first sample."""
        if self._seen_s is None:
            self._seen_s, self._from = now_s, (now_s, elapsed_s)
        elif self._from[0] == self._seen_s and now_s - self._seen_s >= _SETTLING_S:
            self._from = (now_s, elapsed_s)
        if now_s > self._from[0]:
            self.factor = (elapsed_s - self._from[1]) / (now_s - self._from[0])


@contextmanager
def interrupted_between_polls() -> Iterator[Callable[[], None]]:
    """Note Ctrl-C, and give what raises it, so that it breaks into nothing: CPython ends by a signal that met `exec`.

    The decoders of messages are texts for it, made as the first messages come.
    """
    interrupts: list[int] = []

    def check() -> None:
        if interrupts:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, lambda number, _: interrupts.append(number))
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)


def _watch(
    watcher: Watcher, processes: ProcessGroup, end: EndWatch, progress: Progress, check_interrupt: Callable[[], None]
) -> tuple[str, float]:
    """Return why the run ended and its real-time factor."""
    recording, pace = watcher.recording, Pace()
    began_s, shown_s = time.monotonic(), 0.0
    while (reason := end.reason(recording)) is None:
        time.sleep(_POLL_S)
        check_interrupt()
        processes.check()
        watcher.take()
        if end.must_break_off(recording):
            watcher.break_off()
        now_s = time.monotonic()
        if recording.drone:
            pace.update(now_s, recording.elapsed_s)
        elif now_s - began_s > _FIRST_TRUTH_S:
            raise UserError(f"no truth of the drone within {_FIRST_TRUTH_S:g} s: see the logs in the run's folder")
        if now_s - shown_s >= _PROGRESS_S:
            shown_s = now_s
            progress(recording, pace.factor)
    progress(recording, pace.factor)
    return reason, pace.factor


def _companion_timing(folder: Path) -> dict[str, Any]:
    path = folder / _COMPANION_TIMING
    if not path.exists():
        return {}
    table: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    path.unlink()
    step_ms = {name: table.pop(f"state_to_setpoint_{name}_ms") for name in ("median", "p99", "max")}
    return {"step_ms": {"companion": step_ms}, "companion": table}
