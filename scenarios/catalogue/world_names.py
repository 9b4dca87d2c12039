"""The names of worlds and of their slices: `world`, `world:urban`, `world:urban@123`, each perhaps with its firmware.

All characters mean themselves in a shell and in a file's name.
"""

import re
from dataclasses import dataclass

from link.errors import UserError
from scenarios.catalogue.firmware_option import OPTION, with_firmware
from scenarios.config import FIRMWARES, FirmwareName
from scenarios.worlds.odd import slices

_WHOLE = re.compile(r"(?P<slice>[^@+]+)(?:@(?P<seed>\d+))?(?:\+(?P<option>.*))?")
_STARTS = ("world:", "world@", "world+")


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldName:
    """What a name says.

    Attributes:
        slice: of the worlds, the whole of them is one too.
        seed: of one of them, None where all are meant.
        firmware: that they are flown with, None for what each draws.
    """

    slice: str
    seed: int | None = None
    firmware: FirmwareName | None = None

    @property
    def text(self) -> str:
        """The name as it is written."""
        one = self.slice if self.seed is None else f"{self.slice}@{self.seed}"
        return one if self.firmware is None else with_firmware(one, self.firmware)


def names_worlds(name: str) -> bool:
    """Return whether `name` means worlds, rather than a scenario of the catalogue or a file."""
    return name == "world" or name.startswith(_STARTS)


def parse_world_name(name: str) -> WorldName:
    """Return what a name says of which `names_worlds` is true.

    Raises:
        UserError: it is not written as one, there is no such slice or firmware, or an option that a world draws.
    """
    found = _WHOLE.fullmatch(name)
    if found is None:
        raise UserError(f"'{name}' names no world: write SLICE@SEED, such as {slices()[-1]}@1")
    slice_name, seed, option = found["slice"], found["seed"], found["option"]
    if slice_name not in slices():
        raise UserError(f"no slice of the worlds is called '{slice_name}': take one of {', '.join(slices())}")
    return WorldName(
        slice=slice_name,
        seed=None if seed is None else int(seed),
        firmware=None if option is None else _firmware(option, name),
    )


def _firmware(option: str, name: str) -> FirmwareName:
    chosen = next((one for one in FIRMWARES if option == f"{OPTION}{one}"), None)
    if chosen is None:
        choices = ", ".join(f"+{OPTION}{one}" for one in FIRMWARES)
        raise UserError(f"{name}: a world draws everything but its firmware: only {choices} may be behind it")
    return chosen


def run_seed(name: str, asked: int | None) -> int:
    """Return the seed of a run of the scenario called `name`: what is asked for, else that of the world, else 1."""
    if asked is not None:
        return asked
    own = parse_world_name(name).seed if names_worlds(name) else None
    return 1 if own is None else own
