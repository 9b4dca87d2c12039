"""Parameters to be written, and the file that keeps those before them."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from companion.check.findings import Finding
from link.errors import UserError


def advised_values(findings: Sequence[Finding]) -> dict[str, float]:
    """Return the parameters that have an advised value, by name."""
    return {one.name: one.set_to for one in findings if one.set_to is not None}


def keep(path: Path, before: Mapping[str, float]) -> None:
    """Write the values before a change; those that the file has from an earlier change are older and stay.

    Raises:
        UserError: the file cannot be written, or is another's.
    """
    earlier = kept(path) if path.exists() else {}
    try:
        path.write_text(json.dumps({**before, **earlier}, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --keep FILE") from error


def kept(path: Path) -> dict[str, float]:
    """Return the parameters of a file that `keep` wrote.

    Raises:
        UserError: the file cannot be read, or holds something else.
    """
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); name the file that --set kept") from error
    except ValueError as error:
        raise UserError(f"{path}: is no file of parameters: {error}") from error
    is_numbers = isinstance(values, dict) and all(
        isinstance(value, int | float) and math.isfinite(value) for value in values.values()
    )
    if not is_numbers:
        raise UserError(f"{path}: is no file of parameters: it has to be one object of names and numbers")
    return {str(name): float(value) for name, value in values.items()}
