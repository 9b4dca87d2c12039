"""`companion check` over UDP and Zenoh against the simulated autopilot and a vehicle."""

import json
from pathlib import Path
from typing import Any

import pytest

from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import Programs

pytestmark = pytest.mark.wire

AMISS_AT_10_M_S = {"MPC_Z_VEL_MAX_DN", "LNDMC_XY_VEL_MAX", "COM_RC_OVERRIDE"}


def parameters(result: dict[str, Any]) -> dict[str, str]:
    return {one["name"]: one["level"] for one in result["findings"] if "_" in one["name"]}


def test_check_names_what_must_change_sets_it_and_puts_it_back(tmp_path: Path) -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    before = tmp_path / "before.json"
    with Programs(tmp_path) as programs:
        world = programs.start(
            "scenarios", "world", "straight_5", "--mavlink", f"udpout:127.0.0.1:{port}", "-l", endpoint
        )
        world.err.wait_for("ready")

        def check(*arguments: str, speed: str = "10") -> tuple[int, list[str]]:
            link = ("--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint, "--speed-max", speed)
            program = programs.start("companion", "check", *link, "--duration", "2", *arguments)
            return program.wait(), program.out.all

        _, lines = check("--json", "--write", "--yes", "--keep", str(before))
        anew = json.loads("\n".join(lines))
        assert set(parameters(anew).values()) == {"pass"}
        assert {"vehicle fixes", "vehicle age", "vehicle pad"} <= {one["name"] for one in anew["findings"]}
        assert set(json.loads(before.read_text())) == AMISS_AT_10_M_S

        code, _ = check("--restore", str(before))
        assert code == 0
        code, lines = check("--json", speed="15")
        worse = json.loads("\n".join(lines))
        assert code == 1
        assert parameters(worse)["MPC_TILTMAX_AIR"] == "fail"
        assert parameters(worse)["COM_RC_OVERRIDE"] == "warn"
