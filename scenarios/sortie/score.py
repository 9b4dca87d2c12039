"""What a sortie was worth, on truth: contacts after the lift-off, its stations' errors, and the tier of its landing.

The station's error is the distance of the drone's feet from the station that the companion says it keeps, relative to
the vehicle as it truly is, from `SETTLING_S` after each order on. It is told apart for straight roads and bends. How
far such a station is from the one that was ordered, and how many were refused, stands beside it.
"""

import math
from bisect import bisect_right
from dataclasses import asdict, dataclass

import numpy as np

from link.frames.rotations import yaw_of
from link.messages import BodyTruth, StationFrame, Vector3
from scenarios.scoring.score import Tier, score_log
from scenarios.scoring.touchdown import rules_of
from scenarios.scoring.truth_log import truth_log
from scenarios.simulation.drone import mean_wind_enu_m_s
from scenarios.sortie.flight import HELD_S, SortieFlight
from sim_autopilot.physics.contact import GEAR_HEIGHT_M

SETTLING_S = 12.0
"""For the way to a new station: 10 m at the 1.5 m/s by which ArduPilot's carried setpoints are faster than 10 m/s."""
_BEND_RAD_S = 0.03  # of yaw rate: 10 m/s on a radius of 330 m


@dataclass(frozen=True, slots=True, kw_only=True)
class SortieScore:
    """One sortie.

    Attributes:
        ended: the phase that it ended in.
        reason: what the companion said last.
        contacts: samples of 10 ms with a contact between lift-off and descent.
        error_straight_m: of the station, RMS; None without such a time.
        error_bend_m: likewise.
        error_max_m: the largest, of both.
        moved_m: the farthest that a station was kept from where it was ordered; None where none was kept.
        refused: stations.
        tier: of the landing.
        tier_reason: why.
        lift_off_s: from the launch's order until the drone last leaves the deck.
        return_s: from the order to come home to the contact.
        return_from_m: how far away the vehicle was then.
    """

    ended: str
    reason: str
    contacts: int
    error_straight_m: float | None
    error_bend_m: float | None
    error_max_m: float | None
    moved_m: float | None
    refused: int
    tier: Tier
    tier_reason: str
    lift_off_s: float | None
    return_s: float | None
    return_from_m: float | None

    def to_json(self) -> dict[str, object]:
        """Return the score as a table of plain values, rounded to what is known."""
        table = asdict(self) | {"tier": self.tier.value}
        return {name: round(value, 4) if isinstance(value, float) else value for name, value in table.items()}


def score_sortie(flight: SortieFlight, ended: str) -> SortieScore:
    """Return the score of a sortie that is over."""
    straight, bend, moved = _station_errors_m(flight)
    called_ns, status = flight.times_ns.get("return"), flight.recording.status
    tier, why, contact_ns = _landing(flight, called_ns)
    launched_ns, lifted_ns = flight.times_ns.get("launch"), flight.times_ns.get("lifted")
    return SortieScore(
        ended=ended,
        reason="" if status is None else status.reason,
        contacts=len(flight.contacts_ns),
        error_straight_m=_rms(straight),
        error_bend_m=_rms(bend),
        error_max_m=max([*straight, *bend], default=None),
        moved_m=max(moved, default=None),
        refused=len(flight.refused),
        tier=tier,
        tier_reason=why,
        lift_off_s=None if launched_ns is None or lifted_ns is None else (lifted_ns - launched_ns) * 1e-9,
        return_s=None if called_ns is None or contact_ns is None else (contact_ns - called_ns) * 1e-9,
        return_from_m=flight.return_from_m,
    )


def _landing(flight: SortieFlight, called_ns: int | None) -> tuple[Tier, str, int | None]:
    """Return the tier of the landing, why, and when the contact was; without a way home of the whole flight."""
    recording = flight.recording
    from_ns = flight.times_ns.get("lifted", 0) if called_ns is None else called_ns
    drone = [one for one in recording.drone if one.t_ns >= from_ns]
    log = truth_log(drone, recording.vehicle, recording.rotors)
    scenario = flight.scenario
    rules = rules_of(scenario, wind_mean_enu_m_s=mean_wind_enu_m_s(scenario, flight.seed))
    scored = score_log(log, rules, started_ns=from_ns)
    return scored.tier, scored.reason, None if scored.touchdown is None else scored.touchdown.contact_t_ns


def _station_errors_m(flight: SortieFlight) -> tuple[list[float], list[float], list[float]]:
    """Return the distances from the stations on straight roads and in bends, and how far these are from the ordered."""
    held_ns, settling_ns = round(HELD_S * 1e9), round(SETTLING_S * 1e9)
    roof_m = flight.scenario.vehicle.roof_height_m
    until_ns = flight.times_ns.get("hold", 0)
    straight: list[float] = []
    bend: list[float] = []
    moved: list[float] = []
    statuses = flight.recording.statuses
    told_ns = [status.stamp_ns for status in statuses]
    for ordered_ns, station in flight.orders:
        if ordered_ns in flight.refused:
            continue
        end_ns = min(ordered_ns + held_ns, until_ns)
        for drone, vehicle in zip(flight.recording.drone, flight.recording.vehicle, strict=False):
            if drone.t_ns != vehicle.t_ns:
                raise ValueError(f"truths of {drone.t_ns} and {vehicle.t_ns} are no pair")
            if ordered_ns + settling_ns <= drone.t_ns < end_ns:
                kept_m = statuses[bisect_right(told_ns, drone.t_ns) - 1].station_offset_m
                if kept_m is None:  # it climbs away
                    kept_m = station.offset_m
                turns = abs(vehicle.angular_velocity_flu_rad_s[2]) > _BEND_RAD_S
                (bend if turns else straight).append(_error_m(drone, vehicle, station.frame, kept_m, roof_m))
                moved.append(math.dist(kept_m, station.offset_m))
    return straight, bend, moved


def _error_m(drone: BodyTruth, vehicle: BodyTruth, frame: StationFrame, kept_m: Vector3, roof_height_m: float) -> float:
    ahead = 0.5 * math.pi if frame is StationFrame.NORTH else yaw_of(vehicle.orientation_wxyz)
    x, y, up_m = kept_m
    c, s = math.cos(ahead), math.sin(ahead)
    wanted = np.array([c * x - s * y, s * x + c * y, up_m + roof_height_m + GEAR_HEIGHT_M])
    offset = np.array(drone.position_enu_m) - np.array(vehicle.position_enu_m)
    return float(np.linalg.norm(offset - wanted))


def _rms(errors_m: list[float]) -> float | None:
    return math.sqrt(sum(one * one for one in errors_m) / len(errors_m)) if errors_m else None
