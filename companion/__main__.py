"""The `companion` command."""

import json
import os
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from companion.check.command import (
    ConfigOption,
    DeviceOption,
    SigningKeyOption,
    SigningStampsOption,
    SystemIdOption,
    check,
)
from companion.config.autopilot import AutopilotKind, Guide
from companion.config.integrity import ReceiverFrames
from companion.runtime.examples import EXAMPLES
from companion.runtime.keys import keys
from companion.runtime.reasons import reasons
from link.errors import UserError
from link.program.cli import (
    ConnectOption,
    DroneOption,
    FoxgloveOption,
    InsecureOption,
    ListenOption,
    ModeOption,
    MulticastOption,
    NamespaceOption,
    Ros2MapOption,
    Ros2Option,
    VehicleOption,
    ZenohConfigOption,
    make_app,
    run_app,
)
from link.program.patience import Patience

if TYPE_CHECKING:
    from companion.config.companion import CompanionConfig
    from companion.recording.sink import MessageStore
    from link.zenoh.keys import Keys

app = make_app("Land a drone on a moving vehicle: estimate, plan, and fly any MAVLink autopilot.", EXAMPLES)
app.command("check")(check)
app.command("keys")(keys)
app.command("reasons")(reasons)

_PrintConfigOption = Annotated[bool, typer.Option("--print-config", help="Print the configuration and end.")]
_StartOption = Annotated[bool, typer.Option("--start", help="Arm, take off and land without an operator's command.")]
_TimeoutOption = Annotated[
    float, typer.Option("--timeout", min=0.0, help="Seconds without an autopilot or vehicle; 0 waits for ever.")
]
_DryRunOption = Annotated[bool, typer.Option("--dry-run", help="Do everything but send setpoints and commands.")]
_UseSimTimeOption = Annotated[bool, typer.Option("--use-sim-time", help="Follow the simulation's clock on Zenoh.")]
_AutopilotOption = Annotated[
    AutopilotKind | None, typer.Option("--autopilot", help="In place of the configuration's kind of autopilot.")
]
_FramesOption = Annotated[
    ReceiverFrames | None,
    typer.Option("--receiver-frames", help="In place of the configuration's: whether both receivers have one frame."),
]
_GuideOption = Annotated[
    Guide | None,
    typer.Option("--guide", help="Land by setpoints, or only guide the autopilot's own precision landing."),
]
_TlogOption = Annotated[Path | None, typer.Option("--tlog", metavar="FILE", help="Record MAVLink into this file.")]
_RecordOption = Annotated[
    Path | None, typer.Option("--record", metavar="DIR", help="Record everything into this folder, as MCAP.")
]
_TimingOption = Annotated[
    Path | None, typer.Option("--timing", metavar="FILE", help="Write step times here at the end.")
]


