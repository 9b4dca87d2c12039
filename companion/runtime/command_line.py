"""The options of `companion` and its subcommands, in groups.

Kept light, so that `--help` is quick: what they make is imported where it is made.
"""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from companion.config.autopilot import AutopilotKind, Guide
from companion.config.integrity import ReceiverFrames
from link.errors import UserError
from link.program.cli import FoxgloveOption, SetOption
from link.program.option_groups import OptionGroup

if TYPE_CHECKING:
    from companion.config.companion import CompanionConfig
    from link.mavlink.signing import Signing
    from link.mavlink.signing_memory import SigningMemory

ConfigOption = Annotated[Path | None, typer.Option("--config", metavar="FILE", help="Configuration in TOML.")]
_FirmwareOption = Annotated[
    AutopilotKind | None,
    typer.Option("--firmware", metavar="px4|ardupilot", help="In place of what the autopilot says of itself."),
]
_FramesOption = Annotated[
    ReceiverFrames | None,
    typer.Option("--receiver-frames", help="In place of the configuration's: whether both receivers have one frame."),
]
_GuideOption = Annotated[
    Guide | None,
    typer.Option("--guide", help="Land by setpoints, or only guide the autopilot's own precision landing."),
]
_DeviceOption = Annotated[
    str,
    typer.Option(
        "--mavlink",
        metavar="DEVICE",
        help="udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT or /dev/ttyX,BAUD.",
    ),
]
_SystemIdOption = Annotated[int, typer.Option("--system-id", min=1, max=255, help="MAVLink system id of the drone.")]
_SigningKeyOption = Annotated[
    Path | None,
    typer.Option("--signing-key", metavar="FILE", help="Sign MAVLink with this key: 32 bytes or 64 hex digits."),
]
_SigningStampsOption = Annotated[
    Path | None,
    typer.Option(
        "--signing-stamps",
        metavar="FILE",
        help="Where the time stamps of signatures are kept [default: the key's name with .stamps].",
        show_default=False,
    ),
]
_StartOption = Annotated[bool, typer.Option("--start", help="Arm, take off and land without an operator's command.")]
_TimeoutOption = Annotated[
    float,
    typer.Option(
        "--timeout",
        min=0.0,
        help="Seconds without an autopilot, with --start also without a vehicle; 0 waits for ever.",
    ),
]
_DryRunOption = Annotated[bool, typer.Option("--dry-run", help="Do everything but send setpoints and commands.")]
_UseSimTimeOption = Annotated[bool, typer.Option("--use-sim-time", help="Follow the simulation's clock on Zenoh.")]
_TlogOption = Annotated[Path | None, typer.Option("--tlog", metavar="FILE", help="Record MAVLink into this file.")]
_RecordOption = Annotated[
    Path | None, typer.Option("--record", metavar="DIR", help="Record everything into this folder, as MCAP.")
]
_TimingOption = Annotated[
    Path | None, typer.Option("--timing", metavar="FILE", help="Write step times here at the end.")
]


@dataclass(frozen=True, slots=True, kw_only=True)
class MavlinkArguments(OptionGroup):
    """The link to the autopilot."""

    mavlink: _DeviceOption = "udpin:127.0.0.1:14540"
    system_id: _SystemIdOption = 1
    signing_key: _SigningKeyOption = None
    signing_stamps: _SigningStampsOption = None

    def signing(self) -> "Signing | None":
        """Return signing with the key, None without one.

        Raises:
            UserError: a file cannot be read, or is none of these, or there are time stamps without a key.
        """
        from link.mavlink.signing_memory import open_signing

        if self.signing_key is not None:
            return open_signing(self.signing_key, self.signing_stamps)
        if self.signing_stamps is not None:
            raise UserError("--signing-stamps alone signs nothing: give --signing-key too, or leave it out")
        return None

    def remember(self, signing: "Signing | None") -> "SigningMemory | None":
        """Return what keeps the time stamps of `signing`, to be closed."""
        from link.mavlink.signing_memory import SigningMemory, stamps_file

        if signing is None or self.signing_key is None:
            return None
        return SigningMemory(stamps_file(self.signing_key, self.signing_stamps), signing)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfigArguments(OptionGroup):
    """The configuration, and what stands above it."""

    config: ConfigOption = None
    changes: SetOption = None
    firmware: _FirmwareOption = None
    receiver_frames: _FramesOption = None
    guide: _GuideOption = None

    def load(self) -> "CompanionConfig":
        """Return the configuration.

        Raises:
            UserError: something cannot be read, or a key or value does not fit.
        """
        from companion.config.companion import CompanionConfig
        from link.program.settings import COMPANION, load_settings

        frames = self.receiver_frames
        above = {
            "autopilot": {"kind": self.firmware and self.firmware.value, "guide": self.guide and self.guide.value},
            "integrity": {"receiver_frames": frames and frames.value},
        }
        return load_settings(self.config, CompanionConfig, COMPANION, self.changes, above)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunArguments(OptionGroup):
    """How the companion runs."""

    start: _StartOption = False
    timeout: _TimeoutOption = 60.0
    dry_run: _DryRunOption = False
    use_sim_time: _UseSimTimeOption = False


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordArguments(OptionGroup):
    """What is kept of a flight, and where."""

    tlog: _TlogOption = None
    record: _RecordOption = None
    foxglove: FoxgloveOption = None
    timing: _TimingOption = None

    def check_writable(self, folder: Path | None) -> None:
        """Find out before the flight, not after it; the recording's folder is made, as other files may lie in it.

        Args:
            folder: of the recording.

        Raises:
            UserError: a file or the folder cannot be written.
        """
        if folder is not None:
            _make(folder)
        for path in (self.timing, self.tlog):
            problem = None if path is None else _problem(path)
            if problem is not None:
                raise UserError(f"{path}: {problem}")


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{folder}: cannot be recorded into ({error.strerror}); choose another place") from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise UserError(f"{folder}: cannot be written; choose another place")


def _problem(path: Path) -> str | None:
    """Return why a file cannot be written."""
    folder = path.parent
    if not folder.is_dir():
        return f"there is no folder {folder}; make it or choose another place"
    if not os.access(folder, os.W_OK | os.X_OK):
        return f"the folder {folder} cannot be written; choose another place"
    return "is a folder; name a file in it" if path.is_dir() else None
