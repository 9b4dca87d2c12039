"""The programs under a service manager: its unit files fit them, and they tell it what it waits for."""

import re
import shlex
import shutil
import socket
import subprocess
from pathlib import Path

import pytest
import typer
from typer.main import get_command

from companion.app import app as companion_app
from scenarios.commands.ground_vehicle import app as vehicle_app
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import DEADLINE_S, Programs

FOLDER = Path(__file__).parents[2] / "docs" / "systemd"
APPS: dict[str, typer.Typer] = {"companion": companion_app, "ground-vehicle": vehicle_app}
UNITS = sorted(path.name for path in FOLDER.glob("*.service"))


def value(unit: str, key: str) -> str:
    found = re.findall(rf"^{key}=(.*)$", (FOLDER / unit).read_text(encoding="utf-8"), re.MULTILINE)
    assert len(found) == 1, f"{unit} has {key} {len(found)} times"
    return str(found[0])


def test_each_program_that_runs_for_real_has_its_unit() -> None:
    assert {Path(shlex.split(value(unit, "ExecStart"))[0]).name for unit in UNITS} == set(APPS)


@pytest.mark.parametrize("unit", UNITS)
def test_a_units_command_line_is_one_that_the_program_takes(unit: str) -> None:
    program, *arguments = shlex.split(value(unit, "ExecStart"))
    context = get_command(APPS[Path(program).name]).make_context(program, arguments)
    assert "--start" not in arguments  # started again in flight, it must not act by itself
    assert context.params["vehicle"] == "car"


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_restarts_and_watches_its_program(unit: str) -> None:
    assert (value(unit, "Type"), value(unit, "Restart")) == ("notify", "on-failure")
    assert int(value(unit, "WatchdogSec")) > 0
    assert value(unit, "TimeoutStartSec") == "infinity"


def test_the_companion_keeps_machine_code_where_its_user_may_write_and_its_installation_compiles_there() -> None:
    unit = "decklander-companion.service"
    variable, _, folder = value(unit, "Environment").partition("=")
    assert variable == "NUMBA_CACHE_DIR"
    assert Path(folder).parent == Path("/var/lib") / value(unit, "StateDirectory")
    installation = (FOLDER.parent / "safety.md").read_text(encoding="utf-8")
    user = value(unit, "User")
    assert f"sudo -u {user} env NUMBA_CACHE_DIR={folder} .venv/bin/python -m scenarios.lockstep.warm_up" in installation


@pytest.mark.wire
@pytest.mark.parametrize("unit", UNITS)
def test_systemd_itself_finds_no_mistake_in_a_unit(unit: str, tmp_path: Path) -> None:
    analyze = shutil.which("systemd-analyze")
    if analyze is None:
        pytest.skip("systemd-analyze is not installed")
    text = (FOLDER / unit).read_text(encoding="utf-8")
    copy = tmp_path / unit
    copy.write_text(re.sub(r"ExecStart=\S+", "ExecStart=/bin/true", text), encoding="utf-8")
    checked = subprocess.run([analyze, "verify", str(copy)], capture_output=True, text=True, check=False, timeout=60)
    about_it = [line for line in checked.stderr.splitlines() if unit in line and "Cannot add dependency" not in line]
    assert about_it == []


@pytest.mark.wire
def test_the_companion_is_ready_with_its_autopilot_and_feeds_the_watchdog(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager, Programs() as programs:
        manager.bind(str(tmp_path / "notify"))
        manager.settimeout(DEADLINE_S)
        with monkeypatch.context() as environment:
            environment.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
            environment.setenv("WATCHDOG_USEC", "500000")
            companion = programs.start("companion", "--mavlink", f"udpin:127.0.0.1:{port}", "-l", endpoint)
        assert manager.recv(1000) == b"WATCHDOG=1"
        programs.start("sim-autopilot", "--mavlink", f"udpout:127.0.0.1:{port}", "--instant", "-e", endpoint)
        received = [manager.recv(1000)]
        while received[-1] != b"READY=1":
            received.append(manager.recv(1000))
        companion.out.wait_for("autopilot found")
        fed = 0
        while fed < 3:
            fed += manager.recv(1000) == b"WATCHDOG=1"
