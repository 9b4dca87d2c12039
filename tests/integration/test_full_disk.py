"""A disk that takes nothing more: the companion says so; it and what runs beside it go on and end as ever."""

import resource
import signal
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

from companion.eyes.board import load_board
from companion.eyes.calibration import dump_calibration
from companion.eyes.picture import WholePicture
from link.messages import Command, Order
from link.program.toml_config import dump_toml
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions
from scenarios.camera.lens import CAMERA
from scenarios.commands.operator import send_order
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from scenarios.simulation.camera_scene import MOUNTING
from tests.companion.eyes.frames import case
from tests.integration.programs import DEADLINE_S, Programs
from tests.scenarios.vehicle_sources.sentences import drive

pytestmark = pytest.mark.wire


def test_recording_that_cannot_be_written_is_told_while_it_is_so_and_ends_nothing(tmp_path: Path) -> None:
    device, endpoint = f"127.0.0.1:{free_udp_port()}", free_tcp_endpoint()
    with Programs(tmp_path) as programs:
        programs.start("sim-autopilot", "--mavlink", f"udpout:{device}", "-l", endpoint).err.wait_for("ready")
        told = ("--record", "flight", "--tlog", "flight/flight.tlog", "--timing", "timing.json")
        companion = programs.start("companion", "--mavlink", f"udpin:{device}", "-e", endpoint, "--timeout", "0", *told)
        companion.out.wait_for("autopilot found")
        resource.prlimit(companion.pid, resource.RLIMIT_FSIZE, (0, 0))
        companion.out.wait_for("records are lost")
        reply = send_order(Order(command=Command.ABORT), Keys(), ZenohOptions(connect=(endpoint,)))
        assert "nothing to abort" in reply.reason
        companion.send(signal.SIGINT)
        assert companion.wait() == 0
        assert any("records are lost, flight: File too large" in line for line in companion.told)
        assert not any("Traceback" in line for line in companion.err.all)


def exit_code_with_its_lines_on_a_full_disk(module: str, *arguments: str) -> int:
    command = [sys.executable, "-m", module, *arguments]
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        return subprocess.run(command, stdout=full, check=False, timeout=DEADLINE_S).returncode


def test_vehicle_whose_lines_cannot_be_written_goes_on(tmp_path: Path) -> None:
    (tmp_path / "drive.nmea").write_bytes(drive(5))
    pad = ("--pad-size", "1.5", "1.2", "--pad-height", "1.6", "--antenna-to-pad", "0.8", "-0.1", "0.05")
    told = ("--nmea", str(tmp_path / "drive.nmea"), "--listen", "tcp/127.0.0.1:0")
    assert exit_code_with_its_lines_on_a_full_disk("scenarios.ground_vehicle", *told, *pad) == 0


def test_detector_whose_lines_cannot_be_written_goes_on(tmp_path: Path) -> None:
    (tmp_path / "camera.yaml").write_text(dump_calibration(CAMERA), encoding="utf-8")
    (tmp_path / "mounting.toml").write_text(dump_toml(MOUNTING), encoding="utf-8")
    picture = case(4.0, board=load_board(None).config).frame.picture
    assert isinstance(picture, WholePicture)
    assert cv2.imwrite(str(tmp_path / "1.png"), picture.shades)
    files = ("--calibration", str(tmp_path / "camera.yaml"), "--mounting", str(tmp_path / "mounting.toml"))
    told = ("run", "--source", str(tmp_path), *files)
    assert exit_code_with_its_lines_on_a_full_disk("companion.eyes", *told) == 0
