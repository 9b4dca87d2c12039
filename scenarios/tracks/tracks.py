"""Courses of the benchmark's tracks.

Every course passes the waiting point at (0, 0) and, but for the report's and the parked one, at its full speed.
Sources: MBZIRC 2017 for the figure eight (circles of radius 16.5 m, centres at ±23.3 m); the report's table of
waypoints for `waypoints`; an Ornstein-Uhlenbeck process in its exact discretisation for `random`.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import assert_never

import numpy as np

from link.records import replace
from scenarios.tracks.config import (
    BrakeTrack,
    CircleTrack,
    FigureEightTrack,
    LaneChangeTrack,
    MovingTrack,
    RandomTrack,
    RoughRoadTrack,
    StaticTrack,
    StopAndGoTrack,
    StraightTrack,
    TrackConfig,
    WaypointsTrack,
)
from scenarios.tracks.course import BrakeEvent, Course, Roughness, Wave
from scenarios.tracks.drive import drive_course
from scenarios.tracks.drive_config import DriveTrack, VesselTrack
from scenarios.tracks.heights import Slope
from scenarios.tracks.profiles import Profile, cruise_steps, profile_of, waypoint_steps
from scenarios.tracks.roads import Piece, Point, advance, curve_through, cusps_of, polyline, road_of
from scenarios.tracks.seaway import seaway_of

Steps = list[tuple[float, float]]
_CURVE_STEP_M = 0.1  # pieces of a lane change: the heading is then within 0.1 mrad of the smooth curve
_RANDOM_STEP_S = 0.01
_SPEED_BAND = 0.5  # a random vehicle keeps within this share of its mean speed
_TURN_RADIUS_MIN_M = 6.0  # of a car


def course_of(track: TrackConfig, rng: np.random.Generator) -> Course:  # noqa: C901, PLR0911, PLR0912 (one case for each kind of track)
    """Return the course of `track`; `rng` decides what is random in it."""
    match track:
        case StaticTrack():
            return Course(road=road_of([(1.0, 0.0)], start_m=track.parked_at_m), profile=profile_of([]))
        case WaypointsTrack():
            return _waypoints_course(track)
        case BrakeTrack():
            height_m = float(rng.uniform(*track.brake_height_range_m))
            event = BrakeEvent(deceleration_m_s2=track.deceleration_m_s2, height_above_roof_m=height_m)
            return replace(_open_course(track, [(road_m(track), 0.0)]), brake=event)
        case RoughRoadTrack():
            return _rough_course(track, rng)
        case StraightTrack():
            return _open_course(track, [(road_m(track), 0.0)])
        case FigureEightTrack():
            return _loop_course(track, _figure_eight(track), heading_rad=-_crossing_rad(track))
        case CircleTrack():
            return _loop_course(track, [(2.0 * math.pi * track.radius_m, 1.0 / track.radius_m)], heading_rad=0.0)
        case StopAndGoTrack():
            return _stop_and_go_course(track)
        case LaneChangeTrack():
            return _open_course(track, _lane_change(track))
        case RandomTrack():
            return _random_course(track, rng)
        case VesselTrack():
            return _vessel_course(track, rng)
        case DriveTrack():
            return drive_course(track)
        case _:
            assert_never(track)


def approach_m(track: MovingTrack) -> float:
    """Return how far before the waiting point the vehicle starts (m): it speeds up, then cruises `approach_s`."""
    speeding_up_m = 0.5 * track.speed_m_s**2 / track.acceleration_m_s2
    return max(track.approach_min_m, speeding_up_m + track.approach_s * track.speed_m_s)


def road_m(track: MovingTrack) -> float:
    """Return the length of road behind the waiting point (m)."""
    return max(track.road_min_m, track.road_s * track.speed_m_s)


def _start(track: MovingTrack, heading_rad: float) -> Point:
    before_m = approach_m(track)
    return -before_m * math.cos(heading_rad), -before_m * math.sin(heading_rad)


def _open_course(track: MovingTrack, stretches: Steps, slope: Slope | None = None) -> Course:
    """Return a course on `stretches` (m, 1/m) behind the waiting point, at constant speed until it stops at the end."""
    road = road_of([(approach_m(track), 0.0), *stretches], start_m=_start(track, 0.0), slope=slope)
    return Course(road=road, profile=_cruise(track, road.length_m))


def _cruise(track: MovingTrack, distance_m: float) -> Profile:
    return profile_of(
        cruise_steps(
            speed_m_s=track.speed_m_s,
            distance_m=distance_m,
            acceleration_m_s2=track.acceleration_m_s2,
            braking_m_s2=track.braking_m_s2,
        )
    )


def _loop_course(track: MovingTrack, loop: Steps, *, heading_rad: float) -> Course:
    """Return a course that runs up straight to the waiting point and repeats `loop` from there for ever."""
    stretches = [(approach_m(track), 0.0), *loop]
    road = road_of(stretches, start_m=_start(track, heading_rad), heading_rad=heading_rad, loop_from=1)
    speeding_up_s = track.speed_m_s / track.acceleration_m_s2
    return Course(road=road, profile=profile_of([(speeding_up_s, track.acceleration_m_s2)]))


def _crossing_rad(track: FigureEightTrack) -> float:
    """Return the angle between the tangents through the crossing and the line of the centres."""
    return math.asin(track.radius_m / track.centre_m)


def _figure_eight(track: FigureEightTrack) -> Steps:
    """Return the loop from the crossing: right circle counter-clockwise, crossing, left circle clockwise."""
    tangent_m = math.sqrt(track.centre_m**2 - track.radius_m**2)
    arc_m = track.radius_m * (math.pi + 2.0 * _crossing_rad(track))
    turn_per_m = 1.0 / track.radius_m
    return [(tangent_m, 0.0), (arc_m, turn_per_m), (2.0 * tangent_m, 0.0), (arc_m, -turn_per_m), (tangent_m, 0.0)]


def _waypoints_course(track: WaypointsTrack) -> Course:
    """Return the report's course; behind the last waypoint the vehicle brakes to a stop, straight on.

    Where it stops and the lines lead back, it does not turn round: it backs up.
    """
    if track.smooth:
        road, distances_m = curve_through(track.waypoints_m)
    else:
        road, distances_m = polyline(track.waypoints_m), [math.dist(a, b) for a, b in pairwise(track.waypoints_m)]
    braking_s = track.speeds_m_s[-1] / track.braking_m_s2
    steps = [*waypoint_steps(distances_m, track.speeds_m_s), (braking_s, -track.braking_m_s2)]
    cusps_m = () if track.smooth else cusps_of(track.waypoints_m, track.speeds_m_s)
    return Course(road=road, profile=profile_of(steps, speed_m_s=track.speeds_m_s[0]), cusps_m=cusps_m)


def _stop_and_go_course(track: StopAndGoTrack) -> Course:
    """Return a straight course of as many cycles of going and standing as the road holds."""
    speed_m_s = track.speed_m_s
    go_s, stop_s = speed_m_s / track.acceleration_m_s2, speed_m_s / track.braking_m_s2
    cycle = [(go_s, track.acceleration_m_s2), (track.cruise_s, 0.0), (stop_s, -track.braking_m_s2), (track.stop_s, 0.0)]
    cycle_m = speed_m_s * (0.5 * go_s + track.cruise_s + 0.5 * stop_s)
    length_m = approach_m(track) + road_m(track)
    road = road_of([(length_m, 0.0)], start_m=_start(track, 0.0))
    return Course(road=road, profile=profile_of(cycle * max(1, int(length_m / cycle_m))))


def _lane_change(track: LaneChangeTrack) -> Steps:
    """Return a straight, the lane change, a straight, the turn to the left and the straight behind it."""
    speed_m_s = track.speed_m_s
    change = _sine_curve(length_m=track.change_s * speed_m_s, offset_m=track.offset_m)
    turn = (0.5 * math.pi * track.turn_radius_m, 1.0 / track.turn_radius_m)
    return [
        (track.change_after_s * speed_m_s, 0.0),
        *change,
        (track.turn_after_s * speed_m_s, 0.0),
        turn,
        (road_m(track), 0.0),
    ]


def _sine_curve(*, length_m: float, offset_m: float) -> Steps:
    """Return pieces whose curvature is one period of a sine over `length_m` and that end `offset_m` to the left."""
    count = math.ceil(length_m / _CURVE_STEP_M)
    shape = [math.sin(2.0 * math.pi * (i + 0.5) / count) for i in range(count)]
    low, high = 0.0, 2.0 * math.pi / length_m  # heading of up to 2 rad in the middle
    for _ in range(60):
        middle = 0.5 * (low + high)
        pieces = [(length_m / count, middle * value) for value in shape]
        low, high = (middle, high) if _end_y_m(pieces) < offset_m else (low, middle)
    return [(length_m / count, high * value) for value in shape]


def _end_y_m(stretches: Sequence[tuple[float, float]]) -> float:
    x_m, y_m, heading_rad = 0.0, 0.0, 0.0
    for length_m, curvature_per_m in stretches:
        piece = Piece(s_m=0.0, x_m=x_m, y_m=y_m, heading_rad=heading_rad, curvature_per_m=curvature_per_m)
        x_m, y_m, heading_rad = advance(piece, length_m)
    return y_m


def _rough_course(track: RoughRoadTrack, rng: np.random.Generator) -> Course:
    """Return a straight course that climbs behind the waiting point (before it, the ground would cover the road)."""
    course = _open_course(track, [(road_m(track), 0.0)], Slope(grade=track.grade, start_s_m=approach_m(track)))

    def wave(amplitude: float, frequency_hz: float) -> Wave:
        phase_rad = float(rng.uniform(0.0, 2.0 * math.pi))
        return Wave(amplitude=amplitude, wavelength_m=track.speed_m_s / frequency_hz, phase_rad=phase_rad)

    roughness = Roughness(
        heave=wave(track.shake.heave_m, track.shake.heave_hz),
        roll=wave(track.shake.roll_rad, track.shake.roll_hz),
        pitch=wave(track.shake.pitch_rad, track.shake.pitch_hz),
    )
    return replace(course, roughness=roughness)


def _vessel_course(track: VesselTrack, rng: np.random.Generator) -> Course:
    """Return a straight course at a drawn speed through waves from a drawn direction about the bow."""
    speed_m_s = float(rng.uniform(*track.speed_range_m_s))
    beta_rad = math.pi + float(rng.uniform(-track.off_bow_max_rad, track.off_bow_max_rad))
    way = StraightTrack(
        kind="straight", speed_m_s=speed_m_s, acceleration_m_s2=track.acceleration_m_s2, road_s=track.run_s
    )
    course = _open_course(way, [(road_m(way), 0.0)])
    return replace(course, seaway=seaway_of(track, speed_m_s, beta_rad, rng))


def _random_course(track: RandomTrack, rng: np.random.Generator) -> Course:
    """Return a course whose acceleration wanders, along and across, from the waiting point on."""
    before_m = approach_m(track)
    speeding_up_s = track.speed_m_s / track.acceleration_m_s2
    cruise_s = (before_m - 0.5 * track.speed_m_s * speeding_up_s) / track.speed_m_s
    steps: Steps = [(speeding_up_s, track.acceleration_m_s2), (cruise_s, 0.0)]
    stretches: Steps = [(before_m, 0.0)]
    decay = math.exp(-_RANDOM_STEP_S / track.tau_s)
    kick_m_s2 = track.sigma_m_s2 * math.sqrt(1.0 - decay**2)
    slowest_m_s, fastest_m_s = (1.0 - _SPEED_BAND) * track.speed_m_s, (1.0 + _SPEED_BAND) * track.speed_m_s
    speed_m_s, along_m_s2, across_m_s2 = track.speed_m_s, 0.0, 0.0
    for along_kick, across_kick in rng.standard_normal((round(track.road_s / _RANDOM_STEP_S), 2)).tolist():
        along_m_s2 = decay * along_m_s2 + kick_m_s2 * along_kick
        across_m_s2 = decay * across_m_s2 + kick_m_s2 * across_kick
        next_m_s = speed_m_s + along_m_s2 * _RANDOM_STEP_S
        if not slowest_m_s < next_m_s < fastest_m_s:
            along_m_s2, next_m_s = 0.0, speed_m_s
        tightest_per_m = 1.0 / _TURN_RADIUS_MIN_M
        curvature_per_m = min(tightest_per_m, max(-tightest_per_m, across_m_s2 / speed_m_s**2))
        stretches.append((0.5 * (speed_m_s + next_m_s) * _RANDOM_STEP_S, curvature_per_m))
        steps.append((_RANDOM_STEP_S, along_m_s2))
        speed_m_s = next_m_s
    steps.append((speed_m_s / track.braking_m_s2, -track.braking_m_s2))
    return Course(road=road_of(stretches, start_m=_start(track, 0.0)), profile=profile_of(steps))
