import math

import numpy as np
import pytest
from scipy import stats

from link.errors import UserError
from link.program.toml_config import validate
from scenarios.worlds.distributions import Choice, Graded, share_below
from scenarios.worlds.odd import Domain
from tests.scenarios.worlds.references import LEVELS, PLAIN, Bounded, reference_of


@pytest.mark.parametrize("plain", PLAIN, ids=lambda one: one.kind)
def test_quantile_is_that_of_scipys_distribution(plain: Bounded) -> None:
    levels = np.array(LEVELS)
    ours = np.array([plain.quantile(float(u)) for u in levels])
    np.testing.assert_allclose(reference_of(plain).cdf(ours), levels, atol=1e-9)


@pytest.mark.parametrize("plain", PLAIN, ids=lambda one: one.kind)
def test_quantile_keeps_to_the_bounds_at_the_ends(plain: Bounded) -> None:
    low, high = plain.low, plain.high
    ends = [plain.quantile(u) for u in (1e-300, 2.0**-53, 1.0 - 2.0**-53)]
    assert all(low <= value <= high for value in ends)
    assert all(math.isfinite(value) for value in ends)


@pytest.mark.parametrize("plain", PLAIN, ids=lambda one: one.kind)
@pytest.mark.parametrize("share", [0.003, 0.31, 0.87])
def test_share_below_a_quantile_is_its_own(plain: Bounded, share: float) -> None:
    assert share_below(plain, plain.quantile(share)) == pytest.approx(share, abs=1e-9)


@pytest.mark.parametrize("plain", PLAIN, ids=lambda one: one.kind)
def test_value_beyond_the_bounds_has_no_share_below(plain: Bounded) -> None:
    assert share_below(plain, plain.low - 0.1) is None
    assert share_below(plain, plain.high + 0.1) is None


def test_choice_has_its_value_between_the_shares_it_says_and_not_beside() -> None:
    choice = Choice(kind="choice", values=("a", "b", "c"), weights=(1.0, 5.0, 2.0))
    assert choice.shares("b") == (0.125, 0.75)
    drawn = [choice.quantile(u) for u in (0.124, 0.126, 0.749, 0.751)]
    assert drawn == ["a", "b", "b", "c"]


def test_choice_takes_each_value_by_its_weight() -> None:
    choice = Choice(kind="choice", values=("a", "b", "c"), weights=(1.0, 5.0, 2.0))
    levels = [(i + 0.5) / 800 for i in range(800)]
    drawn = [choice.quantile(u) for u in levels]
    assert [drawn.count(value) for value in choice.values] == [100, 500, 200]


@pytest.mark.parametrize(("quality", "median"), [(0.0, 0.3), (1.0, 0.01), (0.25, 0.3 * (0.01 / 0.3) ** 0.25)])
def test_graded_value_scatters_about_the_median_of_its_quality(quality: float, median: float) -> None:
    graded = Graded(kind="graded", quality="sensors.quality", poor=0.3, good=0.01, spread=0.4)
    assert graded.quantile_at(quality, 0.5) == pytest.approx(median)
    z = [math.log(graded.quantile_at(quality, u) / median) / 0.4 for u in LEVELS]
    np.testing.assert_allclose(stats.truncnorm(-2.0, 2.0).cdf(z), LEVELS, atol=1e-9)


@pytest.mark.parametrize(
    ("quantity", "told"),
    [
        ({"kind": "uniform", "low": 2.0, "high": 1.0}, "low, 2, must be below high, 1"),
        ({"kind": "normal", "mean": 0.0, "std": -1.0, "low": -1.0, "high": 1.0}, "std = -1.0"),
        ({"kind": "log_uniform", "low": 0.0, "high": 1.0}, "low = 0.0"),
        ({"kind": "choice", "values": ["a", "b"], "weights": [1.0]}, "2 values need as many weights, not 1"),
        ({"kind": "choice", "values": ["a"], "weights": [0.0]}, "weights[0] = 0.0"),
        ({"kind": "cauchy", "low": 0.0, "high": 1.0}, "cauchy"),
        ({"by": "t.none", "cases": {"a": {"kind": "uniform", "low": 0.0, "high": 1.0}}}, "'t.none'"),
        ({"by": "t.side", "cases": {"a": {"kind": "uniform", "low": 0.0, "high": 1.0}}}, "one case for each of a, b"),
        ({"kind": "graded", "quality": "t.none", "poor": 1.0, "good": 2.0, "spread": 1.0}, "'t.none'"),
    ],
)
def test_domain_with_what_cannot_be_drawn_is_refused_in_one_line(quantity: dict[str, object], told: str) -> None:
    side = {"kind": "choice", "values": ["a", "b"], "weights": [1.0, 1.0]}
    table = {"version": 1, "quantities": {"t": {"side": side, "value": quantity}}, "slices": {}}
    with pytest.raises(UserError) as error:
        validate(Domain, table, source="odd.toml")
    assert told in str(error.value)
    assert "\n" not in str(error.value)
    assert "value" in str(error.value)


def test_slice_of_what_is_no_quantity_is_refused() -> None:
    even = {"kind": "uniform", "low": 0.0, "high": 1.0}
    table = {"version": 1, "quantities": {"t": {"value": even}}, "slices": {"part": {"t": {"valeu": even}}}}
    with pytest.raises(UserError, match=r"'t\.valeu'"):
        validate(Domain, table, source="odd.toml")
