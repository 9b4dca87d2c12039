"""`ground-vehicle` with real partners over real Zenoh: gpsd itself, a serial line, TCP, a file, an autopilot."""

import os
import pty
import shutil
import signal
import socket
import subprocess
import sys
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import degrees, hypot, radians
from pathlib import Path
from typing import TypeVar

import pytest

from companion.vehicle.imu_inputs import imu_measurements
from companion.vehicle.inputs import fix_measurement, velocity_measurements
from companion.vehicle.unit_watch import UnitWatch
from link.frames.geodesy import Datum, LocalFrame, Projection
from link.frames.rotations import yaw_of
from link.messages import Fix, FixVelocity, PadGeometry, VehicleImu
from link.payloads import cdr, json_messages
from link.zenoh.keys import Keys
from link.zenoh.session import Inbox, ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_port, free_tcp_endpoint, free_udp_port
from tests.integration.programs import Program, Programs
from tests.scenarios.vehicle_sources.sentences import (
    ALTITUDE_M,
    LATITUDE_DEG,
    LONGITUDE_DEG,
    PERIOD_NS,
    SPEED_KNOTS,
    UTC_NS,
    drive,
    epoch,
)

pytestmark = pytest.mark.wire

KEYS = Keys()
DEADLINE_S = 60.0
PAD = ("--pad-size", "1.5", "1.2", "--pad-height", "1.6", "--antenna-to-pad", "0.8", "-0.1", "0.05")
DATUM = Datum(latitude_rad=radians(LATITUDE_DEG), longitude_rad=radians(LONGITUDE_DEG), altitude_m=ALTITUDE_M)
FRAME = LocalFrame(origin=DATUM, projection=Projection.TANGENT_PLANE)


class Vehicle:
    """A running `ground-vehicle` and what it has published."""

    def __init__(self, program: Program, session: ZenohSession, endpoint: str) -> None:
        self.program = program
        self.endpoint = endpoint
        self.session = session
        self.alive = session.watch_alive(KEYS.alive)
        self.fixes: list[Fix] = []
        self.velocities: list[FixVelocity] = []
        self.attitudes: list[VehicleImu] = []
        self._inboxes = [session.subscribe(key) for key in (KEYS.fix, KEYS.fix_velocity, KEYS.imu)]

    def until(self, condition: Callable[[], bool], feed: Callable[[], object] = lambda: None) -> None:
        end_s = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < end_s, f"the deadline has passed: {self.program.err.all}"
            feed()
            self.session.wake_up.wait(0.02)
            fixes, velocities, attitudes = self._inboxes
            self.fixes += decoded(Fix, fixes)
            self.velocities += decoded(FixVelocity, velocities)
            self.attitudes += decoded(VehicleImu, attitudes)


M = TypeVar("M", Fix, FixVelocity, VehicleImu)


def decoded(kind: type[M], inbox: Inbox) -> list[M]:
    return [cdr.decode(kind, sample.payload) for sample in inbox.take()]


@contextmanager
def vehicle(*arguments: str) -> Iterator[Vehicle]:
    endpoint = free_tcp_endpoint()
    with Programs() as programs:
        program = programs.start("ground-vehicle", *arguments, *PAD, "--listen", endpoint)
        with open_session(ZenohOptions(connect=(endpoint,))) as session:
            yield Vehicle(program, session, endpoint)


class Line:
    """A serial line: a pseudo terminal, into whose other end a receiver writes one instant after another."""

    def __init__(self) -> None:
        self._end, device = pty.openpty()
        tty.setraw(device)
        os.set_blocking(self._end, False)
        self._device = device
        self.name = os.ttyname(device)
        self._index = 0

    def say(self) -> None:
        try:
            os.write(self._end, b"".join(epoch(self._index)))
        except BlockingIOError:  # nobody reads it yet
            return
        self._index += 1

    def close(self) -> None:
        for descriptor in (self._end, self._device):
            os.close(descriptor)


@pytest.fixture
def line() -> Iterator[Line]:
    made = Line()
    yield made
    made.close()


def assert_is_the_drive(car: Vehicle) -> None:
    """Stamps, place, accuracy, velocity and heading as the companion takes them."""
    fix = car.fixes[-1]
    assert (fix.t_ns - UTC_NS) % PERIOD_NS == 0
    place = fix_measurement(fix, FRAME)
    assert place.value.tolist() == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)
    assert place.covariance[2, 2] == pytest.approx(0.040**2)
    assert place.covariance[0, 0] + place.covariance[1, 1] == pytest.approx(0.030**2 + 0.020**2)
    (velocity,) = velocity_measurements(car.velocities[-1], FRAME)
    assert hypot(*velocity.value[:2]) == pytest.approx(SPEED_KNOTS * 1852.0 / 3600.0, abs=1e-3)
    assert velocity.covariance[2, 2] > 100.0  # the vertical velocity was not measured
    (heading,) = imu_measurements(car.attitudes[-1], UnitWatch())
    assert degrees(heading.value[0]) == pytest.approx(90.0 - 77.6)


def test_a_receiver_on_a_serial_line_reaches_the_companion(
    line: Line, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(tmp_path / "notify"))
        manager.settimeout(DEADLINE_S)
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        with vehicle("--nmea", f"{line.name},9600") as car:
            see_the_drive(car, line)
        assert [manager.recv(1000) for _ in range(3)] == [
            f"STATUS=fixes from {line.name},9600".encode(),
            b"READY=1",
            b"STOPPING=1",
        ]


