"""The vehicle's node without I/O, and the `ground-vehicle` program over real Zenoh on loopback."""

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from link.frames.geodesy import enu_from_geodetic
from link.messages import BodyTruth, Fix, FixVelocity, PadGeometry, PadSighting, VehicleImu
from link.payloads import cdr, json_messages
from link.program.clock import ClockTick
from link.zenoh.keys import Keys, Publication
from link.zenoh.session import Sample, ZenohOptions, ZenohSession, open_session
from scenarios.catalogue.catalogue import load_scenario
from scenarios.processes.programs import free_tcp_endpoint
from scenarios.simulation.vehicle_node import VehicleNode, datum_of, departing_at_once
from tests.link.zenoh.waiting import DEADLINE_S, until

START_NS = 1_800_000_000_000_000_000
STEP_NS = 10_000_000
KEYS = Keys()


def hovering(t_ns: int) -> BodyTruth:
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=(0.0, 0.0, 5.0),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=(0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def published(node: VehicleNode, duration_s: float, step_ns: int = STEP_NS) -> list[Publication]:
    times_ns = range(START_NS, START_NS + round(duration_s * 1e9), step_ns)
    return [publication for t_ns in times_ns for publication in node.step(t_ns, hovering(t_ns))]


def on_key(publications: list[Publication], key: str) -> list[Publication]:
    return [publication for publication in publications if publication.key == key]


def test_demo_publishes_truth_at_100_hz_and_its_receiver_at_10_hz() -> None:
    publications = published(VehicleNode(load_scenario("straight_5"), 1, KEYS), 10.0)
    counts = {key: len(on_key(publications, key)) for key in {publication.key for publication in publications}}
    assert counts == {KEYS.vehicle_truth: 1000, KEYS.fix: 100, KEYS.fix_velocity: 100}


def test_leaving_out_the_truth_changes_nothing_else() -> None:
    scenario = load_scenario("circle_5+sensors=nominal")
    with_truth = published(VehicleNode(scenario, 1, KEYS), 4.0)
    without = published(VehicleNode(scenario, 1, KEYS, publishes_truth=False), 4.0)
    assert without == [publication for publication in with_truth if publication.key != KEYS.vehicle_truth]


def test_nominal_sensors_publish_on_every_key_of_the_contract() -> None:
    publications = published(VehicleNode(load_scenario("straight_5+sensors=nominal"), 1, KEYS), 12.0)
    kinds: dict[str, type[cdr.Message]] = {
        KEYS.imu: VehicleImu,
        KEYS.pad_pose: PadSighting,
        KEYS.fix: Fix,
        KEYS.fix_velocity: FixVelocity,
    }
    for key, kind in kinds.items():
        encodings = {publication.encoding for publication in on_key(publications, key)}
        assert encodings == {cdr.encoding_of(kind)}


@pytest.mark.parametrize("step_ns", [4_000_000, 10_000_000])
def test_truth_keeps_its_rate_whatever_the_step(step_ns: int) -> None:
    publications = published(VehicleNode(load_scenario("straight_5"), 1, KEYS), 4.0, step_ns)
    assert len(on_key(publications, KEYS.vehicle_truth)) == pytest.approx(400, abs=2)


def test_fixes_lie_on_the_vehicles_antenna() -> None:
    scenario = load_scenario("straight_5")
    publications = published(VehicleNode(scenario, 1, KEYS), 14.0)
    fixes = [cdr.decode(Fix, publication.payload) for publication in on_key(publications, KEYS.fix)]
    truths = [cdr.decode(BodyTruth, publication.payload) for publication in on_key(publications, KEYS.vehicle_truth)]
    position_at = {truth.t_ns: truth.position_enu_m for truth in truths}
    for fix in fixes:
        x_m, y_m, z_m = enu_from_geodetic(
            datum_of(scenario.run.datum), fix.latitude_rad, fix.longitude_rad, fix.altitude_m
        )
        centre_m = position_at[fix.t_ns]
        errors_m = (x_m + 1.2 - centre_m[0], y_m - 0.5 - centre_m[1], z_m - 1.6 - centre_m[2])
        assert max(map(abs, errors_m)) < 0.1  # five standard deviations


def test_time_that_does_not_advance_publishes_nothing() -> None:
    node = VehicleNode(load_scenario("straight_5"), 1, KEYS)
    assert node.step(START_NS, None)
    assert node.step(START_NS, None) == []
    assert node.step(START_NS - STEP_NS, None) == []


@pytest.mark.slow
def test_same_seed_publishes_the_same_bytes() -> None:
    scenario = load_scenario("random_5+sensors=degraded")
    runs = [published(VehicleNode(scenario, seed, KEYS), 3.0) for seed in (6, 6, 7)]
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


def test_vehicle_departs_at_once_when_told_to() -> None:
    node = VehicleNode(departing_at_once(load_scenario("straight_5")), 1, KEYS)
    for step in range(300):
        node.step(START_NS + step * STEP_NS, None)
    assert node.state is not None
    assert node.state.velocity_enu_m_s[0] > 3.0


@contextmanager
def program(*arguments: str) -> Iterator[tuple[subprocess.Popen[bytes], ZenohSession]]:
    """Start `ground-vehicle` and give it with a session that is connected to it."""
    endpoint = free_tcp_endpoint()
    command = [sys.executable, "-m", "scenarios.ground_vehicle", "--listen", endpoint, *arguments]
    with subprocess.Popen(command) as process:
        try:
            with open_session(ZenohOptions(connect=(endpoint,))) as session:
                yield process, session
        finally:
            process.kill()


@pytest.mark.wire
def test_program_publishes_shows_that_it_lives_and_tells_its_pad() -> None:
    with program("--scenario", "straight_5", "--depart-at-once") as (process, session):
        alive = session.watch_alive(KEYS.alive)
        fixes, truths = session.subscribe(KEYS.fix), session.subscribe(KEYS.vehicle_truth)
        received: list[Sample] = []

        def has_fixes() -> bool:
            received.extend(fixes.take())
            return len(received) >= 5

        until(session, has_fixes)
        until(session, lambda: bool(truths.take()))
        assert alive.alive
        pads = session.query(KEYS.pad, b"", timeout_s=5.0)
        assert [json_messages.decode(PadGeometry, pad) for pad in pads] == [load_scenario("straight_5").vehicle.pad]
        stamps_ns = [cdr.decode(Fix, sample.payload).t_ns for sample in received]
        assert abs(stamps_ns[-1] * 1e-9 - time.time()) < 5.0
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=DEADLINE_S) == 0
        until(session, lambda: not alive.alive)


