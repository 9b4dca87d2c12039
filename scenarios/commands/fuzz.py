"""The command `fuzz`."""

import json
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.program.cli import JsonOption

if TYPE_CHECKING:
    from scenarios.faults.fuzz import FuzzResult
    from scenarios.faults.fuzz_companion import CompanionFuzzResult

_ALL = "all"
_ENDS = ("autopilot", "companion")


def register(app: typer.Typer) -> None:
    """Add `fuzz` to `app`."""
    app.command("fuzz")(fuzz_command)


def fuzz_command(
    *,
    frames: Annotated[int, typer.Option("--frames", min=1, help="To offer on each link.")] = 1_000_000,
    end: Annotated[str, typer.Option("--end", metavar="NAME", help="autopilot, companion or all.")] = _ALL,
    link: Annotated[
        str, typer.Option("--link", metavar="KIND", help="Of the autopilot: udpin, udpout, tcpin, serial or all.")
    ] = _ALL,
    firmware: Annotated[str, typer.Option("--firmware", metavar="px4|ardupilot", help="Of the autopilot.")] = "px4",
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the frames.")] = 1,
    as_json: JsonOption = False,
) -> None:
    """Offer broken and absurd frames to a simulated autopilot that hovers and to a companion that lands."""
    from dataclasses import asdict

    from link.errors import UserError
    from scenarios.faults.fuzz import FIRMWARES, LINK_KINDS, fuzz
    from scenarios.faults.fuzz_companion import KINDS, fuzz_companion

    for option, value, known in (
        ("--end", end, (*_ENDS, _ALL)),
        ("--link", link, (*LINK_KINDS, _ALL)),
        ("--firmware", firmware, FIRMWARES),
    ):
        if value not in known:
            raise UserError(f"{option} {value} is none of {', '.join(known)}; choose one of these")
    rows: list[dict[str, Any]] = []
    if end != "companion":
        for kind in LINK_KINDS if link == _ALL else (link,):
            result = fuzz(kind, firmware, frames, seed)
            rows.append({"end": "autopilot", **asdict(result), "is_good": result.is_good})
            _say(_autopilot_line(result), is_good=result.is_good, quiet=as_json)
    if end != "autopilot":
        for kind, forges in ((kind, forges) for forges in (False, True) for kind in KINDS):
            landed = fuzz_companion(kind, firmware, frames, seed, forges=forges)
            rows.append({"end": "companion", **asdict(landed), "is_good": landed.is_good})
            _say(_companion_line(landed), is_good=landed.is_good, quiet=as_json)
    if as_json:
        sys.stdout.write(f"{json.dumps({'runs': rows}, indent=2)}\n")
    if not all(row["is_good"] for row in rows):
        raise UserError("a flight was disturbed, or frames were lost; run it alone, by --end and --link")


def _say(line: str, *, is_good: bool, quiet: bool) -> None:
    if not quiet:
        sys.stdout.write(f"{line}: {'undisturbed' if is_good else 'DISTURBED'}\n")
        sys.stdout.flush()


def _autopilot_line(result: "FuzzResult") -> str:
    return (
        f"autopilot {result.firmware}, {result.link}: {result.frames} frames, "
        f"{result.known_messages} of them messages, {100.0 * result.received_share:g} % received; "
        f"drift {result.drift_m:g} m, {result.not_finite} numbers not finite; {result.frames_a_second:g} frames/s"
    )


def _companion_line(result: "CompanionFuzzResult") -> str:
    whose = "forged" if result.forges else "of strangers"
    return (
        f"companion on {result.firmware}, {result.link}: {result.frames} frames and "
        f"{result.payloads} payloads {whose}; {result.landed} of {result.flights} landed, "
        f"{result.not_finite} numbers not finite, {result.latest_s:g} s late at most; "
        f"{result.frames_a_second:g} frames/s"
    )