@app.callback(invoke_without_command=True)
def companion(
    context: typer.Context,
    mavlink: DeviceOption = "udpin:127.0.0.1:14540",
    config: ConfigOption = None,
    print_config: _PrintConfigOption = False,
    start: _StartOption = False,
    timeout: _TimeoutOption = 60.0,
    dry_run: _DryRunOption = False,
    use_sim_time: _UseSimTimeOption = False,
    autopilot: _AutopilotOption = None,
    receiver_frames: _FramesOption = None,
    guide: _GuideOption = None,
    system_id: SystemIdOption = 1,
    signing_key: SigningKeyOption = None,
    signing_stamps: SigningStampsOption = None,
    tlog: _TlogOption = None,
    record: _RecordOption = None,
    foxglove: FoxgloveOption = None,
    timing: _TimingOption = None,
    namespace: NamespaceOption = "decklander",
    vehicle: VehicleOption = "vehicle",
    drone: DroneOption = "drone",
    mode: ModeOption = None,
    connect: ConnectOption = None,
    listen: ListenOption = None,
    multicast: MulticastOption = None,
    zenoh_config: ZenohConfigOption = None,
    insecure: InsecureOption = False,
    ros2: Ros2Option = None,
    ros2_map: Ros2MapOption = None,
) -> None:
    """Land a drone on a moving vehicle: estimate, plan, and fly any MAVLink autopilot."""
    if context.invoked_subcommand is not None:
        return
    from companion.config.companion import CompanionConfig
    from link.program.toml_config import dump_toml, load_config

    above = {
        "autopilot": {"kind": autopilot and autopilot.value, "guide": guide and guide.value},
        "integrity": {"receiver_frames": receiver_frames and receiver_frames.value},
    }
    settings = load_config(config, CompanionConfig, above)
    if start and settings.autopilot.guide is Guide.PRECLAND:
        raise UserError("--start: with --guide precland the autopilot's own mode begins the landing; leave one out")
    if print_config:
        sys.stdout.write(dump_toml(settings))
        return
    from link.mavlink.signing_memory import SigningMemory, open_signing, stamps_file
    from link.mavlink.transports import open_transport
    from link.recording.recorder import BackgroundRecorder
    from link.ros2.options import open_layout, ros2_options
    from link.zenoh.keys import Keys
    from link.zenoh.options import zenoh_options

    keys = Keys(namespace, vehicle, drone)
    signing = None if signing_key is None else open_signing(signing_key, signing_stamps)
    for written in (timing, tlog):
        if written is not None:
            _check_writable(written)
    folder = record or (Path(settings.recording.folder) if settings.recording.folder else None)
    recorder: BackgroundRecorder | None = None
    with ExitStack() as stack:
        # What a user may have got wrong is opened first: the numerics take their time, up to a minute to be compiled.
        endpoints = zenoh_options(mode, connect, listen, multicast, zenoh_config, insecure=insecure)
        memory: SigningMemory | None = None
        if signing is not None and signing_key is not None:
            memory = SigningMemory(stamps_file(signing_key, signing_stamps), signing)
            stack.callback(memory.close)
        transport = stack.enter_context(open_transport(mavlink))
        zenoh = stack.enter_context(
            open_layout(endpoints, ros2_options(ros2, ros2_map), keys, (f"/{drone}", "companion"))
        )
        with Patience("companion"):
            from companion.runtime.build import build_node
            from companion.runtime.loop import run
            from companion.runtime.open_links import open_links
            from companion.runtime.options import Links, LoopOptions

            if folder is not None or foxglove is not None:
                from companion.recording.sink import CompanionSink, MessageStores

                stores = _stores(folder, foxglove, settings, keys, system_id=system_id, dry_run=dry_run)
                recorder = BackgroundRecorder(CompanionSink(MessageStores(stores), keys, settings.descent))
                stack.callback(recorder.close)
            node = build_node(
                settings,
                keys,
                system_id=system_id,
                dry_run=dry_run,
                is_component=True,
                records_input=tlog is not None,
                recorder=recorder,
                signing=signing,
            )
        transport.receive(0.0)  # what has come meanwhile is old, and its time of receipt is not known
        options = LoopOptions(
            device=mavlink,
            timeout_s=timeout,
            start=start,
            use_sim_time=use_sim_time,
            tlog=tlog,
            open_to_strangers=open_links(endpoints, mavlink, signs=signing is not None),
        )
        timings = run(node, Links(keys=keys, transport=transport, zenoh=zenoh, signing=memory), options)
    if recorder is not None and recorder.dropped:
        where = "Foxglove's server" if folder is None else f"the disk of {folder}"
        sys.stderr.write(f"recording: {recorder.dropped} records are lost, {where} is full or too slow\n")
    if timing is not None:
        timing.write_text(json.dumps(timings.summary(), indent=2) + "\n", encoding="utf-8")


def _stores(
    folder: Path | None,
    foxglove_port: int | None,
    settings: "CompanionConfig",
    keys: "Keys",
    *,
    system_id: int,
    dry_run: bool,
) -> "list[MessageStore]":
    """Return where all that is recorded goes."""
    from companion.recording.folder import recording_store
    from link.recording.foxglove_server import FoxgloveServer

    stores: list[MessageStore] = []
    if foxglove_port is not None:
        server = FoxgloveServer(foxglove_port)
        sys.stderr.write(f"foxglove: ws://127.0.0.1:{server.port}\n")
        stores.append(server)
    if folder is not None:
        stores.append(recording_store(folder, settings, keys, system_id=system_id, dry_run=dry_run))
    return stores


def _check_writable(path: Path) -> None:
    """Find out before the flight, not after it."""
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise UserError(f"{path}: cannot be written; choose another place")


def main() -> None:
    """Run the command."""
    sys.exit(run_app("companion", app))


if __name__ == "__main__":
    main()
