"""Roads of stretches whose curvature grows evenly: straights, arcs, and the clothoids between them."""

import math
from collections.abc import Sequence
from itertools import pairwise

from scenarios.tracks.heights import FLAT, GradeLine, Slope
from scenarios.tracks.roads import Piece, Point, Road, advance

_TURN_MAX_RAD = 0.5  # in one piece, for the integral of its direction


def clothoid_road(
    stretches: Sequence[tuple[float, float, float]],
    *,
    start_m: Point,
    heading_rad: float,
    slope: Slope | GradeLine | None = None,
) -> Road:
    """Return the open road made of `stretches`, whose curvatures grow evenly from one end to the other.

    Args:
        stretches: (length in m, curvature in 1/m at its beginning, at its end) of each.
        start_m: x, y of the first point in W.
        heading_rad: direction of travel there.
        slope: its height, None for a flat road.

    Raises:
        ValueError: no stretch, or one without length.
    """
    if not stretches or any(length_m <= 0.0 for length_m, _, _ in stretches):
        raise ValueError(f"a road needs stretches of positive length, not {list(stretches)}")
    pieces: list[Piece] = []
    s_m, (x_m, y_m), direction_rad = 0.0, start_m, heading_rad
    for length_m, curvature_per_m, end_per_m in (part for one in stretches for part in _parts(*one)):
        piece = Piece(
            s_m=s_m,
            x_m=x_m,
            y_m=y_m,
            heading_rad=direction_rad,
            curvature_per_m=curvature_per_m,
            growth_per_m2=(end_per_m - curvature_per_m) / length_m,
        )
        pieces.append(piece)
        x_m, y_m, direction_rad = advance(piece, length_m)
        s_m += length_m
    starts_m = tuple(piece.s_m for piece in pieces)
    return Road(pieces=tuple(pieces), starts_m=starts_m, length_m=s_m, slope=slope or FLAT)


def _parts(length_m: float, begin_per_m: float, end_per_m: float) -> list[tuple[float, float, float]]:
    """Return a stretch in as many equal parts as keep the turn of each within what the integral is good for."""
    if begin_per_m == end_per_m:
        return [(length_m, begin_per_m, end_per_m)]
    turn_rad = max(abs(begin_per_m), abs(end_per_m)) * length_m
    count = max(1, math.ceil(turn_rad / _TURN_MAX_RAD))
    bends = [begin_per_m + (end_per_m - begin_per_m) * i / count for i in range(count + 1)]
    return [(length_m / count, before, after) for before, after in pairwise(bends)]
