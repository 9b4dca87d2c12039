"""The rows of a run's result as its page shows them: what, how much in which unit, and what the term means."""

import math
from collections.abc import Mapping
from typing import Any

from scenarios.campaigns.intervals import banded, mean_band
from scenarios.recordings.result import UNITS, ending_of
from scenarios.scoring.accuracy import NEES_DOF
from scenarios.scoring.touchdown import S1_LIMITS, S2_LIMITS, Limits

_DEGREES = 180.0 / math.pi
_MEANINGS = {
    "tier": "S3 secured on the pad, S2 and S1 by their limits, S0 the source report's rule, abort given up, unsafe",
    "margin": "from a limit of the score: 1 far inside, 0 at it, negative beyond",
    "s2_quality": "whether the contact is within the limits of S2",
    "horizontal_error_m": "from the pad's centre at contact",
    "contact_forward_m": "the contact, ahead of the pad's centre",
    "contact_left_m": "the contact, left of the pad's centre",
    "relative_speed_m_s": "horizontal, of drone against pad at contact",
    "sink_rate_m_s": "against the pad at contact",
    "tilt_rad": "of the drone against the deck at contact",
    "trim_rad": "the tilt that keeps its speed against the air",
    "tilt_over_trim_rad": "beyond that tilt",
    "time_to_contact_s": "from the vehicle's passing the waiting point",
    "pass_to_contact_s": "from the vehicle's passing the place where the drone waited",
    "time_to_s0_s": "until nearer than 0.7 m, the source report's success",
    "closest_m": "least distance from the drone to the vehicle's or the pad's centre",
    "slid_m": "on the pad after contact",
    "motors_off_s": "after contact",
    "on_pad": "whether all that touched first was on the pad",
    "position_rmse_m": "the estimate's error in the descent, root mean square",
    "velocity_rmse_m_s": "the same of its velocity",
    "vehicle_speed_m_s": "at the decisive instant: contact, else closest approach",
    "vehicle_curvature_per_m": "of its way at that instant",
    "before_brake_m_s2": "hardest braking in the 3 s before",
    "before_speed_up_m_s2": "hardest acceleration along its way in the 3 s before",
    "before_lateral_m_s2": "change of its acceleration to the side in the 3 s before",
    "before_rise_m_s": "change of its vertical speed in the 3 s before",
    "before_departs": "whether it stood in the 3 s before and drives now",
    "start_s": "when the landing began: the vehicle's closest approach to the waiting point",
    "contact_s": "when something first touched",
    "instant_s": "the decisive instant",
    "ended": "the companion's last phase, or what ended the run",
}
_ELSEWHERE = frozenset(
    {"phases_s", "reason", "approaches", "about", "scenario", "firmware", "seed", "ended_reason_code"}
)
_CONSISTENCY = frozenset({"nees_mean", "nees_count", "nis_sum", "nis_dof"})
Row = tuple[str, str, str]


def result_rows(result: Mapping[str, Any]) -> list[Row]:
    """Return name, value with unit, and meaning of all that a run's result tells; what it cannot know is left out."""
    shown = {key: value for key, value in result.items() if value is not None and key not in _ELSEWHERE | _CONSISTENCY}
    rows = [(_label(key), _value(key, value), _meaning(key)) for key, value in shown.items()]
    return [*rows, *_consistency(result)]


def _label(key: str) -> str:
    return key.removesuffix(ending_of(key)).replace("_", " ")


def _value(key: str, value: Any) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            unit = UNITS.get(ending_of(key), "")
            return f"{value * _DEGREES:.3f} degrees" if unit == "rad" else f"{value:.3f} {unit}".strip()
        case _:
            return str(value)


def _meaning(key: str) -> str:
    """Return what a term means, and the limits of the tiers where it has some."""
    if key not in Limits.__dataclass_fields__:
        return _MEANINGS.get(key, "")
    limits = ", ".join(
        f"{tier} {_value(key, float(getattr(limit, key)))}" for tier, limit in (("S2", S2_LIMITS), ("S1", S1_LIMITS))
    )
    return f"{_MEANINGS[key]}; at most: {limits}"


def _consistency(result: Mapping[str, Any]) -> list[Row]:
    """Return whether the estimate's errors are as large as it says; a run's errors are alike, and count once."""
    rows: list[Row] = []
    if result.get("nees_mean") is not None:
        low, high = mean_band(NEES_DOF)
        of = "squared error over its covariance, position and velocity"
        rows.append(("NEES", banded(result["nees_mean"], _times(low), _times(high)), f"{of}; {NEES_DOF} expected"))
    if result.get("nis_dof") and result.get("nis_sum") is not None:
        low, high = mean_band(result["nis_dof"])
        mean = result["nis_sum"] / result["nis_dof"]
        of = "squared innovations over their covariance, per degree of freedom"
        rows.append(("NIS", banded(mean, low, high), f"{of}; 1 expected"))
    return rows


def _times(bound: float | None) -> float | None:
    return None if bound is None else NEES_DOF * bound
