"""The option `firmware` in the name of a scenario or a campaign's cell."""

from collections.abc import Sequence

from link.errors import UserError
from scenarios.config import FIRMWARES

BOTH = "both"
OPTION = "firmware="


def with_firmware(name: str, firmware: str) -> str:
    """Return the name of a scenario flown with a firmware.

    Raises:
        UserError: there is no such firmware, or the name has one already.
    """
    if firmware not in FIRMWARES:
        raise UserError(f"--firmware is one of {', '.join(FIRMWARES)}, not '{firmware}'")
    if without_firmware(name) != name:
        raise UserError(f"'{name}' names its firmware: leave out that, or --firmware")
    return f"{name}+{OPTION}{firmware}"


def cells_with(cells: Sequence[str], firmware: str | None) -> list[str]:
    """Return the names of cells flown with a firmware, each with one after the other for `both`; None leaves them.

    Raises:
        UserError: there is no such firmware, or a cell has one already.
    """
    if firmware is None:
        return list(cells)
    if firmware not in {*FIRMWARES, BOTH}:
        raise UserError(f"--firmware is one of {', '.join((*FIRMWARES, BOTH))}, not '{firmware}'")
    chosen = FIRMWARES if firmware == BOTH else (firmware,)
    return [with_firmware(cell, one) for cell in cells for one in chosen]


def without_firmware(name: str) -> str:
    """Return a name without the option, so that what is flown with both has one name."""
    return "+".join(part for part in name.split("+") if not part.startswith(OPTION))


def firmware_text(firmwares: Sequence[str]) -> str:
    """Return the firmwares that there are, each once and in their order, as a table shows them."""
    return ", ".join(one for one in FIRMWARES if one in firmwares)


def side_by_side(cell: str, firmware: str) -> tuple[str, int, str]:
    """Return the key that sorts a cell next to the same one with the other firmware."""
    return without_firmware(cell), [*FIRMWARES, firmware].index(firmware), cell
