"""The `pad-detector` program over real Zenoh on loopback: pictures in, poses of the pad out."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from companion.eyes.board import load_board
from companion.eyes.calibration import dump_calibration
from companion.eyes.picture import WholePicture
from link.messages import CameraImage, PadSighting
from link.payloads import cdr
from link.program.toml_config import dump_toml
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.camera.lens import CAMERA
from scenarios.processes.programs import free_tcp_endpoint
from scenarios.simulation.camera_scene import MOUNTING
from tests.companion.eyes.frames import case

KEYS = Keys()
DEADLINE_S = 30.0
GARBAGE = (b"", b"\x00\x01\x00\x00" + bytes(range(256)) * 40, b"no picture at all")


@pytest.mark.wire
def test_pictures_on_zenoh_become_poses_of_the_pad_and_garbage_stops_nothing(tmp_path: Path) -> None:
    (tmp_path / "camera.yaml").write_text(dump_calibration(CAMERA), encoding="utf-8")
    (tmp_path / "mounting.toml").write_text(dump_toml(MOUNTING), encoding="utf-8")
    one = case(4.0, board=load_board(None).config)
    assert isinstance(one.frame.picture, WholePicture)
    height_px, width_px = one.frame.picture.shades.shape
    endpoint = free_tcp_endpoint()
    command = [sys.executable, "-m", "companion.eyes", "run", "--source", "zenoh", "-e", endpoint]
    files = ["--calibration", str(tmp_path / "camera.yaml"), "--mounting", str(tmp_path / "mounting.toml")]
    with open_session(ZenohOptions(listen=(endpoint,))) as zenoh, subprocess.Popen([*command, *files]) as program:
        poses = zenoh.subscribe(KEYS.pad_pose)
        deadline_s = time.monotonic() + DEADLINE_S
        while not (samples := poses.take()) and time.monotonic() < deadline_s:
            for payload in GARBAGE:
                zenoh.publish(KEYS.camera_image, payload, cdr.encoding_of(CameraImage))
                zenoh.publish(KEYS.camera_compressed, payload, "application/cdr")
                zenoh.publish(KEYS.record("own"), payload, "application/cdr")
            image = CameraImage(
                t_ns=one.frame.t_ns,
                width_px=width_px,
                height_px=height_px,
                encoding="mono8",
                row_bytes=width_px,
                data=one.frame.picture.shades.tobytes(),
            )
            zenoh.publish(KEYS.camera_image, cdr.encode(image), cdr.encoding_of(CameraImage))
            zenoh.wake_up.wait(0.2)
        program.send_signal(signal.SIGINT)
        assert program.wait(DEADLINE_S) == 0
    sighting = cdr.decode(PadSighting, samples[0].payload)
    assert sighting.t_ns == one.frame.t_ns
    assert sighting.position_flu_m == pytest.approx(one.away_flu_m.tolist(), abs=0.1)
