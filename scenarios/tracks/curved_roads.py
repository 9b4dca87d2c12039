"""Smooth roads through waypoints: cubic splines over the chords' lengths, straight at both ends, as many short arcs."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from scenarios.tracks.roads import Point, Road, road_of

_ARCS_PER_CHORD = 64  # of 0.1 to 0.3 m on the report's road, which is then within 0.1 mm of the spline


def curve_through(waypoints_m: Sequence[Point]) -> tuple[Road, list[float]]:
    """Return the smooth road and its length from each of `waypoints_m` to the next.

    Raises:
        ValueError: fewer than two waypoints, or two equal neighbours.
    """
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
