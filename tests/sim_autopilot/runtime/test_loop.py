"""The real process over real UDP and Zenoh on loopback."""

import itertools
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import BodyTruth, PadGeometry, RotorTruth
from link.payloads import cdr, json_messages
from link.program.clock import ClockTick
from link.records import replace
from link.transports.opening import Transport, open_transport
from link.zenoh.keys import Keys
from link.zenoh.session import Inbox, ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from sim_autopilot.core.data import Deck
from sim_autopilot.runtime.config import VehicleConfig
from sim_autopilot.runtime.vehicle_view import VehicleView
from tests.sim_autopilot.pilot import arm, set_mode, setpoint

pytestmark = pytest.mark.wire

DEADLINE_S = 60.0
KEYS = Keys("loop_test")
PAD = PadGeometry(size_m=(1.5, 1.5), height_m=1.1, antenna_to_pad_m=(0.0, 0.0, 0.0), is_afloat=True)


def until(condition: Callable[[], bool]) -> None:
    """Wait until `condition`, which itself waits a little, holds."""
    end_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end_s, "the deadline has passed"


@contextmanager
def sim_autopilot(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "sim_autopilot", "--ns", KEYS.namespace, *arguments]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


class Companion:
    """Sockets of a companion, and the arguments that lead an autopilot to them."""

    def __init__(self, transport: Transport, port: int, zenoh: ZenohSession, endpoint: str) -> None:
        self.transport = transport
        self.zenoh = zenoh
        self.arguments = ("--mavlink", f"udpout:127.0.0.1:{port}", "-e", endpoint)
        self._codec = MavlinkCodec(1, 191)

    def receive(self) -> list[Message]:
        return self._codec.decode(self.transport.receive(0.05))

    def send(self, *messages: Message) -> None:
        self.transport.send(b"".join(map(self._codec.encode, messages)))

    def wait_for(self, name: str) -> Message:
        found: list[Message] = []

        def has_come() -> bool:
            found.extend(message for message in self.receive() if message.get_type() == name)
            return bool(found)

        until(has_come)
        return found[0]

    def samples(self, inbox: Inbox, count: int) -> list[tuple[int, bytes]]:
        """When received, ns on the wall clock, and what, of `count` samples in a row."""
        taken: list[tuple[int, bytes]] = []

        def are_enough() -> bool:
            self.zenoh.wake_up.wait(0.05)
            taken.extend((sample.received_ns, sample.payload) for sample in inbox.take())
            return len(taken) >= count

        until(are_enough)
        return taken


@pytest.fixture
def companion() -> Iterator[Companion]:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    with (
        open_transport(f"udpin:127.0.0.1:{port}") as transport,
        open_session(ZenohOptions(listen=(endpoint,))) as zenoh,
    ):
        yield Companion(transport, port, zenoh, endpoint)


def test_it_speaks_first_and_says_on_stderr_that_it_is_ready(companion: Companion) -> None:
    with sim_autopilot(*companion.arguments, "--instance", "2") as process:
        heartbeat = companion.wait_for("HEARTBEAT")
        assert (heartbeat.autopilot, heartbeat.get_srcSystem()) == (mavlink.MAV_AUTOPILOT_PX4, 3)
        assert process.stderr is not None
        assert "ready" in process.stderr.readline()


def test_a_signal_ends_it_with_nothing_left(companion: Companion) -> None:
    with sim_autopilot(*companion.arguments) as process:
        companion.wait_for("HEARTBEAT")
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=DEADLINE_S) == 0
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()


def test_it_answers_to_where_it_was_spoken_to_and_takes_off(companion: Companion) -> None:
    truths = companion.zenoh.subscribe(KEYS.drone_truth)
    above, commands = setpoint((0.0, 0.0, -3.0)), [set_mode(6), arm()]

    def is_up() -> bool:
        companion.receive()
        companion.send(above, *commands)
        return any(cdr.decode(BodyTruth, sample.payload).position_enu_m[2] > 2.0 for sample in truths.take())

    with sim_autopilot(*companion.arguments, "--instant", "--speed", "4"):
        companion.wait_for("HEARTBEAT")
        until(is_up)


