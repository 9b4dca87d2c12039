"""Roads as chains of pieces whose curvature is constant or grows evenly, evaluated at any arc length.

State of a point on a road: position x, y (m, W), heading (rad, counter-clockwise from East), curvature (1/m,
positive to the left). Arc length `s_m` is horizontal and starts at the road's first point. A straight line is a
piece of zero curvature, a circle's arc one piece, a clothoid a few; any other smooth curve is many short arcs.
Lines and arcs are closed forms. A clothoid's place is the integral of its direction, by Gauss and Legendre's rule of
eight points, which is exact to rounding for the half a radian that a piece turns at most.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import accumulate, pairwise

import numpy as np
from msgspec import Struct

from scenarios.tracks.heights import FLAT, GradeLine, Slope

Point = tuple[float, float]
_STRAIGHT_PER_M = 1e-9  # below this curvature the chord and the arc agree to double precision
_GAUSS = [
    (0.5 * (x + 1.0), 0.5 * w) for x, w in zip(*(a.tolist() for a in np.polynomial.legendre.leggauss(8)), strict=True)
]
_ARCS_PER_CHORD = 64  # of 0.1 to 0.3 m on the report's road, which is then within 0.1 mm of the spline


class Piece(Struct, frozen=True, kw_only=True):
    """A stretch that starts at `s_m` in `x_m`, `y_m` with `heading_rad`, and its curvature there, which may grow."""

    s_m: float
    x_m: float
    y_m: float
    heading_rad: float
    curvature_per_m: float
    growth_per_m2: float = 0.0


class RoadPoint(Struct, frozen=True, kw_only=True):
    """Where the road is and how it bends; the height is `grade` integrated, with its two derivatives by arc length."""

    x_m: float
    y_m: float
    z_m: float
    heading_rad: float
    curvature_per_m: float
    grade: float
    grade_change_per_m: float


class Road(Struct, frozen=True, kw_only=True):
    """A road of `length_m`; a closed one repeats from `loop_s_m`, an open one goes on straight behind its end.

    Attributes:
        pieces: in the order of travel.
        starts_m: the pieces' arc lengths, for the search.
        length_m: arc length at the end.
        loop_s_m: where a closed road's loop begins; None for an open road.
        slope: its height.
    """

    pieces: tuple[Piece, ...]
    starts_m: tuple[float, ...]
    length_m: float
    loop_s_m: float | None = None
    slope: Slope | GradeLine = FLAT

    def at(self, s_m: float) -> RoadPoint:
        """Return the road at arc length `s_m` (m)."""
        on_plan_m = s_m
        if self.loop_s_m is not None and s_m > self.length_m:
            on_plan_m = self.loop_s_m + (s_m - self.loop_s_m) % (self.length_m - self.loop_s_m)
        piece = self.pieces[max(0, bisect_right(self.starts_m, on_plan_m) - 1)]
        if on_plan_m > self.length_m:
            end_x_m, end_y_m, heading_rad = advance(piece, self.length_m - piece.s_m)
            piece = Piece(s_m=self.length_m, x_m=end_x_m, y_m=end_y_m, heading_rad=heading_rad, curvature_per_m=0.0)
        x_m, y_m, heading_rad = advance(piece, on_plan_m - piece.s_m)
        z_m, grade, grade_change_per_m = self.slope.at(s_m)
        return RoadPoint(
            x_m=x_m,
            y_m=y_m,
            z_m=z_m,
            heading_rad=heading_rad,
            curvature_per_m=piece.curvature_per_m + piece.growth_per_m2 * (on_plan_m - piece.s_m),
            grade=grade,
            grade_change_per_m=grade_change_per_m,
        )


def advance(piece: Piece, length_m: float) -> tuple[float, float, float]:
    """Return x, y (m) and heading (rad) `length_m` behind the start of `piece`."""
    curvature_per_m = piece.curvature_per_m
    if piece.growth_per_m2 != 0.0:
        return _along_clothoid(piece, length_m)
    if abs(curvature_per_m) < _STRAIGHT_PER_M:
        return (
            piece.x_m + length_m * math.cos(piece.heading_rad),
            piece.y_m + length_m * math.sin(piece.heading_rad),
            piece.heading_rad,
        )
    heading_rad = piece.heading_rad + curvature_per_m * length_m
    return (
        piece.x_m + (math.sin(heading_rad) - math.sin(piece.heading_rad)) / curvature_per_m,
        piece.y_m - (math.cos(heading_rad) - math.cos(piece.heading_rad)) / curvature_per_m,
        heading_rad,
    )


def _along_clothoid(piece: Piece, length_m: float) -> tuple[float, float, float]:
    x_m, y_m = 0.0, 0.0
    for place, weight in _GAUSS:
        along_m = place * length_m
        turned_rad = (piece.curvature_per_m + 0.5 * piece.growth_per_m2 * along_m) * along_m
        x_m += weight * math.cos(piece.heading_rad + turned_rad)
        y_m += weight * math.sin(piece.heading_rad + turned_rad)
    heading_rad = piece.heading_rad + (piece.curvature_per_m + 0.5 * piece.growth_per_m2 * length_m) * length_m
    return piece.x_m + x_m * length_m, piece.y_m + y_m * length_m, heading_rad


def road_of(
    stretches: Sequence[tuple[float, float]],
    *,
    start_m: Point = (0.0, 0.0),
    heading_rad: float = 0.0,
    loop_from: int | None = None,
    slope: Slope | GradeLine | None = None,
) -> Road:
    """Return the smooth road made of `stretches`.

    Args:
        stretches: (length in m, curvature in 1/m) of each piece.
        start_m: x, y of the first point in W.
        heading_rad: direction of travel there.
        loop_from: index of the piece that follows the last one again on a closed road; None for an open road.
        slope: its height, None for a flat road.

    Raises:
        ValueError: no stretch, or one without length.
    """
    if not stretches or any(length_m <= 0.0 for length_m, _ in stretches):
        raise ValueError(f"a road needs stretches of positive length, not {list(stretches)}")
    pieces: list[Piece] = []
    s_m, (x_m, y_m), direction_rad = 0.0, start_m, heading_rad
    for length_m, curvature_per_m in stretches:
        piece = Piece(s_m=s_m, x_m=x_m, y_m=y_m, heading_rad=direction_rad, curvature_per_m=curvature_per_m)
        pieces.append(piece)
        x_m, y_m, direction_rad = advance(piece, length_m)
        s_m += length_m
    return Road(
        pieces=tuple(pieces),
        starts_m=tuple(piece.s_m for piece in pieces),
        length_m=s_m,
        loop_s_m=None if loop_from is None else pieces[loop_from].s_m,
        slope=slope or FLAT,
    )


def polyline(waypoints_m: Sequence[Point]) -> Road:
    """Return the road of straight lines through `waypoints_m`; its heading jumps at the corners.

    Raises:
        ValueError: fewer than two waypoints, or two equal neighbours.
    """
    pieces: list[Piece] = []
    s_m = 0.0
    for (x_m, y_m), (next_x_m, next_y_m) in pairwise(waypoints_m):
        heading_rad = math.atan2(next_y_m - y_m, next_x_m - x_m)
        pieces.append(Piece(s_m=s_m, x_m=x_m, y_m=y_m, heading_rad=heading_rad, curvature_per_m=0.0))
        length_m = math.hypot(next_x_m - x_m, next_y_m - y_m)
        if length_m == 0.0:
            raise ValueError(f"waypoint ({x_m}, {y_m}) m is there twice")
        s_m += length_m
    if not pieces:
        raise ValueError(f"a road needs two waypoints, not {list(waypoints_m)}")
    return Road(pieces=tuple(pieces), starts_m=tuple(piece.s_m for piece in pieces), length_m=s_m)


def cusps_of(waypoints_m: Sequence[Point], speeds_m_s: Sequence[float]) -> tuple[float, ...]:
    """Return how far along a polyline a vehicle stops where the next line leads back."""
    places_m = accumulate(math.dist(a, b) for a, b in pairwise(waypoints_m))
    corners = zip(places_m, speeds_m_s[1:], waypoints_m, waypoints_m[1:], waypoints_m[2:], strict=False)
    return tuple(
        place_m
        for place_m, speed_m_s, (ax, ay), (bx, by), (cx, cy) in corners
        if speed_m_s == 0.0 and (bx - ax) * (cx - bx) + (by - ay) * (cy - by) < 0.0
    )


def curve_through(waypoints_m: Sequence[Point]) -> tuple[Road, list[float]]:
    """Return a smooth road and its length from each of `waypoints_m` to the next.

    A cubic spline over the chords' lengths, straight at both ends, as many short arcs.

    Raises:
        ValueError: fewer than two waypoints, or two equal neighbours.
    """
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 (0.2 s, and only a road through waypoints needs it)

    points = np.array(waypoints_m, dtype=np.float64)
    chords_m = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if len(points) < 2 or (chords_m == 0.0).any():
        raise ValueError(f"a road needs two waypoints, each different from the next, not {list(waypoints_m)}")
    knots = np.concatenate(([0.0], np.cumsum(chords_m)))
    spline = CubicSpline(knots, points, bc_type="natural")
    pieces = [np.linspace(*ends, _ARCS_PER_CHORD, endpoint=False) for ends in pairwise(knots)]
    along = np.append(np.concatenate(pieces), knots[-1])
    tangents = spline(along, 1)
    headings_rad = np.unwrap(np.arctan2(tangents[:, 1], tangents[:, 0]))
    turns_rad = np.diff(headings_rad)
    # a chord of a circle's arc is shorter than the arc by the sine's share
    arcs_m = np.linalg.norm(np.diff(spline(along), axis=0), axis=1) / np.sinc(0.5 * turns_rad / np.pi)
    stretches = list(zip(arcs_m.tolist(), (turns_rad / arcs_m).tolist(), strict=True))
    road = road_of(stretches, start_m=waypoints_m[0], heading_rad=float(headings_rad[0]))
    return road, arcs_m.reshape(-1, _ARCS_PER_CHORD).sum(axis=1).tolist()
