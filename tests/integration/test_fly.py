"""`scenarios fly` beside the stand-in, which tells its truth as the firmware's own simulation does."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.firmware import fly as flying
from scenarios.firmware.fly import fly
from scenarios.firmware.options import FlyOptions
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from scenarios.sortie import score, script
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from tests.integration.programs import Programs

pytestmark = pytest.mark.wire

FAST = {"ardupilot": {"WPNAV_SPEED": 1600, "WPNAV_ACCEL": 500, "PSC_JERK_XY": 10}, "px4": {}}
"""Parameters with which a station is reached within its settling time; `companion check --launch` advises them."""


@contextmanager
def stand_in(firmware: str, instance: int) -> Iterator[tuple[str, str]]:
    """A simulated autopilot on the ground, and the devices of the companion and of an observer."""
    ports = free_udp_port(), free_udp_port()
    links = [word for port in ports for word in ("--mavlink", f"udpout:127.0.0.1:{port}")]
    changes = [word for name, value in FAST[firmware].items() for word in ("--set", f"parameters.{name}={value}")]
    with Programs() as programs:
        flags = ("--firmware", firmware, "--instance", str(instance), "--instant", "-e", free_tcp_endpoint())
        programs.start("sim-autopilot", *links, *flags, *changes)
        companion, observer = (f"udpin:127.0.0.1:{port}" for port in ports)
        yield companion, observer


@pytest.mark.parametrize(("firmware", "instance"), [("ardupilot", 0), ("px4", 6)])
def test_sortie_launches_from_a_pad_that_drives_off_and_lands_on_it(
    firmware: str, instance: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The firmwares' simulations measure from their feet, the stand-in from its centre of mass.
    monkeypatch.setitem(flying._RANGE_FINDER, "height_m", GEAR_HEIGHT_M)  # noqa: SLF001 (a fact of the simulator)
    monkeypatch.setattr(script, "HELD_S", 14.0)
    monkeypatch.setattr(score, "HELD_S", 14.0)
    monkeypatch.setattr(script, "_AWAY_M", 30.0)
    with stand_in(firmware, instance) as (companion, observer):
        options = FlyOptions(
            mavlink=companion, watch=observer, ship_speed_m_s=None, seed=1, folder=tmp_path, sortie=True
        )
        fly(load_scenario("straight_5"), options, lambda *_: None)
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    sortie = result["sortie"]
    assert (result["firmware"], result["ended"]) == (firmware, "secured"), result
    assert (sortie["contacts"], sortie["refused"]) == (0, 0)
    assert len(sortie["error_by_station_m"]) == 3
    assert sortie["error_max_m"] < 1.0
    assert sortie["return_from_m"] > 25.0
    assert result["horizontal_error_m"] < 0.5
    assert result["tier"] in {"S1", "S2", "S3"}
