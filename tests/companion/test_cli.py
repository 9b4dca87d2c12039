"""The `companion` command: help and mistakes, without a flight."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from companion.__main__ import app
from companion.config.companion import CompanionConfig
from link.program.cli import run_app
from link.program.toml_config import load_config

OPTIONS = (
    "--mavlink",
    "--vehicle",
    "--config",
    "--timeout",
    "--dry-run",
    "--start",
    "--ns",
    "--drone",
    "--print-config",
    "--tlog",
    "--timing",
    "--use-sim-time",
    "--zenoh-config",
)


def _companion(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "companion", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.slow
def test_help_names_every_option() -> None:
    shown = _companion("--help")
    assert shown.returncode == 0
    for option in OPTIONS:
        assert option in shown.stdout


@pytest.mark.slow
def test_printed_configuration_is_the_default_and_can_be_read_back(tmp_path: Path) -> None:
    shown = _companion("--print-config")
    assert shown.returncode == 0
    assert tomllib.loads(shown.stdout)["abort"]["retries_max"] == CompanionConfig().abort.retries_max
    path = tmp_path / "printed.toml"
    path.write_text(shown.stdout, encoding="utf-8")
    assert load_config(path, CompanionConfig) == CompanionConfig()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--config", "there_is_none.toml"), "there_is_none.toml"),
        (("--timeout", "-1"), "--timeout"),
        (("--system-id", "0"), "--system-id"),
        (("check", "--signing-key", "none.key"), "none.key"),
        (("check", "--config", "none.toml"), "none.toml"),
    ],
)
def test_mistake_is_one_line_and_exit_code_2(arguments: tuple[str, ...], named: str) -> None:
    shown = _companion(*arguments)
    assert shown.returncode == 2
    assert named in shown.stderr
    assert "Traceback" not in shown.stderr


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--mavlink", "carrier-pigeon:1"), "carrier-pigeon"),
        (("--mavlink", "/dev/ttyNONE,57600"), "/dev/ttyNONE"),
        (("--zenoh-config", "none.json5"), "none.json5"),
        (("-l", "tcp/192.0.2.1:7447"), "192.0.2.1"),
        (("--timing", "there/is/no/folder.json"), "folder.json"),
        (("--tlog", "there/is/no/flight.tlog"), "flight.tlog"),
        (("--signing-key", "none.key"), "none.key"),
    ],
)
def test_mistake_is_told_before_the_numerics_are_loaded(
    arguments: tuple[str, ...], named: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "companion.runtime.build", None)  # whoever imports it now, fails
    assert run_app("companion", app, ["--mavlink", "udpin:127.0.0.1:0", *arguments]) == 2
    assert named in capsys.readouterr().err


@pytest.mark.slow
def test_no_autopilot_within_the_time_out_is_said() -> None:
    shown = _companion("--mavlink", "udpin:127.0.0.1:0", "--timeout", "0.5", "-l", "tcp/127.0.0.1:0", "-m", "peer")
    assert shown.returncode == 2
    assert "no heartbeat" in shown.stderr
