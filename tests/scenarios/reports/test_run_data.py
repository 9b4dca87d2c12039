"""What of a run's files its page and figures cannot show is told in one line."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from link.errors import UserError
from scenarios.reports.run_data import PhaseSpan, read_result
from scenarios.reports.run_shown import contact_index, is_shown

APPROACH = {
    "from_s": 15.1,
    "to_s": 21.1,
    "ended": "touchdown",
    "lowest_m": None,
    "reason_code": "CONTACT",
    "reason": "contact",
    "begun_anew": [],
}
RESULT = {"scenario": "straight_5", "seed": 2, "tier": "S3", "reason": "landed", "nis_sum": None, "nis_dof": None}


def read(folder: Path, **changed: object) -> dict[str, Any]:
    """Return what is read of a result with other values."""
    path = folder / "result.json"
    path.write_text(json.dumps(RESULT | changed), encoding="utf-8")
    return read_result(path)


def test_result_of_a_run_is_read_as_it_is(tmp_path: Path) -> None:
    assert read(tmp_path, approaches=[APPROACH]) == RESULT | {"approaches": [APPROACH]}


@pytest.mark.parametrize(
    ("changed", "where"),
    [
        ({"approaches": [{key: one for key, one in APPROACH.items() if key != "begun_anew"}]}, "begun_anew"),
        ({"approaches": [APPROACH | {"to_s": "21.1"}]}, "to_s"),
        ({"nees_mean": [1.0]}, "nees_mean"),
        ({"nis_dof": -1}, "nis_dof"),
    ],
)
def test_value_that_cannot_be_shown_is_named(tmp_path: Path, changed: dict[str, object], where: str) -> None:
    with pytest.raises(UserError, match=where):
        read(tmp_path, **changed)


def test_contact_after_the_end_of_a_truth_that_was_broken_off_is_not_drawn() -> None:
    run: Any = SimpleNamespace(t_s=np.array([0.0, 0.1, 0.2]), result={"contact_s": 0.3})
    assert contact_index(run) is None
    run.result["contact_s"] = 0.2
    assert contact_index(run) == 2


@pytest.mark.parametrize(("end_s", "shown_from_s"), [(20.0, 12.0), (12.5, 12.0), (12.0, 0.0), (4.0, 0.0)])
def test_truth_that_was_broken_off_before_the_landing_is_shown_from_its_beginning(
    end_s: float, shown_from_s: float
) -> None:
    chase = PhaseSpan(phase="chase", reason="", from_s=15.0, to_s=18.0)
    run: Any = SimpleNamespace(t_s=np.arange(0.0, end_s + 0.25, 0.5), phases=(chase,))
    assert run.t_s[is_shown(run)][0] == shown_from_s
