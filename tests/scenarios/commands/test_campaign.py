import json
import subprocess
import sys
from pathlib import Path

import pytest

from scenarios.campaigns.folder import create_folder, open_journal, read_landings
from scenarios.campaigns.landing_task import Flown, Row
from scenarios.campaigns.plan import make_plan
from scenarios.campaigns.summary import MEASURES
from tests.scenarios.campaigns.short import scenarios, short_cell


def campaign(folder: Path, *, errors_m: tuple[float, ...], config: Path | None = None) -> Path:
    """Return the folder of a campaign with results of its own making."""
    plan = make_plan(["straight_5"], first_seed=1, seeds=len(errors_m), config=config)
    create_folder(folder, plan)
    with open_journal(folder) as journal:
        for task, error_m in zip(plan.tasks(), errors_m, strict=True):
            row: Row = {"cell": task.cell, "seed": task.seed, "error": None, "tier": "S3", "s2_quality": True}
            journal.add(Flown(row=row | dict.fromkeys(MEASURES, error_m), wall_s=2.0))
        journal.write_results()
    return folder


def refusal(capsys: pytest.CaptureFixture[str], *args: object) -> str:
    assert scenarios(*args) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    return printed.err


def test_table_prints_a_campaign_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1, 0.3))
    assert scenarios("table", folder) == 0
    assert "straight_5" in capsys.readouterr().out
    assert scenarios("table", folder, "--json") == 0
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert cell["tiers"]["S3"] == cell["seeds"] == 2
    assert cell["horizontal_error_m"] == {"median": 0.2, "p95": 0.29}


def test_compare_pairs_two_campaigns_and_tells_what_differs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = tmp_path / "companion.toml"
    config.write_text("[guidance]\nkind = 'pn'\n", encoding="utf-8")
    first = campaign(tmp_path / "a", errors_m=(0.1, 0.3))
    second = campaign(tmp_path / "b", errors_m=(0.2, 0.6), config=config)
    assert scenarios("compare", first, second, "--json") == 0
    comparison = json.loads(capsys.readouterr().out)
    assert comparison["cells"][0]["horizontal_error_m"]["difference"] == 0.2
    changed = {difference["key"]: difference["b"] for difference in comparison["differences"]}
    assert changed == {"scenarios.straight_5.system.companion.guidance.kind": "pn"}
    assert scenarios("compare", first, second) == 0
    assert "companion.guidance.kind: mpc | pn" in capsys.readouterr().out


def test_config_changes_only_what_it_sets(tmp_path: Path) -> None:
    config = tmp_path / "companion.toml"
    config.write_text("[descent.alignment]\nheight_m = 1.25\n", encoding="utf-8")
    cells = ["straight_5+system=pn", "straight_5+system=lkf", "straight_5"]
    own = make_plan(cells, first_seed=1, seeds=1, config=None).scenarios
    laid = make_plan(cells, first_seed=1, seeds=1, config=config).scenarios
    assert laid["straight_5+system=pn"].system.companion.guidance.kind.value == "pn"
    assert laid["straight_5+system=lkf"].system.companion.estimator.kind.value == "lkf"
    for cell in cells:
        before, after = own[cell].model_dump(), laid[cell].model_dump()
        assert after["system"]["companion"]["descent"]["alignment"].pop("height_m") == 1.25
        assert before["system"]["companion"]["descent"]["alignment"].pop("height_m") != 1.25
        assert after == before


def test_config_that_does_not_fit_over_a_cell_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = tmp_path / "companion.toml"
    config.write_text("[descent.alignment]\nhight_m = 1.25\n", encoding="utf-8")
    assert "'height_m'" in refusal(capsys, "campaign", "straight_5", "--config", config)


def test_campaign_refuses_a_cell_twice(capsys: pytest.CaptureFixture[str]) -> None:
    assert "'straight_5' is given twice" in refusal(capsys, "campaign", "straight_5", "straight_5")


def test_campaign_flies_each_cell_with_both_firmwares() -> None:
    plan = make_plan(["straight_5+wind=light", "static"], first_seed=1, seeds=2, config=None, firmware="both")
    firmwares = {cell: plan.scenarios[cell].firmware for cell in plan.cells}
    assert firmwares == {
        "straight_5+wind=light+firmware=px4": "px4",
        "straight_5+wind=light+firmware=ardupilot": "ardupilot",
        "static+firmware=px4": "px4",
        "static+firmware=ardupilot": "ardupilot",
    }
    assert len(plan.tasks()) == 8


