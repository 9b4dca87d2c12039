"""Whether forecasts of contacts come true as often as they say: bins with their binomial band, score and ranks.

Sources: G. W. Brier, Mon. Weather Rev. 78 (1950) 1; J. Broecker and L. A. Smith, Weather and Forecasting 22 (2007) 651,
whose consistency bars the bands are: between what a bin's share lies with 95 % if its forecasts are right.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from scenarios.campaigns.intervals import rank_contrast
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.sheets import Sheet
from scenarios.recordings.contact_forecasts import INSTANTS

_BINS_MAX = 10
_IN_BIN_MIN = 20  # of fewer, a band is wider than 40 %
_LEVEL = 0.95
_DIGITS = 6

OUTCOMES: Mapping[str, tuple[str, Callable[[str], bool]]] = {
    "unsafe": ("unsafe contact", lambda came: came == "unsafe"),
    "s2": ("S2 or better", lambda came: came == "s2"),
    "broken_off": ("no contact", lambda came: came == "broken_off"),
}
"""By the forecast's name: what is said of it, and whether it came true."""


def reliability(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return for each instant and outcome how often it was forecast and came true; none without any forecast."""
    found = []
    for instant in INSTANTS:
        known = [row for row in rows if row.get(f"forecast_{instant}_came") is not None]
        for outcome, (what, is_true) in OUTCOMES.items():
            if known:
                said = np.array([float(row[f"forecast_{instant}_{outcome}"]) for row in known])
                came = np.array([is_true(row[f"forecast_{instant}_came"]) for row in known])
                found.append({"instant": instant, "outcome": what, **compare(said, came)})
    return found


def compare(said: np.ndarray[Any, Any], came: np.ndarray[Any, Any]) -> dict[str, Any]:
    """Return sums, Brier score, that of the plain rate, ranks and bins.

    Args:
        said: (n,) probabilities.
        came: (n,) whether it did.

    Returns:
        `ranks`, how often one that came true was forecast with more than one that did not (the area under the ROC
        curve), is None where all or none did.
    """
    both = came.any() and not came.all()
    rate = float(came.mean())
    return {
        "forecasts": len(said),
        "said": round(float(said.sum()), _DIGITS),
        "came": int(came.sum()),
        "brier": round(float(np.mean((said - came) ** 2)), _DIGITS),
        "brier_of_rate": round(rate * (1.0 - rate), _DIGITS),
        "ranks": round(rank_contrast(said[came].tolist(), said[~came].tolist())[0], _DIGITS) if both else None,
        "bins": _bins(said, came),
    }


def _bins(said: np.ndarray[Any, Any], came: np.ndarray[Any, Any]) -> list[dict[str, Any]]:
    """Return bins of as many forecasts each, by what they say, with the share that came true and its band."""
    order = np.argsort(said, kind="stable")
    count = max(1, min(_BINS_MAX, len(said) // _IN_BIN_MIN))
    bins = []
    for places in np.array_split(order, count):
        mean = float(said[places].mean())
        low, high = _band(said[places])
        bins.append(
            {
                "forecasts": len(places),
                "said": round(mean, _DIGITS),
                "came": round(float(came[places].mean()), _DIGITS),
                "low": round(low, _DIGITS),
                "high": round(high, _DIGITS),
            }
        )
    return bins


def _band(said: np.ndarray[Any, Any]) -> tuple[float, float]:
    """Return between which shares of these forecasts come true with 95 %: of the exact sum of unequal chances."""
    chances = np.ones(1)
    for probability in np.clip(said, 0.0, 1.0):
        chances = np.convolve(chances, [1.0 - probability, probability])
    summed = np.cumsum(chances)
    low, high = np.searchsorted(summed, [0.5 - 0.5 * _LEVEL, 0.5 + 0.5 * _LEVEL])
    return float(low) / len(said), float(min(high, len(said))) / len(said)


def reliability_sheets(found: Sequence[Mapping[str, Any]]) -> list[Sheet]:
    """Return the sheet of `reliability`, none where nothing was forecast."""
    rows = tuple(
        (
            f"{one['outcome']}, at {one['instant']}",
            str(one["forecasts"]),
            f"{one['said']:.1f}",
            str(one["came"]),
            f"{one['brier']:.4f}",
            f"{one['brier_of_rate']:.4f}",
            "-" if one["ranks"] is None else f"{one['ranks']:.2f}",
            f"{sum(a['low'] <= a['came'] <= a['high'] for a in one['bins'])} of {len(one['bins'])}",
        )
        for one in found
    )
    head = ("forecast", "of", "said", "came", "Brier", "Brier of the rate", "ranks", "bins in their band")
    return [Sheet(title="Forecasts of the contact, and what came true", head=head, rows=rows)] if rows else []
