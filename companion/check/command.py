"""The `companion check` command."""

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from companion.check.findings import Finding, Level, advised_values, is_ready, keep, read_kept
from companion.runtime.command_line import ConfigArguments, MavlinkArguments
from link.errors import UserError
from link.program.cli import JsonOption
from link.ros2.command_line import Ros2Arguments
from link.zenoh.command_line import NameArguments, ZenohArguments

if TYPE_CHECKING:
    from companion.check.session import CheckSession
    from companion.config.autopilot import UtcOf
    from companion.config.companion import CompanionConfig
    from link.mavlink.signing import Signing
    from link.transports.transport import Transport
    from link.zenoh.keys import Keys
    from link.zenoh.session import ZenohSession


_FAILED = 1


_SpeedMaxOption = Annotated[
    float, typer.Option("--speed-max", metavar="M_S", min=0.0, max=50.0, help="Of the vehicle to be landed on.")
]
_LaunchOption = Annotated[bool, typer.Option("--launch", help="Check for a launch from a driving vehicle, too.")]
_DurationOption = Annotated[
    float, typer.Option("--duration", min=1.0, max=3600.0, help="Seconds for which rates are counted.")
]
_TimeoutOption = Annotated[
    float, typer.Option("--timeout", min=0.0, help="Seconds to look for an autopilot; 0 looks for ever.")
]
_WriteOption = Annotated[bool, typer.Option("--write", help="Write the advised parameters, after asking.")]
_YesOption = Annotated[bool, typer.Option("--yes", help="Write without asking.")]
_KeepOption = Annotated[
    Path, typer.Option("--keep", metavar="FILE", help="Where --write keeps the parameters before it.")
]
_RestoreOption = Annotated[
    Path | None, typer.Option("--restore", metavar="FILE", help="Write back what --write kept there, and end.")
]


def check(
    *,
    mavlink: MavlinkArguments,
    speed_max: _SpeedMaxOption = 5.0,
    launch: _LaunchOption = False,
    duration: _DurationOption = 4.0,
    timeout: _TimeoutOption = 30.0,
    set_values: _WriteOption = False,
    yes: _YesOption = False,
    keep_file: _KeepOption = Path("parameters_before.json"),
    restore: _RestoreOption = None,
    as_json: JsonOption = False,
    chosen: ConfigArguments,
    names: NameArguments,
    endpoints: ZenohArguments,
    ros2: Ros2Arguments,
) -> int:
    """Read the autopilot and the vehicle, and say what to change before a landing; exit code 1 when something fails.

    A vehicle that is silent fails only where -e, -l, --zenoh-config or --multicast-scouting says where it is met.
    """
    from companion.runtime.options import open_links
    from link.ros2.layout import open_layout
    from link.transports.opening import open_transport

    if keep_file.is_dir():
        raise UserError(f"--keep {keep_file}: is a folder; name a file in it")
    if restore is not None and set_values:
        raise UserError("--write writes the advised parameters, --restore the former ones: give one of them")
    settings = chosen.load()
    signing = mavlink.signing()
    back = None if restore is None else _values_to_restore(restore)
    options, keys = endpoints.options(), names.keys()
    node = (f"/{keys.drone}", "companion_check")
    with open_transport(mavlink.mavlink) as transport, open_layout(options, ros2.options(), keys, node) as zenoh:
        session = _find(transport, mavlink, signing, timeout, settings.autopilot.utc)
        if back is not None:
            _write(session, back)
            return 0
        ask = _Question(
            zenoh=zenoh,
            keys=keys,
            duration_s=duration,
            speed_m_s=speed_max,
            config=settings,
            launches=launch,
            expects_vehicle=endpoints.are_given,
            open_links=open_links(options, mavlink.mavlink, signs=signing is not None),
        )
        findings = _look(session, ask)
        if set_values:
            set_advised(session, findings, keep_file, asks=not yes)
            findings = _look(session, ask)
    return _show(findings, speed_max, as_json=as_json)


def _values_to_restore(path: Path) -> dict[str, float]:
    values = read_kept(path)
    if not values:
        raise UserError(f"--restore {path}: holds no parameters; name the file that --write kept")
    return values


@dataclass(frozen=True, slots=True, kw_only=True)
class _Question:
    """What is looked at, and what for."""

    zenoh: "ZenohSession"
    keys: "Keys"
    duration_s: float
    speed_m_s: float
    config: "CompanionConfig"
    launches: bool
    expects_vehicle: bool
    open_links: tuple[str, ...]