@pytest.mark.parametrize(
    ("cell", "firmware", "told"),
    [("static", "inav", "one of px4, ardupilot, both"), ("static+firmware=px4", "both", "names its firmware")],
)
def test_campaign_refuses_a_firmware_that_is_none_or_stands_twice(
    cell: str, firmware: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert told in refusal(capsys, "campaign", cell, "--firmware", firmware)


def test_rows_of_a_campaign_without_firmware_have_that_of_their_cell(tmp_path: Path) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1,))
    assert [row["firmware"] for row in read_landings(folder)] == ["px4"]


def test_campaign_refuses_a_folder_in_use(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1,))
    assert "not empty" in refusal(capsys, "campaign", short_cell(tmp_path), "--out", folder)


def test_campaign_refuses_cells_beside_resume(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1,))
    assert "leave out cells" in refusal(capsys, "campaign", "straight_5", "--resume", folder)


@pytest.mark.parametrize("address", ["foo", "tcp://127.0.0.1:1"])
def test_campaign_without_its_cluster_leaves_no_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], address: str
) -> None:
    folder = tmp_path / "a"
    said = refusal(capsys, "campaign", "straight_5", "--scheduler", address, "--out", folder)
    assert f"no Dask scheduler answers at {address}" in said
    assert not folder.exists()


def test_resuming_with_other_sources_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1,))
    file = folder / "campaign.json"
    table = json.loads(file.read_text(encoding="utf-8"))
    table["versions"]["sources"] = "0123456789ab"
    file.write_text(json.dumps(table), encoding="utf-8")
    assert "begun with another version of sources" in refusal(capsys, "campaign", "--resume", folder)


@pytest.mark.parametrize("command", ["table", "campaign --resume"])
def test_folder_without_a_campaign_is_named(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert f"{tmp_path / 'campaign.json'}: cannot be read" in refusal(capsys, *command.split(), tmp_path)


def test_campaign_without_results_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    create_folder(tmp_path / "a", make_plan(["straight_5"], first_seed=1, seeds=1, config=None))
    said = refusal(capsys, "table", tmp_path / "a")
    assert "no landing is done" in said
    assert f"--resume {tmp_path / 'a'}" in said


def test_killed_campaign_shows_what_is_done(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = campaign(tmp_path / "a", errors_m=(0.1, 0.3))
    assert scenarios("table", whole, "--json") == 0
    expected = capsys.readouterr().out
    killed = campaign(tmp_path / "b", errors_m=(0.1, 0.3, 0.5))
    for file in ("landings.parquet", "timing.parquet"):
        (killed / file).unlink()
    journal = killed / "landings.jsonl"
    journal.write_text(journal.read_text(encoding="utf-8")[:-20], encoding="utf-8")  # within the third line
    assert scenarios("table", killed, "--json") == 0
    printed = capsys.readouterr()
    assert printed.out == expected
    assert printed.err == f"2 of 3 landings are done; go on with: scenarios campaign --resume {killed}\n"
    assert scenarios("compare", whole, killed, "--json") == 0
    assert json.loads(capsys.readouterr().out)["cells"][0]["horizontal_error_m"]["difference"] == 0.0


def test_campaign_that_was_killed_while_it_went_on_shows_the_newer_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1, 0.3))
    old = {file: (folder / file).read_bytes() for file in ("landings.parquet", "timing.parquet")}
    again = campaign(tmp_path / "b", errors_m=(0.1, 0.3, 0.8))
    for file, data in old.items():
        (again / file).write_bytes(data)
    assert scenarios("table", again, "--json") == 0
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert cell["seeds"] == 3


def test_campaign_is_shown_by_its_results_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = campaign(tmp_path / "a", errors_m=(0.1, 0.3))
    assert scenarios("table", folder, "--json") == 0
    expected = capsys.readouterr().out
    (folder / "landings.jsonl").unlink()
    assert scenarios("table", folder, "--json") == 0
    assert capsys.readouterr().out == expected


def test_commands_load_no_numerics() -> None:
    code = "import sys, tests.scenarios.campaigns; sys.exit('numpy' in sys.modules or 'polars' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