@pytest.mark.alone
def test_speed_four_gives_four_simulated_seconds_a_second_in_steps_of_ten_milliseconds(companion: Companion) -> None:
    inbox = companion.zenoh.subscribe(KEYS.clock)
    with sim_autopilot(*companion.arguments, "--speed", "4"):
        companion.samples(inbox, 200)
        samples = companion.samples(inbox, 1200)
    times_ns = [cdr.decode(ClockTick, payload).t_ns for _, payload in samples]
    wall_ns = samples[-1][0] - samples[0][0]
    assert set(np.diff(times_ns).tolist()) == {10_000_000}
    assert (times_ns[-1] - times_ns[0]) / wall_ns == pytest.approx(4.0, rel=0.1)


@pytest.mark.alone
def test_speed_zero_runs_faster_than_any_clock(companion: Companion) -> None:
    inbox = companion.zenoh.subscribe(KEYS.clock)
    with sim_autopilot(*companion.arguments, "--speed", "0"):
        samples = companion.samples(inbox, 1000)
    (first_ns, first), (last_ns, last) = samples[0], samples[-1]
    simulated_ns = cdr.decode(ClockTick, last).t_ns - cdr.decode(ClockTick, first).t_ns
    assert simulated_ns > 2 * (last_ns - first_ns)


def test_truth_and_rotors_come_at_a_hundred_hertz(companion: Companion) -> None:
    truths, rotors = companion.zenoh.subscribe(KEYS.drone_truth), companion.zenoh.subscribe(KEYS.drone_rotors)
    with sim_autopilot(*companion.arguments, "--speed", "4"):
        bodies = [cdr.decode(BodyTruth, payload) for _, payload in companion.samples(truths, 200)]
        speeds = [cdr.decode(RotorTruth, payload) for _, payload in companion.samples(rotors, 200)]
    assert set(np.diff([body.t_ns for body in bodies]).tolist()) == {10_000_000}
    assert set(np.diff([speed.t_ns for speed in speeds]).tolist()) == {10_000_000}
    assert bodies[-1].position_enu_m[2] == pytest.approx(0.12, abs=0.01)
    assert speeds[-1].speed_rad_s == (0.0, 0.0, 0.0, 0.0)


def test_the_deck_has_the_vehicles_motion_and_its_pads_height(companion: Companion) -> None:
    truth = BodyTruth(
        t_ns=5_000_000_000,
        position_enu_m=(3.0, 4.0, 0.0),
        orientation_wxyz=(0.8, 0.0, 0.0, 0.6),
        velocity_flu_m_s=(5.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.1),
    )
    companion.zenoh.serve(KEYS.pad, lambda _query: json_messages.encode(PAD))
    endpoint = companion.arguments[-1]
    with open_session(ZenohOptions(connect=(endpoint,))) as session:
        view = VehicleView(session, KEYS, VehicleConfig())
        assert view.deck(truth.t_ns) is None
        times_ns = itertools.count(truth.t_ns, 50_000_000)  # an answer that is lost is asked for again after a second
        decks: list[Deck] = []

        def have_both_arrived() -> bool:
            t_ns = next(times_ns)
            companion.zenoh.publish(KEYS.vehicle_truth, b"garbage", cdr.encoding_of(BodyTruth))
            told = cdr.encode(replace(truth, t_ns=t_ns))
            companion.zenoh.publish(KEYS.vehicle_truth, told, cdr.encoding_of(BodyTruth))
            session.wake_up.wait(0.05)
            deck = view.deck(t_ns)
            decks.extend(() if deck is None or deck.roof_height_m != PAD.height_m else (deck,))
            return bool(decks) and view.bad_payloads > 0  # what is sent before the two are connected may be lost

        until(have_both_arrived)
        assert decks[0].is_afloat
        assert np.allclose(decks[0].velocity_enu_m_s, (5.0 * 0.28, 5.0 * 0.96, 0.0))
        assert np.allclose(decks[0].angular_velocity_enu_rad_s, (0.0, 0.0, 0.1))
        assert view.deck(next(times_ns) + 2_000_000_000) is None


def test_help_loads_no_numerics() -> None:
    program = (
        "import sys; from link.program.cli import run_app; from sim_autopilot.app import app; "
        "run_app('sim-autopilot', app, ['--help']); print({'numpy', 'numba', 'zenoh', 'pymavlink'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "--mavlink" in done.stdout
    assert done.stdout.strip().endswith("set()")
