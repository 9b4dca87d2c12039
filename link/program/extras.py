"""What is installed beside the base, by what a machine does, and one clear line when it is missing.

The extras of pyproject.toml by the modules that they bring; each is looked for before a command begins, not when half
a campaign has been flown.
"""

import importlib.util
from typing import Final

from link.errors import UserError

EXTRAS: Final = {
    "sim": ("filterpy", "osqp"),
    "campaign": ("cma", "loky", "polars"),
    "report": ("jinja2", "matplotlib"),
    "view": ("viser", "websockets"),
    "foxglove": ("foxglove",),
    "dask": ("distributed",),
    "camera": ("cv2", "fpdf", "simplejpeg"),
}
"""Extra: the modules that it brings. filterpy is no part of the base since it brings matplotlib along."""


def require(extra: str, needed_by: str) -> None:
    """Find out whether an extra is installed.

    Args:
        extra: one of `EXTRAS`.
        needed_by: what is wanted of the program, as the user wrote it.

    Raises:
        UserError: it is not; the line says how to install it.
    """
    missing = [name for name in EXTRAS[extra] if importlib.util.find_spec(name) is None]
    if missing:
        raise UserError(f"{needed_by} needs {', '.join(missing)}: install the extra '{extra}' (docs/install.md)")
