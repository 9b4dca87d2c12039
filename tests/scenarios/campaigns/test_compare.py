from typing import Any

import pytest
from scipy import stats

from link.errors import UserError
from scenarios.campaigns.compare import compare_rows, differences_of
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.summary import MEASURES


def row(seed: int, tier: str, error_m: float | None = None, cell: str = "straight_5") -> Row:
    measures = dict.fromkeys(MEASURES, error_m)
    firmware = "ardupilot" if "+firmware=ardupilot" in cell else "px4"
    return {
        "cell": cell,
        "firmware": firmware,
        "seed": seed,
        "error": None,
        "tier": tier,
        "s2_quality": tier == "S2",
        **measures,
    }


A = [row(1, "S2", 0.10), row(2, "S1", 0.30), row(3, "S1", 0.40), row(4, "abort"), row(5, "S2", 0.20)]
B = [row(5, "S2", 0.15), row(4, "S2", 0.10), row(3, "S2", 0.10), row(2, "S2", 0.20), row(1, "S2", 0.10)]


def compared(first: list[Row], second: list[Row]) -> dict[str, Any]:
    (cell,) = compare_rows(first, second)["cells"]
    return dict(cell)


def test_comparison_pairs_by_cell_and_seed_in_whatever_order() -> None:
    assert compared(A, B) == compared(A[::-1], B)
    assert compared(A, B)["pairs"] == 5


def test_comparison_tests_the_pairs_that_only_one_reached() -> None:
    found = compared(A, B)["s2_quality"]
    assert (found["only_a"], found["only_b"]) == (0, 3)
    assert found["p"] == pytest.approx(stats.binomtest(0, 3).pvalue)
    assert (found["a"], found["b"]) == (0.4, 1.0)


def test_comparison_of_measures_is_over_pairs_with_contact() -> None:
    found = compared(A, B)["horizontal_error_m"]
    assert found["pairs"] == 4
    assert found["difference"] == pytest.approx(-0.075)  # of 0, -0.1, -0.3 and -0.05
    assert found["low"] <= found["difference"] <= found["high"] <= 0.0


def test_comparison_without_contacts_has_no_difference() -> None:
    found = compared([row(1, "abort")], [row(1, "unsafe")])["sink_rate_m_s"]
    assert found == {"pairs": 0, "a": None, "b": None, "difference": None, "low": None, "high": None}


def test_swapping_the_campaigns_turns_the_signs() -> None:
    forth, back = compared(A, B)["horizontal_error_m"], compared(B, A)["horizontal_error_m"]
    assert back["difference"] == pytest.approx(-forth["difference"])
    assert compared(B, A)["s2_quality"]["p"] == compared(A, B)["s2_quality"]["p"]


def test_campaign_is_no_better_than_itself() -> None:
    found = compared(A, A)
    assert found["s1_or_better"]["p"] == 1.0
    assert (found["horizontal_error_m"]["low"], found["horizontal_error_m"]["high"]) == (0.0, 0.0)


def test_what_has_no_pair_is_counted() -> None:
    comparison = compare_rows([*A, row(9, "S1", cell="circle_5")], B[:3])
    assert comparison["unpaired"] == {"a": 3, "b": 0}
    assert [cell["cell"] for cell in comparison["cells"]] == ["straight_5"]


def test_campaigns_with_nothing_in_common_are_refused() -> None:
    with pytest.raises(UserError, match="no cell and seed in common"):
        compare_rows(A, [row(99, "S1")])


def test_cells_that_differ_in_one_option_are_paired_without_it() -> None:
    default = [row(1, "S2", cell="circle_5+wind=strong"), row(1, "S2", cell="static")]
    other = [row(1, "abort", cell="circle_5+system=ukf+wind=strong"), row(1, "S2", cell="static+system=ukf")]
    with pytest.raises(UserError, match="no cell and seed in common"):
        compare_rows(default, other)
    cells = compare_rows(default, other, "system")["cells"]
    assert [(cell["cell"], cell["pairs"], cell["s1_or_better"]["only_a"]) for cell in cells] == [
        ("circle_5+wind=strong", 1, 1),
        ("static", 1, 0),
        ("together", 2, 1),
    ]


def test_comparison_names_the_firmwares_of_both() -> None:
    first = [row(1, "S2", cell="circle_5"), row(1, "S2", cell="static")]
    second = [row(1, "S2", cell="circle_5+firmware=ardupilot"), row(1, "S2", cell="static")]
    cells = compare_rows(first, second, "firmware")["cells"]
    assert [cell["firmware"] for cell in cells] == ["px4 | ardupilot", "px4", "px4 | px4, ardupilot"]


@pytest.mark.parametrize("turned", [False, True])
def test_cells_of_one_campaign_that_become_the_same_are_refused(*, turned: bool) -> None:
    both = [row(1, "S2", cell="circle_5"), row(1, "abort", cell="circle_5+system=ukf")]
    other = [row(1, "S2", cell="circle_5+system=lkf")]
    first, second = (other, both) if turned else (both, other)
    for cell in ("straight_5", "straight_5+link=nominal"):
        with pytest.raises(UserError, match=r"^--apart-from system: no cell of these campaigns .* leave it out$"):
            compare_rows([row(1, "S2", cell=cell)], [row(1, "S1", cell=cell)], "system")
    with pytest.raises(UserError, match=r"apart-from system: circle_5 and circle_5\+system=ukf of one campaign"):
        compare_rows(first, second, "system")


def test_comparison_tells_aborts_from_unsafe_runs() -> None:
    found = compared([row(seed, "abort") for seed in range(100)], [row(seed, "unsafe") for seed in range(100)])
    assert (found["unsafe"]["a"], found["unsafe"]["b"]) == (0.0, 1.0)
    assert found["unsafe"]["p"] < 1e-20
    assert found["s1_or_better"]["p"] == 1.0


def test_differences_name_the_keys_that_changed() -> None:
    first = {"guidance": {"kind": "mpc", "gain": 1.0}, "cells": [1, 2]}
    second = {"guidance": {"kind": "pn", "gain": 1.0}, "cells": [1, 2], "new": 3}
    assert list(differences_of(first, second)) == [
        {"key": "guidance.kind", "a": "mpc", "b": "pn"},
        {"key": "new", "a": None, "b": 3},
    ]
