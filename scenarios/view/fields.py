"""Numbers from the fields of messages, as `link.payloads.decklander_msgs.fields_of` gives them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from link.messages import Vector3
from link.payloads.checks import PayloadError
from link.units import NS_PER_S

Array = NDArray[np.float64]


def stamp_ns(fields: dict[str, Any]) -> int:
    """Return the stamp of a message's header."""
    return int(fields["header.stamp.sec"]) * NS_PER_S + int(fields["header.stamp.nanosec"])


def finite(values: Array) -> Array:
    """Return numbers, all of which are finite.

    Raises:
        PayloadError: one of them is not.
    """
    if not np.isfinite(values).all():
        raise PayloadError("a number is not finite")
    return values


def rows(values: Array) -> Array:
    """Return vectors that follow one another as (n, 3).

    Raises:
        PayloadError: one of them is not whole, or not finite.
    """
    if len(values) % 3:
        raise PayloadError(f"{len(values)} numbers are no vectors of three")
    return finite(values).reshape(-1, 3)


def vector(values: Array) -> Vector3 | None:
    """Return one vector, None where it is unknown.

    Raises:
        PayloadError: it has not three numbers, or one that is not finite.
    """
    finite(values)
    if len(values) not in {0, 3}:
        raise PayloadError(f"{len(values)} numbers are no vector of three")
    return (float(values[0]), float(values[1]), float(values[2])) if len(values) else None


def number(values: Array) -> float | None:
    """Return a number, None where it is unknown.

    Raises:
        PayloadError: it is not finite.
    """
    return float(finite(values)[0]) if len(values) else None
