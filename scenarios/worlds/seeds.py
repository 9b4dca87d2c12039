"""Which seeds of the worlds are to work with, and which are held back for published figures.

Whatever is tuned, by hand or by a search, is tuned on seeds below 500,000. Those from 500,000 to 999,999 are flown for
a published figure only, at most once in a release: `held_back.toml` beside this file says which were, and by which
commit. What was flown can be loaded by its name from then on, so that a published figure's worst landings replay.
"""

from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

from pydantic import Field

from link.errors import UserError
from link.program.toml_config import StrictModel, load_config

HELD_BACK_FROM = 500_000
SEEDS_END = 1_000_000

FLOWN_FILE = Path(__file__).with_name("held_back.toml")


class FlownRange(StrictModel):
    """Held-back seeds of a slice that were flown.

    Attributes:
        slice: of the worlds.
        first_seed: the others follow.
        seeds: how many.
        release: of this project, that flew them.
        commit: of this project, that flew them.
    """

    slice: str
    first_seed: Annotated[int, Field(ge=HELD_BACK_FROM, lt=SEEDS_END)]
    seeds: Annotated[int, Field(ge=1)]
    release: str
    commit: str

    def overlaps(self, slice_name: str, seeds: range) -> bool:
        """Return whether one of `seeds` of a slice was flown."""
        return self.slice == slice_name and self.first_seed < seeds.stop and seeds.start < self.first_seed + self.seeds


class _FlownRanges(StrictModel):
    flown: tuple[FlownRange, ...] = ()


def read_flown(path: Path = FLOWN_FILE) -> tuple[FlownRange, ...]:
    """Return which held-back seeds were flown.

    Raises:
        UserError: the file cannot be read, or does not fit.
    """
    return load_config(path, _FlownRanges).flown


def add_flown(ranges: Iterable[FlownRange], path: Path = FLOWN_FILE) -> None:
    """Write down that held-back seeds are flown, behind those that were.

    Raises:
        UserError: the file cannot be written.
    """
    lines = [
        f'\n[[flown]]\nslice = "{one.slice}"\nfirst_seed = {one.first_seed}\nseeds = {one.seeds}\n'
        f'release = "{one.release}"\ncommit = "{one.commit}"\n'
        for one in ranges
    ]
    try:
        with path.open("a", encoding="utf-8") as file:
            file.write("".join(lines))
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}), so no held-back seed is flown") from None


def check_seeds(seeds: range, *, held_back: bool) -> None:
    """Check that seeds are all to work with, or all held back and meant to be.

    Raises:
        UserError: they are not.
    """
    first, last = seeds[0], seeds[-1]
    if last >= SEEDS_END:
        raise UserError(f"worlds have seeds below {SEEDS_END}, not {last}: change --first-seed or --seeds")
    if first < HELD_BACK_FROM <= last:
        raise UserError(
            f"seeds {first} to {last} mix those to work with, below {HELD_BACK_FROM}, with held-back ones:"
            " change --first-seed or --seeds"
        )
    if first >= HELD_BACK_FROM and not held_back:
        raise UserError(
            f"seeds from {HELD_BACK_FROM} on are held back for published figures:"
            " work with lower ones, or give --held-back to fly such a figure"
        )
    if first < HELD_BACK_FROM and held_back:
        raise UserError(f"--held-back is about seeds from {HELD_BACK_FROM} on, not {first}: leave it out")


def check_not_flown(slices: Iterable[str], seeds: range, flown: Iterable[FlownRange]) -> None:
    """Check that this release has not flown held-back seeds yet.

    Raises:
        UserError: it has.
    """
    ranges = tuple(flown)
    for slice_name in slices:
        for one in ranges:
            if one.release == release() and one.overlaps(slice_name, seeds):
                raise UserError(
                    f"release {one.release} has flown seeds {one.first_seed} to {one.first_seed + one.seeds - 1} of"
                    f" {slice_name} (commit {one.commit[:7]}): a release flies a held-back seed once, choose others"
                )


def check_world(slice_name: str, seed: int) -> None:
    """Check that one world may be loaded by its name: its seed is to work with, or was flown for a published figure.

    Raises:
        UserError: it may not.
    """
    if not 0 <= seed < SEEDS_END:
        raise UserError(f"worlds have seeds below {SEEDS_END}, not {seed}")
    seeds = range(seed, seed + 1)
    if seed >= HELD_BACK_FROM and not any(one.overlaps(slice_name, seeds) for one in read_flown()):
        raise UserError(
            f"seed {seed} of {slice_name} is held back, and was flown for no published figure:"
            f" take one below {HELD_BACK_FROM}"
        )


def release() -> str:
    """Return which release of this project this is."""
    return version("decklander")
