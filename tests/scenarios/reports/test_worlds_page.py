"""The page about a campaign of worlds, of landings made by hand."""

from pathlib import Path

import pytest

from scenarios.campaigns.folder import create_folder, open_journal
from scenarios.campaigns.landing_task import Flown
from scenarios.campaigns.plan import make_plan
from scenarios.reports.html_report import write_report
from tests.scenarios.campaigns.test_worlds_report import ROWS


def campaign(folder: Path, cell: str = "world:urban") -> Path:
    """Write the folder of a campaign of a hundred landings, of worlds unless told."""
    plan = make_plan([cell], first_seed=1, seeds=len(ROWS), config=None)
    create_folder(folder, plan)
    with open_journal(folder) as journal:
        for row in ROWS:
            journal.add(Flown(row=row | {"cell": cell}, wall_s=2.0))
        journal.write_results()
    return folder


@pytest.mark.slow
def test_page_shows_rates_causes_and_the_worst_and_opens_offline(tmp_path: Path) -> None:
    page = write_report(campaign(tmp_path / "worlds"), None).read_text(encoding="utf-8")
    assert "<h3>world:urban: tiers in % (95 % intervals)</h3>" in page
    assert "12.0 (7.0 to 19.8)" in page
    assert "<h3>world:urban over cruising speed</h3>" in page
    assert "<td>scenarios run world:urban@100 --lockstep</td>" in page
    assert "Landings of the worlds that were unsafe" in page
    assert page.count("<svg") == 3
    assert 'src="http' not in page


@pytest.mark.slow
def test_page_about_a_campaign_on_a_road_has_no_worlds(tmp_path: Path) -> None:
    page = write_report(campaign(tmp_path / "road", "straight_5"), None).read_text(encoding="utf-8")
    assert "100 landings" in page
    assert "<h2>Worlds</h2>" not in page
