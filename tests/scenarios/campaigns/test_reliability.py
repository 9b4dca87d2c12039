"""Right forecasts lie in their bands and rank what comes true higher; wrong ones are found out."""

import numpy as np
import pytest
from scipy.stats import binom

from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.reliability import compare, reliability, reliability_sheets


def test_right_forecasts_are_in_their_band_and_wrong_ones_are_not() -> None:
    generator = np.random.default_rng(3)
    said = generator.beta(0.5, 4.0, 2000)
    came = generator.uniform(size=2000) < said
    right, wrong = compare(said, came), compare(np.minimum(2.5 * said, 1.0), came)
    assert sum(one["low"] <= one["came"] <= one["high"] for one in right["bins"]) >= 9
    assert sum(one["low"] <= one["came"] <= one["high"] for one in wrong["bins"]) <= 4
    assert right["brier"] < right["brier_of_rate"]
    assert right["ranks"] > 0.7


def test_the_band_of_equal_chances_is_the_binomial_one() -> None:
    (one,) = compare(np.full(30, 0.2), np.zeros(30, dtype=bool))["bins"]
    band = [float(binom.ppf(level, 30, 0.2)) / 30 for level in (0.025, 0.975)]
    assert [one["low"], one["high"]] == pytest.approx(band, abs=1e-6)


def test_ranks_are_not_told_where_nothing_came_true() -> None:
    assert compare(np.full(5, 0.1), np.zeros(5, dtype=bool))["ranks"] is None


def _row(came: str, s2: float) -> Row:
    forecast = {"at_s": 3.0, "s1": s2, "s2": s2, "unsafe": 0.1, "broken_off": 0.9 - s2, "came": came}
    return {f"forecast_commit_{name}": value for name, value in forecast.items()}


def test_only_instants_with_forecasts_are_reported() -> None:
    rows = [_row("s2", 0.8), _row("unsafe", 0.3), {"forecast_commit_came": None, "forecast_waiting_came": None}]
    found = reliability(rows)
    assert [(one["instant"], one["outcome"], one["forecasts"], one["came"]) for one in found] == [
        ("commit", "unsafe contact", 2, 1),
        ("commit", "S2 or better", 2, 1),
        ("commit", "no contact", 2, 0),
    ]
    assert len(reliability_sheets(found)[0].rows) == 3
    assert reliability_sheets(reliability([{}])) == []
