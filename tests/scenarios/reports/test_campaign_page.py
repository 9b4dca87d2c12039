"""A campaign's figures and its page, of two landings."""

import re
from pathlib import Path

import pytest

from tests.scenarios.campaigns.short import scenarios

pytestmark = pytest.mark.slow


def test_page_and_figures_of_a_campaign_show_every_landing(tmp_path: Path) -> None:
    folder = tmp_path / "two"
    assert scenarios("campaign", "straight_5", "--seeds", 2, "--workers", 1, "--out", folder) == 0
    assert scenarios("report", folder) == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "2 of 2 landings reached S3" in page
    assert "S3 (2)" in page
    assert "straight_5, px4" in page
    assert len(re.findall("<svg", page)) == 3
    assert not re.findall(r'(?:src|href)="http', page)
    assert scenarios("figures", folder) == 0
    names = {file.name for file in (folder / "figures").iterdir()}
    assert names == {f"{name}.{kind}" for name in ("touchdowns", "errors", "reliability") for kind in ("png", "svg")}
