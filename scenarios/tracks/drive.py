"""The course of a drive that is given in numbers.

A lane change or a swerve adds to the road's curvature: a triangle to one side and one to the other, each half of its
length, k at most. To the first order in the angle the path ends k L^2 / 8 beside the road, in its direction.
"""

from collections.abc import Sequence

import numpy as np

from scenarios.tracks.clothoids import clothoid_road
from scenarios.tracks.course import BrakeEvent, Course
from scenarios.tracks.drive_config import SHIFT_CURVATURE, DriveTrack
from scenarios.tracks.heights import FLAT, grade_line
from scenarios.tracks.profiles import Profile, profile_of
from scenarios.tracks.roads import Road
from scenarios.tracks.suspension import STEP_S, Array, Driven, Surface, sway_of

Stretch = tuple[float, float, float]
Shift = tuple[float, float, float]
_SETTLING_S = 10.0  # behind the last leg: the slowest body has come to rest
_SHAPE = ((0.0, 0.0), (0.25, 1.0), (0.75, -1.0), (1.0, 0.0))  # of a shift's curvature, over its length
_SAME_PLACE_M = 1e-9


def drive_course(track: DriveTrack) -> Course:
    """Return the course of `track`."""
    slope = grade_line(track.grades) if track.grades else FLAT
    stretches = shifted(track.stretches, track.shifts)
    road = clothoid_road(stretches, start_m=track.begins_m, heading_rad=track.heading_rad, slope=slope)
    profile = profile_of(track.legs)
    surface = Surface(waves=track.waves, humps=track.humps)
    sway = sway_of(driven(road, profile), surface, track.suspension)
    brake = None if track.brake is None else BrakeEvent(**track.brake.model_dump(), suspension=track.suspension)
    return Course(road=road, profile=profile, brake=brake, sway=sway)


def shifted(stretches: Sequence[Stretch], shifts: Sequence[Shift]) -> list[Stretch]:
    """Return `stretches` with the curvature of `shifts`, cut where either changes its growth."""
    if not shifts:
        return list(stretches)
    ends_m = np.cumsum([length_m for length_m, _, _ in stretches])
    begins_m = ends_m - [length_m for length_m, _, _ in stretches]
    corners_m = [place_m + part * length_m for place_m, length_m, _ in shifts for part, _ in _SHAPE]
    cuts_m = np.unique([0.0, *ends_m, *(one for one in corners_m if one < ends_m[-1])])
    cuts_m = cuts_m[np.append(True, np.diff(cuts_m) > _SAME_PLACE_M)]
    middles_m = 0.5 * (cuts_m[1:] + cuts_m[:-1])
    owners = np.minimum(np.searchsorted(ends_m, middles_m), len(stretches) - 1)
    rows = np.array(stretches)[owners]
    growth = (rows[:, 2] - rows[:, 1]) / rows[:, 0]
    extra = sum((_shift_curvature(cuts_m, one) for one in shifts), np.zeros(len(cuts_m)))
    before = rows[:, 1] + growth * (cuts_m[:-1] - begins_m[owners]) + extra[:-1]
    after = rows[:, 1] + growth * (cuts_m[1:] - begins_m[owners]) + extra[1:]
    return list(zip(np.diff(cuts_m).tolist(), before.tolist(), after.tolist(), strict=True))


def _shift_curvature(s_m: Array, shift: Shift) -> Array:
    place_m, length_m, offset_m = shift
    places, shape = zip(*_SHAPE, strict=True)
    return SHIFT_CURVATURE * offset_m / length_m**2 * np.interp((s_m - place_m) / length_m, places, shape)


def driven(road: Road, profile: Profile) -> Driven:
    """Return the drive in the middle of each step of the body's grid, from departure until it has come to rest."""
    count = round((profile.starts_s[-1] + _SETTLING_S) / STEP_S)
    t_s = (np.arange(count) + 0.5) * STEP_S
    legs = np.array([(leg.t_s, leg.s_m, leg.speed_m_s, leg.acceleration_m_s2) for leg in profile.legs])
    began_s, began_m, began_m_s, along_m_s2 = legs[np.searchsorted(legs[:, 0], t_s, side="right") - 1].T
    passed_s = t_s - began_s
    s_m = began_m + (began_m_s + 0.5 * along_m_s2 * passed_s) * passed_s
    speed_m_s = began_m_s + along_m_s2 * passed_s
    curvature_per_m = curvatures(road, s_m)
    return Driven(s_m=s_m, speed_m_s=speed_m_s, along_m_s2=along_m_s2, left_m_s2=curvature_per_m * speed_m_s**2)


def curvatures(road: Road, s_m: Array) -> Array:
    """Return the curvature (n,) of an open road at each of `s_m` (n,)."""
    pieces = np.array([(piece.s_m, piece.curvature_per_m, piece.growth_per_m2) for piece in road.pieces])
    starts_m, bends_per_m, growths_per_m2 = pieces[np.searchsorted(pieces[:, 0], s_m, side="right") - 1].T
    return np.where(s_m > road.length_m, 0.0, bends_per_m + growths_per_m2 * (s_m - starts_m))
