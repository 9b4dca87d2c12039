"""The road of a world: a run-up that is straight and flat, then elements one behind the other.

An element is a straight followed by nothing, a bend, a turn at a junction, or a roundabout; it may have a hump in the
middle of its straight and has a grade. A bend is a clothoid, an arc and a clothoid. A roundabout, in right-hand
traffic, is a bend to the right, one to the left about the island and one to the right again.
A road that would lead below the place where the drone starts climbs instead.
"""

import math
from dataclasses import dataclass

import numpy as np

from scenarios.simulation.noise import Seed, named_rng
from scenarios.tracks.drive import Stretch
from scenarios.worlds.draws import Draws
from sim_autopilot.physics.airframe import GRAVITY_M_S2

ELEMENTS = 16
TURN_RADIUS_MIN_M = 6.0
"""Of a car's path, and of the tightest bend in the domain."""
STEERING_MAX_PER_M_S = 0.45
"""The fastest change of curvature: 1000 degrees a second on the wheel, over a ratio of 15 and a wheelbase of 2.6 m."""
_ENTRY_RAD = 0.9  # by which a roundabout's entry and exit turn away from its island; a choice
_LATERAL_JERK_MAX_M_S3 = 3.0  # beyond the 1.2 m/s^3 of AASHTO's spirals, as at a junction; a choice
_GRIP_BEND_MAX = 0.5  # of the friction circle in a bend: AASHTO's side friction leaves more than half; a choice
_REFERENCE_PER_M = 0.1  # ISO 8608: spatial frequency, in cycles, at which roughness is told
_WAVELENGTHS_M = np.geomspace(1.0, 50.0, 17)  # edges; ISO 8608 fits up to 100 m; heave is told from the grade below 50
_SAME_GRADE = 1e-6  # a millimetre in a kilometre: for less there is no crest or dip, whose ends would be one place
_SLANT_MAX_RAD = 1.0  # of a wave against the road: uneven across as well as along; a choice


