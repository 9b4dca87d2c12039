"""What the companion forecast of the contact at two instants of a run, and what came true, on truth.

An instant counts when the drone first, in one approach, is below a height: where a descent that goes on leaves the
height of waiting, and where it commits. It is the approach of the first contact, the one that truth judges, or the last
one where none came. A drone that touches, lifts off and lands again is judged by the touch that was forecast first.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from companion.config.descent import DescentConfig
from companion.situation.phases import Phase
from link.messages import ContactForecast, LandingStatus
from link.units import NS_PER_S
from scenarios.scoring.touchdown import S1_LIMITS, S2_LIMITS

WAITING, COMMIT = "waiting", "commit"
INSTANTS = (WAITING, COMMIT)
PROBABILITIES = ("s1", "s2", "unsafe", "broken_off")

_LEFT_M = 0.05  # below the height of waiting, where a drone that waits swings to and fro
_LATER_MAX_S = 1.0  # than forecast a contact may come; later it is one after a wait
_DIGITS = 6

Columns = dict[str, float | str | None]


def forecast_columns(
    statuses: Sequence[LandingStatus], start_ns: int, result: Mapping[str, Any], descent: DescentConfig
) -> Columns:
    """Return for both instants when they were, the forecast, and what came: `s2`, `s1`, `unsafe` or `broken_off`.

    Args:
        statuses: of the companion, in order of time.
        start_ns: of the run, UTC.
        result: with the measures of its first contact.
        descent: heights of waiting and of commitment.
    """
    contact_s = result.get("contact_s")
    contact_ns = None if contact_s is None else start_ns + round(contact_s * NS_PER_S)
    approach = _approach_to(statuses, contact_ns)
    heights_m = {WAITING: descent.wait.height_m - _LEFT_M, COMMIT: descent.commit_height_m}
    columns: Columns = {}
    for name, height_m in heights_m.items():
        columns |= _columns(name, _first_below(approach, height_m), start_ns, result)
    return columns


def _columns(name: str, status: LandingStatus | None, start_ns: int, result: Mapping[str, Any]) -> Columns:
    forecast = None if status is None else status.contact_forecast
    columns = [f"forecast_{name}_{one}" for one in ("at_s", *PROBABILITIES, "came")]
    if status is None or forecast is None:
        return dict.fromkeys(columns)
    at_s, contact_s = (status.stamp_ns - start_ns) / NS_PER_S, result.get("contact_s")
    if contact_s is not None and contact_s < at_s:  # it touched what is higher than the pad was taken to be
        return dict.fromkeys(columns)
    values = [at_s, *(getattr(forecast, one) for one in PROBABILITIES)]
    shown: list[float | str] = [round(value, _DIGITS) for value in values]
    shown.append(_came(at_s, forecast, result))
    return dict(zip(columns, shown, strict=True))


def _approach_to(statuses: Sequence[LandingStatus], contact_ns: int | None) -> Sequence[LandingStatus]:
    """Return the statuses of the last descent before the contact, or of the last one of all without a contact."""
    before = (one for one in enumerate(statuses) if contact_ns is None or one[1].stamp_ns <= contact_ns)
    last = max((at for at, status in before if status.phase == Phase.DESCEND.value), default=-1)
    first = last
    while first > 0 and statuses[first - 1].phase == Phase.DESCEND.value:
        first -= 1
    return statuses[first : last + 1] if last >= 0 else ()


def _first_below(statuses: Sequence[LandingStatus], height_m: float) -> LandingStatus | None:
    return next(
        (
            status
            for status in statuses
            if status.contact_forecast is not None
            and status.height_above_pad_m is not None
            and status.height_above_pad_m < height_m
        ),
        None,
    )


def _came(at_s: float, forecast: ContactForecast, result: Mapping[str, Any]) -> str:
    contact_s = result.get("contact_s")
    if contact_s is None or contact_s - at_s > (forecast.in_s or 0.0) + _LATER_MAX_S:
        return "broken_off"
    for name, limits in (("s2", S2_LIMITS), ("s1", S1_LIMITS)):
        within = all(result[measure] <= getattr(limits, measure) for measure in limits.__slots__)
        if result["on_pad"] and within:
            return name
    return "unsafe"
