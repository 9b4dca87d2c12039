"""The `companion` command: help and mistakes, without a flight."""

import subprocess
import sys
from pathlib import Path

import pytest

from companion.app import app
from companion.config.companion import CompanionConfig
from link.program.cli import run_app
from link.program.toml_config import load_config


def test_printed_configuration_is_the_default_and_can_be_read_back(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app("companion", app, ["--print-config"]) == 0
    path = tmp_path / "printed.toml"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    assert load_config(path, CompanionConfig) == CompanionConfig()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--mavlink", "carrier-pigeon:1"), "carrier-pigeon"),
        (("--mavlink", "/dev/ttyNONE,57600"), "/dev/ttyNONE"),
        (("--zenoh-config", "none.json5"), "none.json5"),
        (("-l", "tcp/192.0.2.1:7447"), "--insecure"),
        (("-l", "tcp/192.0.2.1:7447", "--insecure"), "192.0.2.1"),
        (("--timing", "there/is/no/folder.json"), "folder.json: there is no folder there/is/no; make it"),
        (("--tlog", "there/is/no/flight.tlog"), "flight.tlog: there is no folder there/is/no; make it"),
        (("--tlog", "/dev/null/flight.tlog"), "there is no folder /dev/null"),
        (("--tlog", "/"), "is a folder; name a file"),
        (("--record", "/dev/null/today"), "/dev/null/today: cannot be recorded into"),
        (("--signing-key", "none.key"), "none.key"),
    ],
)
def test_mistake_is_told_before_the_numerics_are_loaded(
    arguments: tuple[str, ...], named: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "companion.runtime.build", None)  # whoever imports it now, fails
    assert run_app("companion", app, ["--mavlink", "udpin:127.0.0.1:0", *arguments]) == 2
    assert named in capsys.readouterr().err


@pytest.mark.parametrize("is_configured", [False, True])
def test_other_files_may_lie_in_a_new_folder_of_the_recording(
    is_configured: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "flights" / "today"
    record = ("--set", f'recording.folder="{folder}"') if is_configured else ("--record", str(folder))
    files = ("--tlog", str(folder / "flight.tlog"), "--timing", str(folder / "timing.json"))
    assert run_app("companion", app, ["--mavlink", "/dev/ttyNONE,57600", *record, *files]) == 2
    assert capsys.readouterr().err.startswith("companion: /dev/ttyNONE")


def test_help_loads_no_numerics_and_no_network() -> None:
    heavy = {"scipy", "numba", "osqp", "zenoh", "cv2"}
    code = f"import sys, companion.app; print({heavy} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