def _find(
    transport: "Transport", mavlink: MavlinkArguments, signing: "Signing | None", timeout_s: float, utc: "UtcOf"
) -> "CheckSession":
    """Return the session with the autopilot that a link leads to."""
    from companion.check.session import open_check

    session = open_check(transport, mavlink.mavlink, system_id=mavlink.system_id, signing=signing, utc=utc)
    limit = f", for {timeout_s:g} s at most" if timeout_s else ""
    typer.echo(f"looking for an autopilot on {mavlink.mavlink}{limit}", err=True)
    session.find(timeout_s)
    return session


def _look(session: "CheckSession", asked: _Question) -> list[Finding]:
    from companion.check.assessment import assess, assess_links
    from companion.check.detector import judge_detector

    typer.echo(f"found it; listening to it and to the vehicle for {asked.duration_s:g} s", err=True)
    vehicle, detector = session.listen(asked.duration_s, asked.zenoh, asked.keys, asked.config.integrity)
    seen = assess(
        session.reader.facts(),
        vehicle,
        asked.speed_m_s,
        asked.config,
        launches=asked.launches,
        expects_vehicle=asked.expects_vehicle,
    )
    return [*seen, *judge_detector(detector, asked.speed_m_s, asked.config), *assess_links(asked.open_links)]


def _show(findings: list[Finding], speed_m_s: float, *, as_json: bool) -> int:
    if as_json:
        sys.stdout.write(json.dumps(as_table(findings, speed_m_s), indent=2) + "\n")
    else:
        print_table(findings, speed_m_s)
    return 0 if is_ready(findings) else _FAILED


def set_advised(session: "CheckSession", findings: list[Finding], keep_file: Path, *, asks: bool) -> None:
    """Keep the present values, then write the advised ones, unless the user says no."""
    advised = advised_values(findings)
    if not advised:
        return
    known = session.reader.facts().parameters
    for name, value in advised.items():
        typer.echo(f"{name}: {known[name]:g} -> {value:g}", err=True)
    if asks and not _is_confirmed(f"write these {len(advised)} parameters?"):
        typer.echo("nothing was written", err=True)
        return
    keep(keep_file, {name: known[name] for name in advised})
    typer.echo(f"the values before are in {keep_file}: companion check --restore {keep_file}", err=True)
    _write(session, advised)


def _is_confirmed(question: str) -> bool:
    """Return what the user answers.

    Raises:
        UserError: nobody can answer.
    """
    try:
        if sys.stdin is not None:
            return typer.confirm(question, err=True)
    except typer.Abort as error:
        if not isinstance(error.__context__, EOFError):  # but Ctrl-C
            raise
        sys.stderr.write("\n")  # the question's line has no end yet
    raise UserError("--write asks before it writes, and nobody can answer here: add --yes; nothing was written")


def _write(session: "CheckSession", values: dict[str, float]) -> None:
    for name, value in values.items():
        if session.read_parameter(name) is None:
            raise UserError(f"{name} is not known to this autopilot: nothing more was written")
        if not session.set_parameter(name, value):
            raise UserError(f"{name} was not set to {value:g}: the autopilot refuses it; set it in a ground station")
        typer.echo(f"{name} = {value:g}", err=True)


_STYLES = {Level.PASS: "green", Level.WARN: "yellow", Level.FAIL: "bold red"}


def print_table(findings: Sequence[Finding], speed_m_s: float) -> None:
    """Print one line for each finding, and the sum."""
    table = Table(box=SIMPLE_HEAD, title=f"for a vehicle at {speed_m_s:g} m/s", title_justify="left")
    table.add_column("")
    table.add_column("what", no_wrap=True)
    table.add_column("found", overflow="fold")
    table.add_column("what to do, and why", overflow="fold")
    for one in findings:
        to_do = ": ".join(part for part in (one.advice, one.reason) if part)
        table.add_row(one.level.value, one.name, one.found, to_do, style=_STYLES[one.level])
    console = Console()
    console.print(table)
    counts = [f"{sum(one.level is level for one in findings)} {level.value}" for level in Level]
    console.print(", ".join(counts))


def as_table(findings: Sequence[Finding], speed_m_s: float) -> dict[str, Any]:
    """Return the same content for JSON."""
    rows = [{**asdict(one), "level": one.level.value} for one in findings]
    return {"speed_m_s": speed_m_s, "ready": is_ready(findings), "findings": rows}