@pytest.mark.wire
def test_program_follows_the_simulated_clock_and_the_drone() -> None:
    with program("--scenario", "straight_5", "--use-sim-time") as (_, session):
        truths = session.subscribe(KEYS.vehicle_truth)
        received: list[BodyTruth] = []
        t_ns = START_NS

        def has_departed() -> bool:
            nonlocal t_ns
            t_ns += STEP_NS
            drone, tick = hovering(t_ns), ClockTick(t_ns=t_ns)
            session.publish(KEYS.drone_truth, cdr.encode(drone), cdr.encoding_of(BodyTruth))
            session.publish(KEYS.clock, cdr.encode(tick), cdr.encoding_of(ClockTick))
            received.extend(cdr.decode(BodyTruth, sample.payload) for sample in truths.take())
            return bool(received) and received[-1].velocity_flu_m_s[0] > 0.5

        until(session, has_departed)
        assert all(START_NS < truth.t_ns <= t_ns and truth.t_ns % STEP_NS == 0 for truth in received)


@pytest.mark.wire
def test_program_that_hears_no_clock_says_so() -> None:
    command = [sys.executable, "-m", "scenarios.ground_vehicle", "--scenario", "static", "--use-sim-time"]
    ended = subprocess.run(
        [*command, "--timeout", "0.3", "--listen", "tcp/127.0.0.1:0"],
        capture_output=True,
        check=False,
        timeout=DEADLINE_S,
    )
    assert ended.returncode == 2
    assert b"no simulated clock on decklander/clock" in ended.stderr
