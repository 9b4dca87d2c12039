"""What sums up a world's road and drive in single numbers, for the rows of a campaign."""

import numpy as np

from scenarios.config import Scenario
from scenarios.tracks.drive import drive_course, driven
from scenarios.tracks.drive_config import DriveTrack
from scenarios.worlds.distributions import Value
from scenarios.worlds.driver import DrivePlan
from scenarios.worlds.road import RoadPlan


def summary_of(scenario: Scenario, road: RoadPlan, drive: DrivePlan, cruise_m_s: float) -> dict[str, Value | int]:
    """Return the numbers by name; accelerations and speeds are of the whole drive."""
    track = scenario.track
    if not isinstance(track, DriveTrack):
        raise TypeError(f"a world drives, and does not follow a track of kind '{track.kind}'")
    course = drive_course(track)
    motion = driven(course.road, course.profile)
    moving, end_m = motion.speed_m_s > 0.0, float(motion.s_m[-1])
    curvature_per_m = np.abs(motion.left_m_s2[moving]) / motion.speed_m_s[moving] ** 2
    fix, zenoh = scenario.sensors.fix, scenario.link.zenoh
    sway = course.sway
    return {
        "drive.cruise_m_s": cruise_m_s,
        "drive.speed_max_m_s": float(motion.speed_m_s.max()),
        "drive.curvature_max_per_m": float(curvature_per_m.max()),
        "drive.lateral_max_m_s2": float(np.abs(motion.left_m_s2).max()),
        "drive.brake_max_m_s2": float(-motion.along_m_s2.min()),
        "drive.acceleration_max_m_s2": float(np.hypot(motion.along_m_s2, motion.left_m_s2).max()),
        "drive.grade_max": max(abs(grade) for _, grade in road.grades),
        "drive.heave_max_m": 0.0 if sway is None else float(np.abs(sway.heave[0]).max()),
        "drive.pitch_max_rad": 0.0 if sway is None else float(np.abs(sway.pitch[0]).max()),
        "drive.roll_max_rad": 0.0 if sway is None else float(np.abs(sway.roll[0]).max()),
        "drive.passes_s": drive.passes_s,
        "drive.first_event_s": 1e3 if drive.first_event_s is None else drive.first_event_s,
        "drive.bends": sum(one.speed_m_s < cruise_m_s and one.from_m < end_m for one in road.limits),
        "drive.humps": sum(place_m < end_m for place_m, _, _ in road.humps),
        **{f"drive.{kind}s": count for kind, count in drive.counts.items()},
        "sensors.data_age_s": fix.delay_s + zenoh.delay_s + 0.5 / fix.rate_hz,
    }
