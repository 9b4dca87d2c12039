"""The score of a run: a pure function of ground truth, by the tiers of the landing benchmark.

S0, the report's success, is a 3-D distance of the drone to the vehicle's centre of at most 0.7 m. With the report's pad
on the road that is the distance to the pad's centre, so over a roof the pad's centre is taken as well. It is reported
for every run, but it is a tier only under `report_rule`: on a roof it would call a crash beside the pad a success.
A landing with contact on the pad but outside the limits of S1 is unsafe, and so is a drone that never took off.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import Enum

import numpy as np

from link.messages import BodyTruth, RotorTruth
from scenarios.scoring.flight_faults import Fault, flight_faults, flight_of
from scenarios.scoring.margin import margin_of, margin_terms
from scenarios.scoring.touch import touches
from scenarios.scoring.touchdown import S1_LIMITS, S2_LIMITS, Landing, ScoreRules, Touchdown, find_exceeded, landing_of
from scenarios.scoring.truth_log import TruthLog, truth_log

_S0_DISTANCE_M = 0.7
_PASSED_M = 1.0  # farther than its closest approach by this, the vehicle has passed
_PASSING_M = 15.0  # a closest approach farther away than this is none


class Tier(Enum):
    """What a run reached, best first."""

    S3 = "S3"
    S2 = "S2"
    S1 = "S1"
    S0 = "S0"
    ABORT = "abort"
    UNSAFE = "unsafe"


@dataclass(frozen=True, slots=True, kw_only=True)
class Score:
    """What a run is worth; None where there was no contact, no start or no such event."""

    tier: Tier
    reason: str
    margin: float  # negative when unsafe; scenarios.scoring.margin defines it
    touchdown: Touchdown | None
    start_t_ns: int
    time_to_contact_s: float | None
    time_to_s0_s: float | None
    closest_m: float
    slid_m: float | None
    motors_off_s: float | None

    @property
    def s2_quality(self) -> bool:
        """Whether it landed, secured or not, with a contact within the limits of S2."""
        landed = self.tier in {Tier.S1, Tier.S2, Tier.S3}
        return landed and self.touchdown is not None and not find_exceeded(self.touchdown, S2_LIMITS)

    def to_json(self) -> dict[str, float | int | str | bool | None]:
        """Return the score as one flat table."""
        empty = dict.fromkeys(Touchdown.__dataclass_fields__)
        own = {
            "tier": self.tier.value,
            "reason": self.reason,
            "margin": self.margin,
            "s2_quality": self.s2_quality,
            "start_t_ns": self.start_t_ns,
            "time_to_contact_s": self.time_to_contact_s,
            "time_to_s0_s": self.time_to_s0_s,
            "closest_m": self.closest_m,
            "slid_m": self.slid_m,
            "motors_off_s": self.motors_off_s,
        }
        return own | (empty if self.touchdown is None else asdict(self.touchdown))


def score(
    drone: Sequence[BodyTruth],
    vehicle: Sequence[BodyTruth],
    rotors: Sequence[RotorTruth],
    rules: ScoreRules,
    *,
    started_ns: int | None = None,
    faults: Sequence[str] = (),
) -> Score:
    """Return the score of a run.

    Args:
        drone: its truth in order of time, 100 Hz.
        vehicle: its truth in order of time, 100 Hz.
        rotors: their truth in order of time, 100 Hz; empty when unknown, and then S3 cannot be reached.
        rules: geometry, airframe and the rest.
        started_ns: start of the manoeuvre; None is the vehicle's closest approach to the waiting point.
        faults: what made the run unsafe and cannot be seen in truth, such as fighting the pilot.

    Raises:
        ValueError: too few samples, or out of order.
    """
    return score_log(truth_log(drone, vehicle, rotors), rules, started_ns=started_ns, faults=faults)


def score_log(log: TruthLog, rules: ScoreRules, *, started_ns: int | None = None, faults: Sequence[str] = ()) -> Score:
    """Return the score of a run by its truth; the arguments are those of `score`."""
    touched = touches(log, rules.box)
    start_ns = _passing_ns(log, rules) if started_ns is None else started_ns
    flight = flight_of(log, touched, rules.box)
    landing = None if flight.first is None else landing_of(log, flight.first, rules)
    found = flight_faults(log, touched, flight, outside=rules.outward_m(log) > rules.fence_radius_m)
    if landing is not None and not rules.carries:
        found = [fault for fault in found if fault[0] <= landing.touchdown.contact_t_ns]
    if landing is not None and landing.touchdown.on_pad:
        found += _excesses(landing.touchdown)
    distance_m = np.linalg.norm(log.position_v_m - np.array([0.0, 0.0, rules.box.roof_height_m]), axis=1)
    started = log.t_ns >= start_ns
    reached_ns = log.t_ns[(distance_m <= _S0_DISTANCE_M) & started]
    s0_ns = int(reached_ns[0]) if len(reached_ns) else None
    tier, reason = _tier(landing, found, faults, s0_ns if rules.report_rule else None)
    closest_m = float(distance_m[started].min() if started.any() else distance_m[-1])
    if tier is Tier.S0:
        terms = {"S0": 1.0 - closest_m / _S0_DISTANCE_M}
    else:
        terms = margin_terms(log, touched, flight, landing, rules)
    return Score(
        tier=tier,
        reason=reason,
        margin=margin_of(terms, unsafe=tier is Tier.UNSAFE, reported=bool(faults)),
        touchdown=None if landing is None else landing.touchdown,
        start_t_ns=start_ns,
        time_to_contact_s=None if landing is None else (landing.touchdown.contact_t_ns - start_ns) * 1e-9,
        time_to_s0_s=None if s0_ns is None else (s0_ns - start_ns) * 1e-9,
        closest_m=closest_m,
        slid_m=None if landing is None else landing.slid_m,
        motors_off_s=None if landing is None else landing.motors_off_s,
    )


def _tier(
    landing: Landing | None, found: Sequence[Fault], reported: Sequence[str], s0_ns: int | None
) -> tuple[Tier, str]:
    """Return the tier and why; `s0_ns` is None where S0 is no tier."""
    if not reported and s0_ns is not None and (landing is None or found) and all(s0_ns <= at for at, _ in found):
        return Tier.S0, "came within 0.7 m of the vehicle's centre"
    if reported or found:
        return Tier.UNSAFE, reported[0] if reported else min(found)[1]
    if landing is None:
        return Tier.ABORT, "no touchdown; it ends airborne, stable and clear of the vehicle"
    if landing.secured:
        return Tier.S3, "landed, motors off in time and at rest on the pad"
    if not find_exceeded(landing.touchdown, S2_LIMITS):
        return Tier.S2, "landed precisely, not secured"
    return Tier.S1, "landed, not secured"


def _excesses(touchdown: Touchdown) -> list[Fault]:
    """Return the fault of a contact on the pad beyond the limits of S1, if it is one."""
    beyond = find_exceeded(touchdown, S1_LIMITS)
    return [(touchdown.contact_t_ns, f"contact on the pad beyond the limits: {', '.join(beyond)}")] if beyond else []


def _passing_ns(log: TruthLog, rules: ScoreRules) -> int:
    """Return the last instant of the vehicle's first closest approach to the waiting point."""
    aside_m = np.linalg.norm(log.vehicle_position_enu_m[:, :2] - np.array(rules.waiting_point_enu_m[:2]), axis=1)
    nearest_m = np.minimum.accumulate(aside_m)
    passed = np.flatnonzero((aside_m > nearest_m + _PASSED_M) & (nearest_m < _PASSING_M))
    until = int(passed[0]) if len(passed) else len(aside_m)
    return int(log.t_ns[np.flatnonzero(aside_m[:until] <= aside_m[:until].min() + 1e-9)[-1]])
