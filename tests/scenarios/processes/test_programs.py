"""Ports that programs of a run are told before they listen there."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from scenarios.processes.programs import free_tcp_endpoint, reserve_tcp_port

RESERVE = (
    "import sys; from scenarios.processes.programs import reserve_tcp_port; print(reserve_tcp_port(int(sys.argv[1])))"
)


def _reserved_elsewhere(port: int) -> int:
    answer = subprocess.run([sys.executable, "-c", RESERVE, str(port)], capture_output=True, text=True, check=True)
    return int(answer.stdout)


@pytest.fixture
def locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TMPDIR", os.fspath(tmp_path))
    monkeypatch.setattr("scenarios.processes.programs.gettempdir", lambda: os.fspath(tmp_path))
    return tmp_path


@pytest.mark.usefixtures("locks")
def test_port_of_one_process_is_no_other_ones_until_it_listens() -> None:
    port = int(free_tcp_endpoint().rpartition(":")[2])
    assert _reserved_elsewhere(port) == port  # and free again: that process has ended
    assert reserve_tcp_port(port) == port
    assert _reserved_elsewhere(port) != port


@pytest.mark.usefixtures("locks")
def test_port_where_somebody_listens_is_not_taken() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert reserve_tcp_port(taken.getsockname()[1]) != taken.getsockname()[1]
