"""Campaigns of worlds: flown by another process, replayed by their names in this one, and shown."""

import json
import re
from collections import Counter
from pathlib import Path

import polars as pl
import pytest

from scenarios.campaigns.campaign import Where, fly_campaign
from scenarios.campaigns.cells import WORLD_COLUMN
from scenarios.campaigns.folder import create_folder
from scenarios.campaigns.landing_task import Flown
from scenarios.campaigns.plan import make_plan
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import result_table
from scenarios.worlds.world import draw_world
from tests.scenarios.campaigns.short import scenarios

pytestmark = pytest.mark.slow

CELL = "world"
FIRST_SEED, SEEDS = 6, 1


def quiet(_flown: Flown | None, _done: int, _total: int) -> None:
    """Show nothing."""


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign of a world by another process."""
    folder = tmp_path_factory.mktemp("worlds") / "out"
    plan = make_plan([CELL], first_seed=FIRST_SEED, seeds=SEEDS, config=None)
    rows = fly_campaign(create_folder(folder, plan), plan, Where(workers=1), quiet)
    assert [row["error"] for row in rows] == [None] * SEEDS
    return folder


def test_rows_hold_what_was_drawn_the_conditions_and_what_was_before(flown: Path) -> None:
    frame = pl.read_parquet(flown / "landings.parquet")
    for row in frame.iter_rows(named=True):
        world = draw_world(row["cell"], row["seed"])
        assert {name: row[f"{WORLD_COLUMN}{name}"] for name in world.drawn} == dict(world.drawn)
        assert row["firmware"] == world.scenario.firmware
        assert row["wind_mean_m_s"] == world.scenario.wind.mean_m_s
        assert row["instant_s"] > 0.0
    assert {"before_brake_m_s2", "before_departs", "before_gust_m_s", "data_age_s", "margin"} < set(frame.columns)


def test_world_replays_by_its_name(flown: Path) -> None:
    row = pl.read_parquet(flown / "landings.parquet").row(0, named=True)
    scenario = load_scenario(f"{row['cell']}@{row['seed']}")
    lockstep = Lockstep(scenario, row["seed"])
    result = result_table(scenario, row["seed"], lockstep.recording, lockstep.run())
    for name in ("tier", "closest_m", "horizontal_error_m", "vehicle_speed_m_s", "instant_s", "margin"):
        assert result[name] == row[name]


def test_page_and_figures_show_every_landing(flown: Path) -> None:
    tiers = pl.read_parquet(flown / "landings.parquet")["tier"].to_list()
    assert scenarios("report", flown) == 0
    page = (flown / "report.html").read_text(encoding="utf-8")
    assert f"{tiers.count('S3')} of {SEEDS} landings reached S3" in page
    shown = Counter("S3" if tier == "S3" else "other" for tier in tiers)
    assert all(f"{name} ({count})" in page for name, count in shown.items())
    assert page.count("<svg") >= 3
    assert not re.findall(r'(?:src|href)="http', page)
    assert scenarios("figures", flown) == 0
    names = {file.name for file in (flown / "figures").iterdir()}
    assert names >= {f"{name}.{kind}" for name in ("touchdowns", "errors", "reliability") for kind in ("png", "svg")}


def test_table_shows_the_report_as_text_json_and_markdown(flown: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert scenarios("table", flown) == 0
    text = capsys.readouterr().out
    assert scenarios("table", flown, "--markdown") == 0
    markdown = capsys.readouterr().out
    assert scenarios("table", flown, "--json") == 0
    table = json.loads(capsys.readouterr().out)
    (report,), (cell,) = table["worlds"], table["cells"]
    assert report["worlds"] == cell["cell"] == CELL
    assert report["overall"]["landings"] == cell["seeds"] == len(report["worst"]) == SEEDS
    for worst in report["worst"]:
        assert worst["command"] in text
        assert worst["command"] in markdown
