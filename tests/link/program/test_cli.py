"""Command lines: mistakes are one line and exit code 2, help is plain and quick."""

import subprocess
import sys
import time
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import pytest
import typer

from link.errors import UserError
from link.program.cli import make_app, run_app
from link.program.help import App
from link.zenoh.command_line import NameArguments, ZenohArguments

Seen = list[dict[str, object]]


def program(seen: Seen) -> App:
    """Return an app that has the common options and two commands that fail."""
    app = make_app("Tests the command line.")

    @app.command()
    def run(
        *,
        names: NameArguments,
        endpoints: ZenohArguments,
        seed: int = 0,
        height: Annotated[list[float] | None, typer.Option("--height", min=0.05)] = None,
    ) -> None:
        """Record the options."""
        seen.append(asdict(names) | asdict(endpoints) | {"seed": seed, "height": height})

    @app.command()
    def fail(code: int = 0) -> int:
        """Fail in the way that is asked for."""
        if code == 2:
            raise UserError("the port is in use,\n  choose [another]")
        if code == 130:
            raise KeyboardInterrupt
        if code == 5:
            raise typer.Exit(5)
        return code

    return app


@pytest.mark.slow
def test_common_options_reach_the_command() -> None:
    seen: Seen = []
    line = "run --ns site -m client -e tcp/a:1 -e tcp/b:2 -l tcp/c:3 --no-multicast-scouting --zenoh-config z.json5"
    assert run_app("tool", program(seen), line.split()) == 0
    options = seen[0]
    assert (options["namespace"], options["vehicle"], options["drone"]) == ("site", "vehicle", "drone")
    assert (options["mode"], options["connect"], options["listen"]) == ("client", ["tcp/a:1", "tcp/b:2"], ["tcp/c:3"])
    assert (options["multicast"], options["zenoh_config"]) == (False, Path("z.json5"))


def test_options_left_out_are_none() -> None:
    seen: Seen = []
    assert run_app("tool", program(seen), ["run"]) == 0
    assert [seen[0][name] for name in ("mode", "multicast", "zenoh_config")] == [None, None, None]
    assert not seen[0]["connect"]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("fail --code 2", "tool: the port is in use, choose [another]"),
        ("rn", "Did you mean 'run'?"),
        ("run --sed 3", "--seed"),
        ("run --seed three", "--seed three: must be a whole number (see tool run -h)"),
        ("run --seed", "--seed"),
        ("run --height 1 --height 0.01", "--height 0.01: must be a number, 0.05 or more (see tool run -h)"),
        ("run extra", "extra"),
    ],
)
def test_a_mistake_is_one_line_on_stderr_and_exit_code_2(
    line: str, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app("tool", program([]), line.split()) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.startswith("tool: ")
    assert output.err.count("\n") == 1
    assert expected in output.err


@pytest.mark.parametrize("line", ["", "-h", "run -h"])
def test_a_program_without_a_command_and_minus_h_print_the_help(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app("tool", program([]), line.split()) == 0
    assert "--help" in capsys.readouterr().out


def test_a_mistake_points_at_the_help_of_its_own_command(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["run", "extra"], ["run", "--seed"]):  # of the second typer does not tell where it was
        run_app("tool", program([]), words)
        assert "(see tool run -h)" in capsys.readouterr().err


def test_interrupt_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app("tool", program([]), ["fail", "--code", "130"]) == 130
    assert capsys.readouterr().err == ""


def test_a_commands_own_exit_code_is_kept() -> None:
    assert run_app("tool", program([]), ["fail", "--code", "3"]) == 3
    assert run_app("tool", program([]), ["fail", "--code", "5"]) == 5


def test_help_goes_to_stdout_as_plain_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app("tool", program([]), ["run", "--help"]) == 0
    output = capsys.readouterr()
    assert output.err == ""
    for option in ("-m", "--mode", "-e", "--connect", "-l", "--listen", "--no-multicast-scouting", "--zenoh-config"):
        assert option in output.out
    assert output.out.isascii()


def test_version_is_the_installed_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app("tool", program([]), ["--version"]) == 0
    assert capsys.readouterr().out == f"tool {version('decklander')}\n"


def test_shell_completes_options(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("_TOOL_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "tool run --dr")
    monkeypatch.setenv("COMP_CWORD", "2")
    with pytest.raises(SystemExit):
        run_app("tool", program([]), [])
    assert capsys.readouterr().out == "--drone\n"


def test_completion_that_cannot_be_installed_is_one_line_and_exit_code_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def install(**_: object) -> None:
        raise PermissionError(13, "Permission denied", "/home/somebody/.bashrc")

    monkeypatch.setattr("typer.completion.install", install)
    assert run_app("tool", program([]), ["--install-completion"]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "/home/somebody/.bashrc cannot be written (Permission denied)" in told


def test_importing_the_command_line_loads_nothing_heavy() -> None:
    heavy = ("zenoh", "numpy", "numba", "scipy", "rosbags", "rich")
    code = f"import sys, link.program.cli; print([name for name in {heavy} if name in sys.modules])"
    started_s = time.monotonic()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert time.monotonic() - started_s < 5.0  # 0.1 s on an idle machine