def see_the_drive(car: Vehicle, line: Line) -> None:
    """The drive, the pad and the token are there, and the program ends when it is told to."""
    car.until(lambda: len(car.fixes) > 4 and bool(car.attitudes) and bool(car.velocities), line.say)
    assert_is_the_drive(car)
    assert car.alive.alive
    (pad,) = car.session.query(KEYS.pad, b"", timeout_s=10.0)
    assert json_messages.decode(PadGeometry, pad) == PadGeometry(
        size_m=(1.5, 1.2), height_m=1.6, antenna_to_pad_m=(0.8, -0.1, 0.05)
    )
    car.program.send(signal.SIGTERM)
    assert car.program.wait() == 0


def test_gpsd_itself_is_read_and_found_again_after_its_restart(line: Line) -> None:
    gpsd = shutil.which("gpsd", path=os.environ.get("PATH", "") + ":/usr/sbin")
    if gpsd is None:
        pytest.skip("gpsd is not installed (Debian package gpsd)")
    port = free_port()

    def started() -> subprocess.Popen[bytes]:
        return subprocess.Popen([gpsd, "-N", "-n", "-S", str(port), line.name], stdin=subprocess.DEVNULL)

    with vehicle("--gpsd", f"127.0.0.1:{port}") as car:
        for _ in range(2):
            car.fixes.clear()
            with started() as daemon:
                try:
                    # the receiver's statement about its accuracy follows its first place
                    car.until(lambda: any(fix.covariance_enu_m2 for fix in car.fixes), line.say)
                    car.until(lambda: bool(car.attitudes) and bool(car.velocities), line.say)
                finally:
                    daemon.terminate()
            assert_is_the_drive(car)


def test_a_receiver_over_tcp_is_connected_to_again() -> None:
    instants = iter(range(10**6))
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(DEADLINE_S)
        with vehicle("--nmea", f"tcp://127.0.0.1:{server.getsockname()[1]}") as car:
            for _ in range(2):
                before, (connection, _) = len(car.fixes), server.accept()
                with connection:
                    car.until(
                        lambda: len(car.fixes) >= before + 4,  # noqa: B023 (called within this turn) (called before the next turn)
                        lambda: connection.sendall(b"".join(epoch(next(instants)))),  # noqa: B023 (called within this turn)
                    )
                    connection.sendall(epoch(0)[0][:30])  # it breaks off within a sentence
            assert_is_the_drive(car)


def test_a_recorded_file_is_told_at_its_own_pace_and_ends(tmp_path: Path) -> None:
    path = tmp_path / "drive.nmea"
    path.write_bytes(drive(40))
    with vehicle("--nmea", str(path)) as car:
        car.until(lambda: bool(car.fixes))
        arrived_s, first_ns = time.monotonic(), car.fixes[0].t_ns
        assert car.program.wait() == 0
        assert time.monotonic() - arrived_s > 1.0  # of eight seconds, however late a slow machine sees the first
        car.until(lambda: car.fixes[-1].t_ns - first_ns >= 2_000_000_000)


def test_a_file_that_holds_no_fix_is_told_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "drive.nmea"
    path.write_text("[pad]\nsize_m = [1.5, 1.5]\n", encoding="utf-8")
    with vehicle("--nmea", str(path)) as car:
        assert car.program.wait() == 2
        assert car.program.err.all[-1].endswith("holds no fix; name a recording of what a receiver sends")


def test_an_autopilot_s_receiver_reaches_the_companion() -> None:
    port = free_udp_port()
    with vehicle("--mavlink", f"udpin:127.0.0.1:{port}") as car, Programs() as programs:
        datum = ("--datum", "47.2", "8.5", "500")
        zenoh = ("--connect", car.endpoint)
        programs.start("sim-autopilot", "--mavlink", f"udpout:127.0.0.1:{port}", "--instant", *datum, *zenoh)
        car.until(lambda: len(car.fixes) >= 5 and bool(car.attitudes) and bool(car.velocities))
        fix = car.fixes[-1]
        assert (degrees(fix.latitude_rad), degrees(fix.longitude_rad)) == pytest.approx((47.2, 8.5), abs=1e-4)
        assert fix.altitude_m == pytest.approx(500.0, abs=5.0)
        assert abs(fix.t_ns * 1e-9 - time.time()) < 30.0  # the autopilot's UTC, not its time since boot
        assert fix.covariance_enu_m2 == pytest.approx((0.01**2, 0, 0, 0, 0.01**2, 0, 0, 0, 0.02**2))
        attitude = car.attitudes[-1].orientation_wxyz
        assert attitude is not None
        assert abs(yaw_of(attitude)) <= 3.2


def test_receivers_load_neither_simulation_nor_numerics() -> None:
    # The computer on the vehicle is a small one.
    modules = ", ".join(
        f"scenarios.vehicle_sources.{name}" for name in ("loop", "pad", "channel", "nmea", "gpsd", "mavlink")
    )
    heavy = '{"numba", "scipy", "polars", "matplotlib", "companion", "sim_autopilot", "scenarios.catalogue.catalogue"}'
    script = f"import sys, scenarios.commands.ground_vehicle, {modules}; sys.exit(bool({heavy} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", script], check=False, timeout=DEADLINE_S).returncode == 0
