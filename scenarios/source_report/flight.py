"""A flight of one of the report's scenarios, on the report's own timeline and by its own rule of success.

A landing is a distance of at most 0.7 m, between the start of the drive and the end of the road, on truth; and, as the
report's simulation tests it, from one noisy measurement of the vehicle, 100 times a second.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from companion.config.planning import LandingStyle
from link.errors import UserError
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.recording import EndWatch
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Score
from scenarios.scoring.touch import Flags
from scenarios.scoring.truth_log import Array
from scenarios.simulation.noise import named_rng
from scenarios.simulation.sensors import white_error_m
from scenarios.source_report.cases import LANDED_M, STANDS_S, Place
from scenarios.tracks.config import WaypointsTrack
from scenarios.tracks.course import Course


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportTask:
    """A scenario of the report, the preset of the system that flies it, and a seed."""

    scenario: str
    system: str
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReportFlight:
    """The truth of a flight at 100 Hz.

    Attributes:
        t_s: (n,) on the report's timeline, in which the vehicle departs at 5 s.
        drone_m: (n, 3) in W.
        vehicle_m: (n, 3) of its centre, in W.
        noise_m: (n, 3) error of a measurement of the vehicle's position at each instant.
        road_end_s: when the vehicle passes its last waypoint.
        score: of a flight flown to its end, None of one that is broken off at the end of the road.
    """

    t_s: Array
    drone_m: Array
    vehicle_m: Array
    noise_m: Array
    road_end_s: float
    score: Score | None

    @property
    def counts(self) -> Flags:
        """(n,) whether a landing counts at each instant."""
        return np.asarray((self.t_s >= STANDS_S) & (self.t_s <= self.road_end_s))

    def distance_m(self, *, noisy: bool) -> Array:
        """Return the drone's distance (n,) from the vehicle's centre, or from where it was measured."""
        vehicle = self.vehicle_m + self.noise_m if noisy else self.vehicle_m
        return np.asarray(np.linalg.norm(self.drone_m - vehicle, axis=1))

    def landing(self, *, noisy: bool) -> Place | None:
        """Return when and where the drone first counts as landed; the place is the vehicle's, as in the report."""
        reached = np.flatnonzero(self.counts & (self.distance_m(noisy=noisy) <= LANDED_M))
        if not len(reached):
            return None
        k = int(reached[0])
        x_m, y_m = self.vehicle_m[k, :2].tolist()
        return Place(t_s=float(self.t_s[k]), x_m=x_m, y_m=y_m)


def fly(task: ReportTask) -> ReportFlight:
    """Fly `task` in lockstep: to the end of the road where the system has no end of its own, else to its end.

    Raises:
        UserError: no such scenario or preset, or not one of waypoints.
    """
    scenario = load_scenario(f"{task.scenario}+system={task.system}")
    if not isinstance(scenario.track, WaypointsTrack):
        raise UserError(f"{task.scenario} does not drive along waypoints, as the report's scenarios do")
    lockstep, watch = Lockstep(scenario, task.seed), EndWatch(scenario.run.time_limit_s)
    drive_s = _drive_s(lockstep.simulation.vehicle.plan.course)
    direct = scenario.system.companion.guidance.style is LandingStyle.DIRECT
    while watch.reason(lockstep.recording) is None:
        lockstep.step()
        departs_ns = lockstep.simulation.vehicle.memory.departs_ns
        if direct and departs_ns is not None and lockstep.simulation.t_ns > departs_ns + drive_s * 1e9:
            break
    return _flight(lockstep, scenario, task.seed, drive_s, scored_too=not direct)


def _drive_s(course: Course) -> float:
    """Return how long the vehicle drives to its last waypoint: until its braking, after which it stands."""
    return course.profile.starts_s[-2]


def _flight(lockstep: Lockstep, scenario: Scenario, seed: int, drive_s: float, *, scored_too: bool) -> ReportFlight:
    recording = lockstep.recording
    departs_ns = lockstep.simulation.vehicle.memory.departs_ns
    # a drone that never came to its waiting point saw no departure: nothing of such a flight counts
    start_ns = recording.drone[-1].t_ns if departs_ns is None else departs_ns
    rng, fix = named_rng(seed, "report test"), scenario.sensors.fix
    return ReportFlight(
        t_s=np.array([(truth.t_ns - start_ns) * 1e-9 for truth in recording.drone]) + STANDS_S,
        drone_m=np.array([truth.position_enu_m for truth in recording.drone]),
        vehicle_m=np.array([truth.position_enu_m for truth in recording.vehicle]),
        noise_m=np.array([white_error_m(fix, rng) for _ in recording.drone]),
        road_end_s=STANDS_S + drive_s,
        score=score_run(scenario, seed, recording) if scored_too else None,
    )


def row_of(task: ReportTask, flight: ReportFlight) -> dict[str, Any]:
    """Return what came of a flight as plain values; None is no landing."""
    noisy, truth = flight.landing(noisy=True), flight.landing(noisy=False)
    distance_m = flight.distance_m(noisy=False)[flight.counts]
    return {
        "scenario": task.scenario,
        "system": task.system,
        "seed": task.seed,
        "noisy": None if noisy is None else noisy.model_dump(),
        "truth": None if truth is None else truth.model_dump(),
        "closest_m": float(distance_m.min()) if len(distance_m) else None,
        "road_end_s": flight.road_end_s,
        "score": None if flight.score is None else flight.score.to_json(),
    }


def fly_row(task: ReportTask) -> dict[str, Any]:
    """Return the row of `task`, flown; a job for the pool."""
    return row_of(task, fly(task))
