"""What a sortie was worth, on truth: contacts after the lift-off, its stations' errors, and the tier of its landing.

The station's error is the distance of the drone's feet from the station that the companion says it keeps, relative to
the vehicle as it truly is, from `SETTLING_S` after each order on. It is told apart for straight roads and bends. How
far such a station is from the one that was ordered, and how many were refused, stands beside it.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from link.frames.rotations import yaw_of
from link.messages import BodyTruth, StationFrame, Vector3
from link.records import replace
from scenarios.recordings.recording import Recording
from scenarios.scoring.score import Tier, score_log
from scenarios.scoring.touchdown import ScoreRules
from scenarios.scoring.truth_log import truth_log
from scenarios.sortie.script import HELD_S, SortieOperator
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
        contacts: samples of 10 ms with a contact between lift-off and descent; None where nothing was flown.
        error_straight_m: of the station while the vehicle drove straight, RMS; None where it never did.
        error_bend_m: of the station while the vehicle turned, RMS; None where it never did.
        error_max_m: the largest, of both.
        error_by_station_m: RMS at each station in the order of the commands; None for one that was not kept.
        moved_m: the farthest that a station was kept from where it was ordered; None where none was kept.
        refused: stations.
        tier: of the landing.
        tier_reason: why.
        lift_off_s: from the launch's order until the drone last leaves the deck.
        return_s: from where the way home began to the contact.
        return_from_m: how far away the vehicle was then.
        comes_by_itself: the way home was not ordered.
    """

    ended: str
    reason: str
    contacts: int | None
    error_straight_m: float | None
    error_bend_m: float | None
    error_max_m: float | None
    error_by_station_m: tuple[float | None, ...]
    moved_m: float | None
    refused: int
    tier: Tier
    tier_reason: str
    lift_off_s: float | None
    return_s: float | None
    return_from_m: float | None
    comes_by_itself: bool

    def to_json(self) -> dict[str, object]:
        """Return the score as a table of plain values, rounded to what is known."""
        by_station_m = [None if one is None else round(one, 4) for one in self.error_by_station_m]
        table = asdict(self) | {"tier": self.tier.value, "error_by_station_m": by_station_m}
        return {name: round(value, 4) if isinstance(value, float) else value for name, value in table.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Error:
    """How far the drone is from its station, and that from where it was ordered; whether the vehicle turns."""

    station_m: float
    moved_m: float
    turns: bool


def score_sortie(recording: Recording, operator: SortieOperator, rules: ScoreRules, ended: str) -> SortieScore:
    """Return the score of a sortie that is over.

    Args:
        recording: of all of it.
        operator: who ordered it.
        rules: of its landing.
        ended: the phase that it ended in.
    """
    by_station = _station_errors(recording, operator, rules.box.roof_height_m)
    errors = [error for station in by_station for error in station]
    called_ns, status = operator.times_ns.get("return"), recording.status
    tier, why, contact_ns = _landing(recording, operator, rules)
    launched_ns, lifted_ns = operator.times_ns.get("launch"), operator.times_ns.get("lifted")
    return SortieScore(
        ended=ended,
        reason="" if status is None else status.reason,
        contacts=len(operator.contacts_ns),
        error_straight_m=_rms([one.station_m for one in errors if not one.turns]),
        error_bend_m=_rms([one.station_m for one in errors if one.turns]),
        error_max_m=max((one.station_m for one in errors), default=None),
        error_by_station_m=tuple(_rms([one.station_m for one in station]) for station in by_station),
        moved_m=max((one.moved_m for one in errors), default=None),
        refused=len(operator.refused),
        tier=tier,
        tier_reason=why,
        lift_off_s=None if launched_ns is None or lifted_ns is None else (lifted_ns - launched_ns) * 1e-9,
        return_s=None if called_ns is None or contact_ns is None else (contact_ns - called_ns) * 1e-9,
        return_from_m=operator.return_from_m,
        comes_by_itself=operator.comes_by_itself,
    )


def landing_from_ns(operator: SortieOperator) -> int:
    """Return from when on a sortie is scored as a landing: the way home; the lift-off where there was none."""
    return operator.times_ns.get("return", operator.times_ns.get("lifted", 0))


def _landing(recording: Recording, operator: SortieOperator, rules: ScoreRules) -> tuple[Tier, str, int | None]:
    """Return the tier of the landing, why, and when the contact was."""
    from_ns = landing_from_ns(operator)
    home = recording.since(from_ns)
    log = truth_log(home.drone, home.vehicle, home.rotors)
    scored = score_log(log, rules, started_ns=from_ns)
    return scored.tier, scored.reason, None if scored.touchdown is None else scored.touchdown.contact_t_ns


def _station_errors(recording: Recording, operator: SortieOperator, roof_m: float) -> list[list[_Error]]:
    """Return the errors at each station that was ordered, none at one that was refused."""
    held_ns, settling_ns = round(HELD_S * 1e9), round(SETTLING_S * 1e9)
    until_ns = operator.times_ns.get("hold", 0)
    told_ns = [status.stamp_ns for status in recording.statuses]
    pairs = _paired(recording.drone, recording.vehicle)
    by_station: list[list[_Error]] = []
    for ordered_ns, station in operator.orders:
        errors: list[_Error] = []
        by_station.append(errors)
        if ordered_ns in operator.refused:
            continue
        end_ns = min(ordered_ns + held_ns, until_ns)
        for drone, vehicle in pairs:
            if ordered_ns + settling_ns <= drone.t_ns < end_ns:
                kept_m = recording.statuses[bisect_right(told_ns, drone.t_ns) - 1].station_offset_m
                if kept_m is None:  # it climbs away
                    kept_m = station.offset_m
                errors.append(
                    _Error(
                        station_m=_error_m(drone, vehicle, station.frame, kept_m, roof_m),
                        moved_m=math.dist(kept_m, station.offset_m),
                        turns=abs(vehicle.angular_velocity_flu_rad_s[2]) > _BEND_RAD_S,
                    )
                )
    return by_station


def _paired(drone: Sequence[BodyTruth], vehicle: Sequence[BodyTruth]) -> list[tuple[BodyTruth, BodyTruth]]:
    """Return each sample of the drone from the vehicle's first to its last on, with the vehicle at the same time."""
    times_ns = [one.t_ns for one in vehicle]
    pairs = []
    for one in drone:
        after = bisect_right(times_ns, one.t_ns)
        if after and times_ns[after - 1] == one.t_ns:
            pairs.append((one, vehicle[after - 1]))
        elif 0 < after < len(vehicle):
            pairs.append((one, _between(vehicle[after - 1], vehicle[after], one.t_ns)))
    return pairs


def _between(before: BodyTruth, after: BodyTruth, t_ns: int) -> BodyTruth:
    """Return `before` moved evenly to where it is at `t_ns`; within 10 ms nothing turns."""
    share = (t_ns - before.t_ns) / (after.t_ns - before.t_ns)
    x, y, z = (a + share * (b - a) for a, b in zip(before.position_enu_m, after.position_enu_m, strict=True))
    return replace(before, t_ns=t_ns, position_enu_m=(x, y, z))


def _error_m(drone: BodyTruth, vehicle: BodyTruth, frame: StationFrame, kept_m: Vector3, roof_height_m: float) -> float:
    ahead = 0.5 * math.pi if frame is StationFrame.NORTH else yaw_of(vehicle.orientation_wxyz)
    x, y, up_m = kept_m
    c, s = math.cos(ahead), math.sin(ahead)
    wanted = np.array([c * x - s * y, s * x + c * y, up_m + roof_height_m + GEAR_HEIGHT_M])
    offset = np.array(drone.position_enu_m) - np.array(vehicle.position_enu_m)
    return float(np.linalg.norm(offset - wanted))


def _rms(errors_m: list[float]) -> float | None:
    return math.sqrt(sum(one * one for one in errors_m) / len(errors_m)) if errors_m else None
