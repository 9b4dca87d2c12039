"""The command `fuzz`."""

import json
import sys
from typing import Annotated

import typer

_ALL = "all"


def register(app: typer.Typer) -> None:
    """Add `fuzz` to `app`."""
    app.command("fuzz")(fuzz_command)


def fuzz_command(
    *,
    frames: Annotated[int, typer.Option("--frames", min=1, help="To offer on each link.")] = 1_000_000,
    link: Annotated[str, typer.Option("--link", metavar="KIND", help="udpin, udpout, tcpin, serial or all.")] = _ALL,
    firmware: Annotated[str, typer.Option("--firmware", metavar="NAME", help="px4 or ardupilot.")] = "px4",
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the frames.")] = 1,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
) -> None:
    """Offer broken and absurd frames to the simulated autopilot over real links while its drone hovers."""
    from dataclasses import asdict

    from link.errors import UserError
    from scenarios.faults.fuzz import FIRMWARES, LINK_KINDS, fuzz

    if link not in {*LINK_KINDS, _ALL}:
        raise UserError(f"--link {link} is none of {', '.join(LINK_KINDS)}, {_ALL}; choose one of these")
    if firmware not in FIRMWARES:
        raise UserError(f"--firmware {firmware} is none of {', '.join(FIRMWARES)}; choose one of these")
    kinds = LINK_KINDS if link == _ALL else (link,)
    results = []
    for kind in kinds:
        result = fuzz(kind, firmware, frames, seed)
        results.append(result)
        if not as_json:
            verdict = "undisturbed" if result.is_good else "DISTURBED"
            sys.stdout.write(
                f"{kind:7} {result.firmware}: {result.frames} frames, {result.known_messages} of them messages, "
                f"{100.0 * result.received_share:g} % received; drift {result.drift_m:g} m, "
                f"{result.not_finite} numbers not finite; {result.frames_a_second:g} frames/s: {verdict}\n"
            )
            sys.stdout.flush()
    if as_json:
        table = {"runs": [asdict(result) | {"is_good": result.is_good} for result in results]}
        sys.stdout.write(f"{json.dumps(table, indent=2)}\n")
    if not all(result.is_good for result in results):
        raise UserError("the flight was disturbed, or frames were lost; run the link in question alone, by --link")
