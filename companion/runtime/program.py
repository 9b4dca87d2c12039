"""The program: opens everything, what a user may have mistaken first, then runs the loop."""

import json
import secrets
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from companion.config.companion import CompanionConfig
from companion.runtime.command_line import MavlinkArguments, RecordArguments, RunArguments
from link.mavlink.signing import Signing
from link.recording.recorder import BackgroundRecorder
from link.ros2.layout import open_layout
from link.ros2.options import Ros2Options
from link.transports.opening import open_transport
from link.zenoh.keys import Keys
from link.zenoh.options import ZenohOptions

if TYPE_CHECKING:
    from companion.recording.sink import MessageStore
    from companion.runtime.node import CompanionNode
    from companion.runtime.options import LoopOptions, Timings


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """What a command line asks for.

    Attributes:
        config: the companion's.
        keys: of the Zenoh contract.
        mavlink: the link to the autopilot.
        zenoh: how others are met.
        ros2: whether it is a node of a ROS 2 graph.
        run: how the loop runs.
        record: what is kept.
    """

    config: CompanionConfig
    keys: Keys
    mavlink: MavlinkArguments
    zenoh: ZenohOptions
    ros2: Ros2Options | None
    run: RunArguments
    record: RecordArguments

    @property
    def folder(self) -> Path | None:
        """Where the recording goes: the command line's, else the configuration's."""
        configured = self.config.recording.folder
        return self.record.record or (Path(configured) if configured else None)


def run_program(asked: Program) -> None:
    """Run the companion until it is interrupted.

    Raises:
        UserError: a device, an endpoint or a file is wrong.
    """
    signing = asked.mavlink.signing()
    asked.record.check_writable(asked.folder)
    with ExitStack() as stack:
        memory = asked.mavlink.remember(signing)
        if memory is not None:
            stack.callback(memory.close)
        transport = stack.enter_context(open_transport(asked.mavlink.mavlink))
        zenoh = stack.enter_context(
            open_layout(asked.zenoh, asked.ros2, asked.keys, (f"/{asked.keys.drone}", "companion"))
        )
        # What a user may have got wrong is open now: the numerics take their time, up to a minute to be compiled.
        from companion.runtime.loop import run
        from companion.runtime.options import Links

        recorder = _recorder(asked)
        if recorder is not None:
            stack.callback(recorder.close)
        node = _node(asked, recorder, signing)
        transport.receive(0.0)  # what has come meanwhile is old, and its time of receipt is not known
        links = Links(keys=asked.keys, transport=transport, zenoh=zenoh, signing=memory)
        timings = run(node, links, _loop_options(asked, signs=signing is not None))
    if recorder is not None and recorder.dropped:
        where = "Foxglove's server" if asked.folder is None else asked.folder
        sys.stderr.write(f"recording: {recorder.dropped} records are lost, {where}: {recorder.why_dropped}\n")
    if asked.record.timing is not None:
        _write_timing(asked.record.timing, timings)


def _write_timing(path: Path, timings: "Timings") -> None:
    try:
        path.write_text(json.dumps(timings.summary(), indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        sys.stderr.write(f"timing: {path} is not written ({error.strerror})\n")


def _node(asked: Program, recorder: BackgroundRecorder | None, signing: Signing | None) -> "CompanionNode":
    from companion.runtime.build import build_node

    return build_node(
        asked.config,
        asked.keys,
        system_id=asked.mavlink.system_id,
        dry_run=asked.run.dry_run,
        is_component=True,
        records_input=asked.record.tlog is not None,
        recorder=recorder,
        signing=signing,
        first_number=secrets.randbelow(256),
    )


def _loop_options(asked: Program, *, signs: bool) -> "LoopOptions":
    from companion.runtime.options import LoopOptions, open_links

    return LoopOptions(
        device=asked.mavlink.mavlink,
        timeout_s=asked.run.timeout,
        start=asked.run.start,
        dry_run=asked.run.dry_run,
        use_sim_time=asked.run.use_sim_time,
        tlog=asked.record.tlog,
        open_to_strangers=open_links(asked.zenoh, asked.mavlink.mavlink, signs=signs),
    )


def _recorder(asked: Program) -> BackgroundRecorder | None:
    """Return what records into the folder and shows in Foxglove, None where neither is asked for."""
    if asked.folder is None and asked.record.foxglove is None:
        return None
    from companion.recording.records import size_of
    from companion.recording.sink import CompanionSink, MessageStores

    sink = CompanionSink(MessageStores(_stores(asked)), asked.keys, asked.config.descent)
    return BackgroundRecorder(sink, size_of=size_of)


def _stores(asked: Program) -> "list[MessageStore]":
    """Return where all that is recorded goes."""
    from companion.recording.folder import recording_store
    from link.recording.foxglove_server import FoxgloveServer

    stores: list[MessageStore] = []
    if asked.record.foxglove is not None:
        server = FoxgloveServer(asked.record.foxglove)
        sys.stderr.write(f"foxglove: ws://127.0.0.1:{server.port}\n")
        stores.append(server)
    if asked.folder is not None:
        system_id, dry_run = asked.mavlink.system_id, asked.run.dry_run
        stores.append(recording_store(asked.folder, asked.config, asked.keys, system_id=system_id, dry_run=dry_run))
    return stores