Hump = tuple[float, float, float]
"""Where its middle is along the road, its length and its height, m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """A speed that is not exceeded between two places."""

    from_m: float
    to_m: float
    speed_m_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadPlan:
    """A road in numbers, as `DriveTrack` takes it, and how fast this driver goes on it."""

    stretches: list[Stretch]
    grades: list[tuple[float, float]]
    humps: list[Hump]
    waves: list[tuple[float, float, float, float]]
    limits: list[Limit]


def plan_road(draws: Draws, seed: Seed, *, cruise_m_s: float, run_up_m: float, length_m: float) -> RoadPlan:
    """Return the road of a world.

    Args:
        draws: of the world.
        seed: of the phases of the roughness.
        cruise_m_s: that the driver drives where nothing keeps him from it.
        run_up_m: of road before the waiting point.
        length_m: of the whole road.
    """
    grip_m_s2 = draws.number("road.friction") * GRAVITY_M_S2
    lateral_m_s2 = min(draws.number("driver.lateral_acceleration_m_s2"), _GRIP_BEND_MAX * grip_m_s2)
    stretches: list[Stretch] = [(run_up_m, 0.0, 0.0)]
    humps: list[Hump] = []
    limits: list[Limit] = []
    slopes: list[tuple[float, float]] = []
    s_m = run_up_m
    hump_m_s = draws.number("driver.hump_speed_m_s")
    for slot in range(ELEMENTS):
        straight_m = draws.number("road.straight_m", slot)
        hump = _hump(draws, slot, s_m + 0.5 * straight_m)
        bends = _bends(draws, slot, cruise_m_s, lateral_m_s2)
        slopes.append((s_m, draws.number("road.grade", slot)))
        if s_m >= length_m:
            continue
        stretches.append((straight_m, 0.0, 0.0))
        s_m += straight_m
        if hump is not None:
            humps.append(hump)
            limits.append(_limit_over(hump, hump_m_s))
        for bend in bends:
            limit = _limit_in(bend, s_m, lateral_m_s2)
            stretches.extend(bend)
            limits.append(limit)
            s_m = limit.to_m
    slopes = [one for one in slopes if one[0] < s_m]
    stretches.append((max(1.0, length_m - s_m), 0.0, 0.0))
    return RoadPlan(
        stretches=stretches,
        grades=_grades(slopes, s_m, _crest_radius_m(draws, cruise_m_s)),
        humps=humps,
        waves=_waves(draws, seed),
        limits=limits,
    )


def _limit_over(hump: Hump, speed_m_s: float) -> Limit:
    """Return the limit of a driver who goes over a hump at `speed_m_s`, from 1 m before it to 1 m behind."""
    middle_m, length_m, _ = hump
    half_m = 0.5 * length_m + 1.0
    return Limit(from_m=middle_m - half_m, to_m=middle_m + half_m, speed_m_s=speed_m_s)


def _limit_in(bend: list[Stretch], begins_m: float, lateral_m_s2: float) -> Limit:
    """Return the limit of a driver who takes a bend with at most `lateral_m_s2`."""
    sharpest_per_m = max(abs(one[2]) for one in bend)
    return Limit(
        from_m=begins_m,
        to_m=begins_m + sum(one[0] for one in bend),
        speed_m_s=math.sqrt(lateral_m_s2 / sharpest_per_m),
    )


def _hump(draws: Draws, slot: int, middle_m: float) -> Hump | None:
    present = draws.yes("road.hump", slot)
    length_m, height_m = draws.number("road.hump_length_m"), draws.number("road.hump_height_m")
    return (middle_m, length_m, height_m) if present else None


def _bends(draws: Draws, slot: int, cruise_m_s: float, lateral_m_s2: float) -> list[list[Stretch]]:
    """Return the bends of an element, each a few stretches."""
    kind, side = draws.word("road.element", slot), 1.0 if draws.yes("road.to_left", slot) else -1.0
    radius_m, angle_rad = draws.number("road.radius_m", slot), draws.number("road.angle_rad", slot)
    turn_radius_m = draws.number("road.turn_radius_m", slot)
    island_m, exit_rad = draws.number("road.roundabout_radius_m", slot), draws.number("road.roundabout_exit_rad", slot)
    share = draws.number("road.clothoid_share", slot)

    def bend(radius_m: float, angle_rad: float, side: float) -> list[Stretch]:
        speed_m_s = min(cruise_m_s, math.sqrt(lateral_m_s2 * radius_m))
        swift_m = speed_m_s**3 / (radius_m * _LATERAL_JERK_MAX_M_S3)
        steered_m = speed_m_s / (radius_m * STEERING_MAX_PER_M_S)
        clothoid_m = min(max(share**2 * radius_m, swift_m, steered_m), 0.9 * angle_rad * radius_m)
        curvature_per_m = side / radius_m
        arc_m = angle_rad * radius_m - clothoid_m
        return [
            (clothoid_m, 0.0, curvature_per_m),
            (arc_m, curvature_per_m, curvature_per_m),
            (clothoid_m, curvature_per_m, 0.0),
        ]

    match kind:
        case "bend":
            return [bend(radius_m, angle_rad, side)]
        case "turn":
            return [bend(turn_radius_m, 0.5 * math.pi, side)]
        case "roundabout":
            away = bend(1.2 * island_m, _ENTRY_RAD, -1.0)
            return [away, bend(island_m, exit_rad + 2.0 * _ENTRY_RAD, 1.0), away]
    return []


def _crest_radius_m(draws: Draws, cruise_m_s: float) -> float:
    """Return the radius of crests and dips: as built, or wider for a driver who is fast."""
    built_m = draws.number("road.vertical_radius_m")
    return max(built_m, cruise_m_s**2 / draws.number("driver.vertical_acceleration_m_s2"))


def _grades(slopes: list[tuple[float, float]], end_m: float, radius_m: float) -> list[tuple[float, float]]:
    """Return the grades as places with even changes between them, in crests and dips of `radius_m` or less."""
    height_m, before = 0.0, 0.0
    points: list[tuple[float, float]] = [(0.0, 0.0)]
    ends_m = [place_m for place_m, _ in slopes[1:]] + [end_m]
    for (from_m, wanted), to_m in zip([*slopes, (end_m, 0.0)], [*ends_m, end_m + 2.0 * radius_m], strict=True):
        grade = wanted if height_m + wanted * (to_m - from_m) >= 0.0 else -wanted
        height_m += grade * (to_m - from_m)
        if abs(grade - before) < _SAME_GRADE:
            continue
        room_m = 0.9 * min(from_m - points[-1][0], 0.5 * (to_m - from_m))
        half_m = min(0.5 * abs(grade - before) * radius_m, room_m)
        points += [(from_m - half_m, before), (from_m + half_m, grade)]
        before = grade
    return points


def _waves(draws: Draws, seed: Seed) -> list[tuple[float, float, float, float]]:
    """Return the roughness as waves whose variances are the integral of ISO 8608's spectrum over bands."""
    degree_m3 = 1e-6 * draws.number("road.roughness_1e_6_m3")
    phases = named_rng(seed, "world road waves").random((len(_WAVELENGTHS_M) - 1, 2)).tolist()
    waves = []
    for short_m, long_m, (phase, slant) in zip(_WAVELENGTHS_M[:-1], _WAVELENGTHS_M[1:], phases, strict=True):
        # G(n) = G0 (n / n0)^-2 between 1 / long and 1 / short
        variance_m2 = degree_m3 * _REFERENCE_PER_M**2 * float(long_m - short_m)
        across = math.tan(_SLANT_MAX_RAD * (2.0 * slant - 1.0))
        wavelength_m = math.sqrt(float(short_m * long_m))
        waves.append((math.sqrt(2.0 * variance_m2), wavelength_m, across, 2.0 * math.pi * phase))
    return waves
