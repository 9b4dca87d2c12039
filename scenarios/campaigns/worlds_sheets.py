"""The report about worlds as sheets of text, which a terminal, Markdown and the page show alike."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from scenarios.campaigns.causes import NOTHING
from scenarios.campaigns.cells import WORLD_COLUMN
from scenarios.campaigns.sheets import Sheet
from scenarios.recordings.reason_counts import counts_text

_WORLDS_SHOWN = 3
_NAMES = {
    "world.drive.cruise_m_s": ("cruising speed", "m/s", 1),
    "vehicle_speed_m_s": ("speed at contact", "m/s", 1),
    "world.drive.curvature_max_per_m": ("sharpest curvature of the drive", "1/m", 3),
    "vehicle_curvature_per_m": ("curvature at contact", "1/m", 4),
    "data_age_s": ("age of the data", "s", 2),
    "wind_mean_m_s": ("mean wind", "m/s", 1),
    "pad_side_m": ("pad", "m", 2),
}
"""Of each quantity: name, unit, digits."""

Rates = Mapping[str, Any]


def worlds_sheets(report: Mapping[str, Any]) -> list[Sheet]:
    """Return the sheets of one slice's report; what has nothing to show is left out."""
    tiers = _reached(report)
    sheets = [_overall(report, tiers)]
    sheets += [
        _groups_sheet(f"{report['worlds']} by {_plain(name)}", found, tiers) for name, found in report["by"].items()
    ]
    sheets += [_bins_sheet(report["worlds"], name, bins, tiers) for name, bins in report["over"].items()]
    sheets += [
        _failures("Unsafe", report["causes"]["unsafe"]),
        _contrasts("unsafe", report["contrasts"]["unsafe"]),
        _failures("Given up", report["causes"]["given_up"]),
        _contrasts("given up", report["contrasts"]["given_up"]),
        _before(report["causes"]["before"]),
        _worst(report["worst"], configured=report["configured"]),
    ]
    return [sheet for sheet in sheets if sheet.rows]


def heading_of(quantity: str) -> str:
    """Return what a quantity is called, with its unit."""
    what, unit, _ = _NAMES[quantity]
    return f"{what} [{unit}]"


def _reached(report: Mapping[str, Any]) -> list[str]:
    """Return the tiers that any landing reached."""
    return [tier for tier, rate in report["overall"]["tiers"].items() if rate["count"]]


def _overall(report: Mapping[str, Any], tiers: Sequence[str]) -> Sheet:
    rows = [("all", report["overall"]), *(report["by_firmware"].items() if len(report["by_firmware"]) > 1 else ())]
    title = f"{report['worlds']}: tiers in % (95 % intervals)"
    pairs = report["pairs"]
    if pairs is not None:
        title += "; " + ", ".join(
            _pair_text(name.replace("_", " "), pairs[name]) for name in ("s1_or_better", "unsafe")
        )
    return _rates_sheet(title, "firmware", rows, tiers)


def _pair_text(name: str, found: Mapping[str, Any]) -> str:
    only = ", ".join(f"{key.removeprefix('only_')} {count}" for key, count in found.items() if key != "p")
    return f"{name} with only one of a world's firmwares: {only} (p={found['p']:.2g})"


def _groups_sheet(title: str, groups: Mapping[str, Rates], tiers: Sequence[str]) -> Sheet:
    return _rates_sheet(title, title.rpartition(" ")[2], groups.items(), tiers)


def _bins_sheet(worlds: str, name: str, bins: Sequence[Rates], tiers: Sequence[str]) -> Sheet:
    what, _, digits = _NAMES[name]
    rows = [(f"{one['low']:.{digits}f} to {one['high']:.{digits}f}", one) for one in bins]
    return _rates_sheet(f"{worlds} over {what}", heading_of(name), rows, tiers)


def _rates_sheet(title: str, heading: str, rows: Iterable[tuple[str, Rates]], tiers: Sequence[str]) -> Sheet:
    texts = tuple(
        (name, str(found["landings"]), str(found["errors"]), *(_share(found["tiers"][tier]) for tier in tiers))
        for name, found in rows
    )
    return Sheet(title=title, head=(heading, "landings", "errors", *tiers), rows=texts)


def _failures(title: str, groups: Sequence[Mapping[str, Any]]) -> Sheet:
    rows = tuple(
        (one["outcome"], counts_text(one["before"]), _some(one["worlds"]), str(one["count"])) for one in groups
    )
    head = ("what the truth shows", "in the 3 s before", "worlds", "landings")
    return Sheet(title=f"{title}, by what the truth shows", head=head, rows=rows, texts=3)


def _some(worlds: Sequence[str]) -> str:
    more = "" if len(worlds) <= _WORLDS_SHOWN else f" and {len(worlds) - _WORLDS_SHOWN} more"
    return ", ".join(worlds[:_WORLDS_SHOWN]) + more


def _before(events: Sequence[Mapping[str, Any]]) -> Sheet:
    parts = ("unsafe", "given_up", "landed")
    rows = tuple((one["event"], *(_count(one[part]) for part in parts)) for one in events)
    title = "In the 3 s before, in % of the landings (95 % intervals)"
    return Sheet(title=title, head=("event", *(part.replace("_", " ") for part in parts)), rows=rows)


def _contrasts(failed: str, found: Sequence[Mapping[str, Any]]) -> Sheet:
    rows = tuple(
        (
            _plain(one["column"]),
            f"{one['failed']:.4g}",
            f"{one['landed']:.4g}",
            f"{100.0 * one['above']:.0f}",
            f"{one['p']:.2g}",
        )
        for one in found
    )
    title = f"What the worlds that were {failed} drew otherwise than those that landed (Mann and Whitney, Holm's p)"
    return Sheet(
        title=title, head=("drawn", f"median, {failed}", "median, landed", "larger in % of pairs", "p"), rows=rows
    )


def _worst(worst: Sequence[Mapping[str, Any]], *, configured: bool) -> Sheet:
    rows = tuple(
        (
            one["command"],
            one["firmware"],
            one["tier"],
            one["outcome"],
            ", ".join(one["before"]) or NOTHING,
            "" if one["margin"] is None else f"{one['margin']:.3f}",
        )
        for one in worst
    )
    title = "The worst, least margin first" + ("; without the campaign's --config" if configured else "")
    head = ("replay", "firmware", "tier", "what the truth shows", "in the 3 s before", "margin")
    return Sheet(title=title, head=head, rows=rows, texts=5)


def _share(rate: Mapping[str, float]) -> str:
    return f"{100.0 * rate['share']:.1f} ({100.0 * rate['low']:.1f} to {100.0 * rate['high']:.1f})"


def _count(found: Mapping[str, float] | None) -> str:
    return "" if found is None else f"{found['count']}/{found['of']}: {_share(found)}"


def _plain(column: str) -> str:
    return column.removeprefix(WORLD_COLUMN)
