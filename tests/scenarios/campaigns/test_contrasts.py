"""What failed worlds drew otherwise, on worlds made by hand."""

import numpy as np
import pytest
from scipy import stats

from scenarios.campaigns.contrasts import contrasts
from scenarios.campaigns.intervals import rank_contrast
from scenarios.campaigns.landing_task import Row
from tests.scenarios.campaigns.test_summary import row


def worlds(count: int = 200, quiet: int = 60) -> list[Row]:
    """Worlds that fail where they are fast, with many other numbers that mean nothing."""
    rng = np.random.default_rng(5)
    rows = []
    for seed in range(count):
        drawn = {f"world.noise.n{number}": float(rng.random()) for number in range(quiet)}
        speed_m_s = float(rng.uniform(2.0, 20.0))
        failed = speed_m_s > 14.0 and rng.random() < 0.3
        rest = {"world.vehicle.class": "van", "world.wind.gust": bool(rng.random() < 0.5), "world.same": 3.0}
        rows.append(row(seed, "unsafe" if failed else "S3", **{"world.speed_m_s": speed_m_s}, **drawn, **rest))
    return rows


def unsafe(rows: list[Row]) -> list[Row]:
    return [one for one in rows if one["tier"] == "unsafe"]


def test_number_that_makes_worlds_fail_is_named_and_what_means_nothing_is_not() -> None:
    rows = worlds()
    (found,) = contrasts(rows, unsafe(rows))
    assert found["column"] == "world.speed_m_s"
    assert found["failed"] > 14.0 > found["landed"]
    assert found["above"] > 0.85


def test_p_is_corrected_for_all_columns() -> None:
    rows = worlds()
    plain = [{name: value for name, value in one.items() if "noise" not in name} for one in rows]
    many, few = contrasts(rows, unsafe(rows))[0], contrasts(plain, unsafe(plain))[0]
    assert many["p"] == pytest.approx(few["p"] * 62.0 / 2.0)  # 60 that mean nothing, the speed and the gust


def test_few_failures_name_nothing() -> None:
    rows = worlds()
    assert contrasts(rows, unsafe(rows)[:4]) == []
    assert contrasts(rows, []) == []


def test_contrast_is_mann_and_whitneys() -> None:
    above, p = rank_contrast([3.0, 4.0, 7.0], [1.0, 2.0, 3.0, 5.0])
    assert above == pytest.approx((2.5 + 3.0 + 4.0) / 12.0)
    assert p == stats.mannwhitneyu([3.0, 4.0, 7.0], [1.0, 2.0, 3.0, 5.0]).pvalue
    assert rank_contrast([1.0, 2.0], [2.0, 1.0])[0] == 0.5
