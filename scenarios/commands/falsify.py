"""The command `falsify`: searches the domain for a world in which the landing fails."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from link.errors import UserError
from link.program.cli import JsonOption, note
from link.program.extras import require
from scenarios.commands.options import WorkersOption

if TYPE_CHECKING:
    from scenarios.falsify.falsify import Request, Result
    from scenarios.falsify.search import Space


def register(app: typer.Typer) -> None:
    """Add the command to `app`."""
    app.command("falsify")(falsify_command)


def falsify_command(
    slice_name: Annotated[str, typer.Argument(metavar="SLICE", help="Of the domain, such as world or world:urban.")],
    *,
    landings: Annotated[int, typer.Option("--landings", min=1, metavar="N", help="Landings of the search.")] = 500,
    reduction: Annotated[
        int, typer.Option("--reduction", min=0, metavar="N", help="Landings to reduce what is found.")
    ] = 200,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of the first start; further ones follow.")] = 1,
    workers: WorkersOption = None,
    only: Annotated[
        str,
        typer.Option("--only", metavar="PART,...", help="Vary these alone, such as driver,wind; the others: medians."),
    ] = "",
    random: Annotated[bool, typer.Option("--random", help="Draw worlds at random, to compare with.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="What is kept [default: in runs].")] = None,
    as_json: JsonOption = False,
) -> int:
    """Search a slice for an unsafe landing and reduce it to a small scenario file; exit code 1 when none is found."""
    require("campaign", "scenarios falsify")
    from link.program.settings import refuse_variables
    from scenarios.commands.falsify_progress import FalsifyProgress
    from scenarios.falsify.falsify import Request, create_folder, falsify
    from scenarios.processes.local_workers import core_count

    refuse_variables()
    request = Request(
        slice=slice_name,
        seed=seed,
        landings=landings,
        reduction=reduction,
        workers=workers or core_count(),
        only=tuple(only.split(",")) if only else (),
        random=random,
    )
    space = _space_of(request)
    folder = create_folder(out)
    note(f"{request.command} in {folder}")
    try:
        with FalsifyProgress(landings, reduction) as progress:
            result = falsify(request, space, folder, progress.update)
    except KeyboardInterrupt:
        note(f"what was flown and found is kept in {folder}")
        raise
    if as_json:
        sys.stdout.write(json.dumps(result.to_json(request), indent=2, allow_nan=False) + "\n")
    else:
        _print(result, request, folder)
    return 1 if result.found is None else 0


def _space_of(request: "Request") -> "Space":
    """Return what is searched.

    Raises:
        UserError: there is no such slice or part of the quantities, or a seed is held back.
    """
    from scenarios.falsify.world_space import world_space
    from scenarios.worlds.odd import slices
    from scenarios.worlds.seeds import HELD_BACK_FROM
    from scenarios.worlds.world import quantities

    if request.slice not in slices():
        raise UserError(
            f"'{request.slice}' is no slice of the domain: give one of {', '.join(slices())};"
            " a scenario of the catalogue draws nothing that could be searched"
        )
    if request.seed + request.landings > HELD_BACK_FROM:  # a start has one landing at least
        most = HELD_BACK_FROM - request.landings
        fewer = f"--seed and --landings that make {HELD_BACK_FROM} or less"
        raise UserError(
            f"seeds from {HELD_BACK_FROM} on are held back for published figures:"
            f" give {fewer if most < 0 else f'--seed {most} or less'}"
        )
    parts = sorted({name.partition(".")[0] for name in quantities(request.slice, request.seed)})
    unknown = next((part for part in request.only if part not in parts), None)
    if unknown is not None:
        raise UserError(f"--only: no quantity begins with '{unknown}.': give some of {', '.join(parts)}")
    return world_space(request.slice, request.seed, request.only)


def _print(result: "Result", request: "Request", folder: Path) -> None:
    found, case = result.found, result.case
    errors = f", {result.errors} with errors" if result.errors else ""
    if found is None or case is None:
        sys.stdout.write(f"no unsafe landing in {result.landings}{errors}; the least margin is {result.margin_min}\n")
        return
    sys.stdout.write(
        f"unsafe in landing {found.landing} of at most {request.landings}: margin {found.outcome.margin:.3f},"
        f" {found.outcome.reason}\n"
        f"reduced to {len(case.chosen)} of {len(found.chosen)} quantities: margin {case.outcome.margin:.3f},"
        f" {case.outcome.reason}\n"
        f"fly it: scenarios run {folder / 'case.toml'} --lockstep --seed {case.seed}\n"
    )
