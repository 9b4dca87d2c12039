"""Rates of tiers, together and in bins, against tables made by hand."""

from itertools import pairwise

import pytest
from scipy import stats

from scenarios.campaigns.landing_task import Task, failed_row
from scenarios.campaigns.tier_rates import binned, grouped, tier_rates
from tests.scenarios.campaigns.test_summary import row


def test_rates_are_shares_of_all_landings_with_wilsons_interval() -> None:
    error = failed_row(Task(cell="straight_5", seed=9), {"firmware": "px4"}, "ValueError: wrong")
    found = tier_rates([row(1), row(2), row(3, "unsafe"), error])
    assert (found["landings"], found["errors"]) == (4, 1)
    assert {tier: rate["count"] for tier, rate in found["tiers"].items() if rate["count"]} == {"S3": 2, "unsafe": 1}
    expected = stats.binomtest(1, 4).proportion_ci(0.95, method="wilson")
    unsafe = found["tiers"]["unsafe"]
    assert (unsafe["share"], unsafe["low"], unsafe["high"]) == pytest.approx(
        (0.25, expected.low, expected.high), abs=1e-6
    )


def test_bins_hold_as_many_landings_each_and_all_of_them() -> None:
    rows = [row(seed, "unsafe" if seed > 80 else "S3", data_age_s=0.01 * seed) for seed in range(1, 101)]
    bins = binned(rows[::-1], "data_age_s")
    assert [one["landings"] for one in bins] == [20] * 5
    assert [one["tiers"]["unsafe"]["count"] for one in bins] == [0, 0, 0, 0, 20]
    assert (bins[0]["low"], bins[-1]["high"]) == (0.01, 1.0)
    assert all(before["high"] == after["low"] for before, after in pairwise(bins))


def test_few_landings_make_one_bin() -> None:
    (one,) = binned([row(seed, data_age_s=0.1 * seed) for seed in range(1, 8)], "data_age_s")
    assert (one["low"], one["high"], one["landings"]) == (0.1, 0.7, 7)


def test_value_that_many_have_is_in_one_bin() -> None:
    rows = [row(seed, vehicle_speed_m_s=0.0 if seed <= 60 else 0.1 * seed) for seed in range(1, 101)]
    bins = binned(rows, "vehicle_speed_m_s")
    assert sum(one["landings"] for one in bins) == 100
    assert bins[0]["low"] == 0.0
    assert bins[0]["landings"] >= 60


def test_bin_of_equal_values_has_no_width() -> None:
    (one,) = binned([row(seed, pad_side_m=1.5) for seed in range(1, 50)], "pad_side_m")
    assert (one["low"], one["high"], one["landings"]) == (1.5, 1.5, 49)


def test_landings_without_a_value_are_in_no_bin() -> None:
    rows = [row(1, vehicle_curvature_per_m=None), row(2, vehicle_curvature_per_m=0.02), row(3)]
    (one,) = binned(rows, "vehicle_curvature_per_m")
    assert one["landings"] == 1
    assert binned(rows, "wind_mean_m_s") == []


def test_groups_are_by_word_in_their_order() -> None:
    words = {1: "van", 2: "car", 3: "van", 4: None}
    found = grouped([row(seed, vehicle=word) for seed, word in words.items()], "vehicle")
    assert {word: one["landings"] for word, one in found.items()} == {"car": 1, "van": 2}
    assert list(found) == ["car", "van"]
