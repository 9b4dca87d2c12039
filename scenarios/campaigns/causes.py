"""What the truth shows of landings that failed: how they failed, and what happened in the seconds before.

Nothing here is what the companion says of itself. The limits say from when on an event counts as one; the columns have
its size, and the tables show how often the landings that went well had it too.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.summary import is_given_up, is_s1_or_better, is_unsafe, share_json
from scenarios.recordings.reason_counts import counts_of
from scenarios.scoring.touchdown import S1_LIMITS

NOTHING = "nothing of these"

_MEASURES = {
    "horizontal_error_m": "horizontal error",
    "relative_speed_m_s": "relative speed",
    "sink_rate_m_s": "sink rate",
    "tilt_over_trim_rad": "tilt over trim",
}
_SLID_M = 0.3  # more than a landing that is secured may, scenarios.scoring.touchdown
_AT_PAD_M, _ABOVE_PAD_M = 1.0, 5.0  # from its centre: lower than where the drone waits; as high as where it begins

_COMFORTABLE_M_S2 = 1.67  # of braking; Treiber, Hennecke and Helbing, Phys. Rev. E 62 (2000) 1805, table I
_LANE_CHANGE_M_S2 = 1.0  # to the side, the most that a lane change by automatic steering may take; UN R79, 5.6.4.6
_RISE_M_S = 0.3  # what lies between the sink rates of S2 and S1


@dataclass(frozen=True, slots=True, kw_only=True)
class _Event:
    """What may have happened before the instant: its name, and whether a row shows it; None where it is not known."""

    name: str
    shown: Callable[[Row], bool | None]


def _above(column: str, limit: float) -> Callable[[Row], bool | None]:
    return lambda row: None if row.get(column) is None else bool(row[column] > limit)


_EVENTS = (
    _Event(name="brake", shown=_above("before_brake_m_s2", _COMFORTABLE_M_S2)),
    _Event(name="departure", shown=lambda row: row.get("before_departs")),
    _Event(name="turn-in", shown=_above("before_lateral_m_s2", _LANE_CHANGE_M_S2)),
    _Event(name="climb, crest or bump", shown=_above("before_rise_m_s", _RISE_M_S)),
    _Event(name="gust", shown=_above("before_gust_m_s", 0.0)),
    _Event(name="silent link", shown=_above("before_silence_s", 0.0)),
)


def events_before(row: Row) -> list[str]:
    """Return what happened in the seconds before the contact, or before the drone was closest to the pad."""
    return [event.name for event in _EVENTS if event.shown(row)]


def outcome(row: Row) -> str:
    """Return how a landing that reached no tier of landings failed, by truth."""
    if is_given_up(row):
        return _given_up(row["closest_m"])
    if not row.get("on_pad"):
        return str(row["reason"])
    beyond = [name for measure, name in _MEASURES.items() if row[measure] > getattr(S1_LIMITS, measure)]
    slid = ", slid" if (row.get("slid_m") or 0.0) > _SLID_M else ""
    if beyond:
        return f"on the pad beyond S1: {', '.join(beyond)}{slid}"
    return f"after contact on the pad{slid}: {row['reason']}"


def _given_up(closest_m: float) -> str:
    if closest_m <= _AT_PAD_M:
        return f"given up within {_AT_PAD_M:g} m of the pad"
    if closest_m <= _ABOVE_PAD_M:
        return f"given up within {_ABOVE_PAD_M:g} m of the pad"
    return f"never within {_ABOVE_PAD_M:g} m of the pad"


def causes(rows: Sequence[Row], name_of: Callable[[Row], str]) -> dict[str, Any]:
    """Return what the truth shows of the unsafe landings and of those that were given up.

    Args:
        rows: all landings.
        name_of: by which the world of one is loaded.
    """
    unsafe = [row for row in rows if is_unsafe(row)]
    given_up = [row for row in rows if is_given_up(row)]
    landed = [row for row in rows if is_s1_or_better(row)]
    return {
        "unsafe": _groups(unsafe, name_of),
        "given_up": _groups(given_up, name_of),
        "before": [
            {"event": event.name} | {name: _shown(event, some) for name, some in _named(unsafe, given_up, landed)}
            for event in _EVENTS
        ],
    }


def _named(*parts: Sequence[Row]) -> list[tuple[str, Sequence[Row]]]:
    return list(zip(("unsafe", "given_up", "landed"), parts, strict=True))


def _groups(rows: Sequence[Row], name_of: Callable[[Row], str]) -> list[dict[str, Any]]:
    """Return failed landings by how they failed, the most frequent first, with how often each event was before."""
    groups: dict[str, list[Row]] = {}
    for row in sorted(rows, key=lambda row: (row["seed"], row["cell"])):
        groups.setdefault(outcome(row), []).append(row)
    return [
        {
            "outcome": how,
            "count": len(alike),
            "before": counts_of(event for row in alike for event in events_before(row) or [NOTHING]),
            "worlds": [name_of(row) for row in alike],
        }
        for how, alike in sorted(groups.items(), key=lambda group: (-len(group[1]), group[0]))
    ]


def _shown(event: _Event, rows: Sequence[Row]) -> dict[str, Any] | None:
    """Return in how many of some landings an event happened, None where it is known of none."""
    known = [shown for row in rows if (shown := event.shown(row)) is not None]
    return {"count": sum(known), "of": len(known), **share_json(sum(known), len(known))} if known else None
