"""A campaign's table in Markdown."""

from io import StringIO
from typing import Any

import pytest

from scenarios.campaigns.markdown import shared_options, write_markdown
from scenarios.campaigns.summary import summarize
from tests.scenarios.campaigns.test_summary import row

CALM, ROUGH = "circle_5+wind=calm+link=nominal", "circle_5+wind=severe+link=nominal"


def written(*rows: dict[str, Any]) -> list[list[str]]:
    """The lines of the table, cell by cell."""
    out = StringIO()
    write_markdown(summarize(rows), out)
    lines = [line for line in out.getvalue().splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


@pytest.mark.parametrize(
    ("names", "shared"),
    [
        ([], []),
        (["straight_5"], []),
        ([CALM], ["wind=calm", "link=nominal"]),
        ([CALM, ROUGH], ["link=nominal"]),
        ([CALM, "straight_5"], []),
    ],
)
def test_options_that_all_cells_have_are_said_once(names: list[str], shared: list[str]) -> None:
    assert shared_options(names) == shared


def test_each_cell_is_a_row_and_all_together_are_the_last() -> None:
    rows = [row(1, "S3", CALM, s2_quality=True), row(2, "abort", CALM), row(1, "S2", ROUGH), row(2, "unsafe", ROUGH)]
    head, _, calm, rough, total = (dict(enumerate(line)) for line in written(*rows))
    at = {heading: place for place, heading in head.items()}
    assert [line[at["cell"]] for line in (calm, rough, total)] == [
        "`circle_5+wind=calm`",
        "`circle_5+wind=severe`",
        "all",
    ]
    tiers = ("seeds", "S3", "S2", "abort", "unsafe")
    assert [calm[at[name]] for name in tiers] == ["2", "1", "", "1", ""]
    assert [rough[at[name]] for name in tiers] == ["2", "", "1", "", "1"]
    assert [total[at[name]] for name in tiers] == ["4", "1", "1", "1", "1"]
    assert total[at["unsafe %"]].startswith("25 (")
    assert calm[at["horizontal error m"]] == "0.10, 0.10"


def test_firmwares_of_a_cell_are_rows_one_under_the_other_and_have_each_its_own_line_of_totals() -> None:
    names = [f"{cell}+firmware={firmware}" for firmware in ("ardupilot", "px4") for cell in (ROUGH, CALM)]
    head, _, *lines = written(*(row(1, "S3", name) for name in names))
    assert [line[head.index("cell")] for line in lines] == [
        *["`circle_5+wind=calm`"] * 2,
        *["`circle_5+wind=severe`"] * 2,
        *["all"] * 2,
    ]
    assert [line[head.index("firmware")] for line in lines] == ["px4", "ardupilot"] * 3


def test_reasons_are_told_below_the_table_by_firmware() -> None:
    out = StringIO()
    why = {"aborts_by_reason": "STRAYS 2"}
    write_markdown(summarize([row(1, **why), row(2, **why), row(1, cell="static+firmware=ardupilot", **why)]), out)
    assert out.getvalue().splitlines()[-3:] == [
        "Approaches broken off, by reason, px4: `STRAYS` 4.",
        "",
        "Approaches broken off, by reason, ardupilot: `STRAYS` 2.",
    ]


def test_all_lines_of_the_table_have_as_many_cells() -> None:
    lines = written(row(1, "S3", CALM), row(1, "unsafe", ROUGH))
    assert len({len(line) for line in lines}) == 1


def test_one_cell_has_no_line_of_totals() -> None:
    assert len(written(row(1), row(2))) == 3
