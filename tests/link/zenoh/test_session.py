"""Two and three real Zenoh sessions on loopback: samples, queries, liveliness, late starts and users' mistakes."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from link.errors import UserError
from link.zenoh.session import Inbox, Sample, ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_tcp_endpoint
from tests.link.zenoh.waiting import until

JSON = "application/json"


def listener(endpoint: str) -> ZenohSession:
    return open_session(ZenohOptions(listen=(endpoint,)))


def connector(endpoint: str) -> ZenohSession:
    return open_session(ZenohOptions(connect=(endpoint,)))


def peer_count(session: ZenohSession) -> int:
    """Return how many other sessions it is connected to."""
    info = session._session.info  # noqa: SLF001 (nobody but these tests wants to know)
    return len(info.peers_zid()) + len(info.routers_zid())


def first_samples(sender: ZenohSession, receiver: ZenohSession, inbox: Inbox, key: str) -> list[Sample]:
    """Send until the subscription is known to `sender`, and return what came first."""
    samples: list[Sample] = []

    def has_come() -> bool:
        sender.publish(key, b"probe", JSON)
        samples.extend(inbox.take())
        return bool(samples)

    until(receiver, has_come)
    return samples


@pytest.fixture
def endpoint() -> str:
    return free_tcp_endpoint()


@pytest.fixture
def pair(endpoint: str) -> Iterator[tuple[ZenohSession, ZenohSession]]:
    """A listening session and one that is connected to it."""
    with listener(endpoint) as near, connector(endpoint) as far:
        until(near, lambda: peer_count(near) == 1 and peer_count(far) == 1)
        yield near, far


def test_samples_arrive_complete_and_in_order(pair: tuple[ZenohSession, ZenohSession]) -> None:
    sender, receiver = pair
    inbox = receiver.subscribe("ns/vehicle/*")
    first_samples(sender, receiver, inbox, "ns/vehicle/fix")
    payloads = [number.to_bytes(4, "little") * 100 for number in range(500)]
    for payload in payloads:
        sender.publish("ns/vehicle/fix", payload, "application/cdr;sensor_msgs/msg/NavSatFix")
    received: list[bytes] = []

    def all_have_come() -> bool:
        received.extend(sample.payload for sample in inbox.take() if sample.payload != b"probe")
        return len(received) >= len(payloads)

    until(receiver, all_have_come)
    assert received == payloads
    assert inbox.dropped == 0


def test_a_sample_that_is_larger_than_it_may_be_comes_as_an_empty_one(
    pair: tuple[ZenohSession, ZenohSession],
) -> None:
    sender, receiver = pair
    inbox = receiver.subscribe("ns/vehicle/*", sample_bytes_max=8)
    first_samples(sender, receiver, inbox, "ns/vehicle/fix")
    for size in (9, 8):
        sender.publish("ns/vehicle/fix", b"x" * size, "application/cdr;sensor_msgs/msg/NavSatFix")
    received: list[bytes] = []

    def both_have_come() -> bool:
        received.extend(sample.payload for sample in inbox.take() if sample.payload != b"probe")
        return len(received) >= 2

    until(receiver, both_have_come)
    assert received == [b"", b"x" * 8]


def test_sample_knows_its_key_and_when_it_came(endpoint: str) -> None:
    with (
        listener(endpoint) as sender,
        open_session(ZenohOptions(connect=(endpoint,)), receive_clock_ns=lambda: 42) as receiver,
    ):
        inbox = receiver.subscribe("ns/**")
        assert first_samples(sender, receiver, inbox, "ns/drone/truth/rotors")[0] == Sample(
            "ns/drone/truth/rotors", b"probe", 42
        )


def test_liveliness_tells_of_coming_and_going(endpoint: str) -> None:
    with listener(endpoint) as companion:
        watched = companion.watch_alive("ns/vehicle/alive")
        was_alive_before = watched.alive
        with connector(endpoint) as vehicle:
            vehicle.declare_alive("ns/vehicle/alive")
            until(companion, lambda: watched.alive)
        until(companion, lambda: not watched.alive)
        assert not was_alive_before


def test_liveliness_of_who_came_earlier_is_seen(pair: tuple[ZenohSession, ZenohSession]) -> None:
    vehicle, companion = pair
    vehicle.declare_alive("ns/vehicle/alive")
    before = companion.watch_alive("ns/vehicle/alive")
    until(companion, lambda: before.alive)
    after = companion.watch_alive("ns/vehicle/alive")
    until(companion, lambda: after.alive)


def test_liveliness_notices_a_killed_process(endpoint: str) -> None:
    code = (
        "import sys, threading; from link.zenoh.session import *; "
        f"s = open_session(ZenohOptions(connect=({endpoint!r},))); s.declare_alive('ns/vehicle/alive'); "
        "threading.Event().wait()"
    )
    with listener(endpoint) as companion, subprocess.Popen([sys.executable, "-c", code]) as vehicle:
        watched = companion.watch_alive("ns/vehicle/alive")
        try:
            until(companion, lambda: watched.alive)
        finally:
            vehicle.kill()
        until(companion, lambda: not watched.alive)


@pytest.mark.wire
@pytest.mark.alone
def test_a_peer_that_hangs_does_not_stall_the_sender(endpoint: str) -> None:
    code = (
        "import threading; from link.zenoh.session import *; "
        f"s = open_session(ZenohOptions(connect=({endpoint!r},))); s.subscribe('ns/x'); "
        "s.declare_alive('ns/dashboard'); "
        "threading.Event().wait()"
    )
    with listener(endpoint) as sender, subprocess.Popen([sys.executable, "-c", code]) as dashboard:
        watched = sender.watch_alive("ns/dashboard")
        longest_s = 0.0
        try:
            until(sender, lambda: watched.alive)
            dashboard.send_signal(signal.SIGSTOP)
            for _ in range(20_000):
                started_s = time.perf_counter()
                sender.publish("ns/x", bytes(700), JSON)
                longest_s = max(longest_s, time.perf_counter() - started_s)
        finally:
            dashboard.kill()
        assert 0.1 < longest_s < 2.0  # it was waited for, for about 0.2 s; the library's own limit is 5 s


def test_query_is_answered(pair: tuple[ZenohSession, ZenohSession]) -> None:
    vehicle, companion = pair
    vehicle.serve("ns/vehicle/pad", lambda payload: payload.upper())
    answers: list[bytes] = []

    def is_answered() -> bool:
        answers.extend(companion.query("ns/vehicle/pad", b"size", 5.0))
        return bool(answers)

    until(companion, is_answered)
    assert answers == [b"SIZE"]


def test_ask_does_not_wait_for_the_answer(pair: tuple[ZenohSession, ZenohSession]) -> None:
    vehicle, companion = pair
    vehicle.serve("ns/vehicle/pad", lambda payload: payload + b"!")
    until(companion, lambda: bool(companion.query("ns/vehicle/pad", b"", 5.0)))
    inbox = companion.ask("ns/vehicle/pad", b"size", 5.0)
    answers: list[Sample] = []

    def is_answered() -> bool:
        answers.extend(inbox.take())
        return bool(answers)

    until(companion, is_answered)
    assert (answers[0].key, answers[0].payload) == ("ns/vehicle/pad", b"size!")


def test_all_who_serve_a_key_are_heard(endpoint: str) -> None:
    """The library hands on the last answer alone unless it is told otherwise."""
    by_it = ZenohOptions(mode="client", connect=(endpoint,))
    with (
        open_session(ZenohOptions(listen=(endpoint,))) as vehicle,
        open_session(by_it) as liar,
        open_session(by_it) as companion,
    ):
        vehicle.serve("ns/vehicle/pad", lambda _: b"true")
        liar.serve("ns/vehicle/pad", lambda _: b"false")
        until(companion, lambda: len(companion.query("ns/vehicle/pad", b"", 5.0)) == 2)
        assert sorted(companion.query("ns/vehicle/pad", b"", 5.0)) == [b"false", b"true"]
        inbox = companion.ask("ns/vehicle/pad", b"", 5.0)
        answers: list[bytes] = []

        def are_answered() -> bool:
            answers.extend(one.payload for one in inbox.take())
            return len(answers) == 2

        until(companion, are_answered)
        assert sorted(answers) == [b"false", b"true"]


def test_query_that_nobody_serves_has_no_answers(pair: tuple[ZenohSession, ZenohSession]) -> None:
    assert pair[0].query("ns/nobody/pad", b"", 5.0) == []


def test_query_whose_handler_refuses_has_no_answers_and_others_go_on(
    pair: tuple[ZenohSession, ZenohSession], capfd: pytest.CaptureFixture[str]
) -> None:
    vehicle, companion = pair

    def handler(payload: bytes) -> bytes:
        if payload == b"bad":
            raise ValueError("no such command")
        return b"ok"

    vehicle.serve("ns/drone/landing/command", handler)
    until(companion, lambda: bool(companion.query("ns/drone/landing/command", b"", 5.0)))
    assert companion.query("ns/drone/landing/command", b"bad", 5.0) == []
    assert companion.query("ns/drone/landing/command", b"good", 5.0) == [b"ok"]
    assert capfd.readouterr().err == ""


@pytest.mark.wire
def test_the_one_to_connect_may_start_first(endpoint: str) -> None:
    with connector(endpoint) as receiver:
        inbox = receiver.subscribe("ns/late")
        assert peer_count(receiver) == 0
        with listener(endpoint) as sender:
            assert first_samples(sender, receiver, inbox, "ns/late")[0].payload == b"probe"


@pytest.mark.wire
def test_samples_flow_again_after_a_restart(endpoint: str) -> None:
    with connector(endpoint) as receiver:
        inbox = receiver.subscribe("ns/restart")
        for _ in range(2):
            with listener(endpoint) as sender:
                assert first_samples(sender, receiver, inbox, "ns/restart")
            until(receiver, lambda: peer_count(receiver) == 0)
            inbox.take()


def test_two_that_meet_at_a_third_find_each_other_and_stay_when_it_leaves(endpoint: str) -> None:
    with ExitStack() as stack:
        hub = listener(endpoint)
        stack.callback(hub.close)
        one, other = stack.enter_context(connector(endpoint)), stack.enter_context(connector(endpoint))
        until(one, lambda: peer_count(one) == 2 and peer_count(other) == 2)
        inbox = one.subscribe("ns/gossip")
        hub.close()
        until(one, lambda: peer_count(one) == 1)
        assert first_samples(other, one, inbox, "ns/gossip")


def test_a_client_talks_through_a_router(endpoint: str) -> None:
    def client() -> ZenohSession:
        return open_session(ZenohOptions(mode="client", connect=(endpoint,)))

    with open_session(ZenohOptions(mode="router", listen=(endpoint,))), client() as sender, client() as receiver:
        inbox = receiver.subscribe("ns/routed")
        assert first_samples(sender, receiver, inbox, "ns/routed")


def test_closing_twice_does_nothing(endpoint: str) -> None:
    session = listener(endpoint)
    session.close()
    session.close()
    session.publish("ns/x", b"", JSON)
    assert session.unpublished == 1


def test_port_in_use_is_the_users_mistake(endpoint: str) -> None:
    with listener(endpoint), pytest.raises(UserError, match=f"--listen {endpoint}: the port is in use"):
        listener(endpoint)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"mode": "pear"}, "--mode 'pear' does not exist: choose peer, client, router"),
        ({"connect": ("192.168.4.1",)}, "--connect '192.168.4.1' is no endpoint: write it as tls/192.168.4.1:7447"),
        ({"connect": ("127.0.0.1:7447",)}, "--connect '127.0.0.1:7447' is no endpoint: write it as tcp/127.0.0.1:7447"),
        ({"connect": ("tcp/127.0.0.1",)}, "needs a host and a port from 1 to 65535"),
        ({"listen": ("tcp/127.0.0.1:65536",)}, "--listen 'tcp/127.0.0.1:65536' needs a host and a port from 0"),
        ({"mode": "client"}, "add --connect tcp/127.0.0.1:7447"),
    ],
)
def test_mistyped_options_are_the_users_mistake(options: dict[str, object], expected: str) -> None:
    with pytest.raises(UserError) as caught:
        open_session(ZenohOptions(**options))  # type: ignore[arg-type]  # one test for all fields
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp/[::1]:7447",
        "udp/host.example:1",
        "tls/a-b:65535",
        "tcp/0.0.0.0:7447#iface=lo",
        "serial//dev/ttyS0",
        "quic/x:9",
    ],
)
def test_endpoints_of_every_kind_are_taken(endpoint: str) -> None:
    assert ZenohOptions(connect=(endpoint,)).connect == (endpoint,)


def test_a_listen_address_of_another_computer_is_the_users_mistake() -> None:
    with pytest.raises(UserError, match=r"^cannot open the Zenoh session .*Cannot assign requested address") as caught:
        open_session(ZenohOptions(listen=("tcp/192.0.2.1:7447",), insecure=True))
    assert ".rs" not in str(caught.value)


@pytest.mark.wire
def test_a_client_without_router_gives_up(endpoint: str) -> None:
    with pytest.raises(UserError, match=f"--connect {endpoint}: no router answers"):
        open_session(ZenohOptions(mode="client", connect=(endpoint,)))


def test_a_configuration_file_is_used_and_options_go_before_it(tmp_path: Path, endpoint: str) -> None:
    other = free_tcp_endpoint()
    path = tmp_path / "zenoh.json5"
    path.write_text(f"{{ /* ours */ mode: 'peer', listen: {{ endpoints: ['{endpoint}'] }} }}", encoding="utf-8")
    for options, reachable in (
        (ZenohOptions(config_file=path), endpoint),
        (ZenohOptions(config_file=path, listen=(other,)), other),
    ):
        with open_session(options) as session, connector(reachable) as peer:
            until(peer, lambda session=session: peer_count(session) == 1)  # type: ignore[misc]  # bound to this turn


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{mode: 'peer', nonsense: 3}", "unknown field `nonsense`"),
        ("{mode: ", "line 1, column 8"),
        ("{mode: 'pear'}", "pear"),
        ("{a:" * 50_000 + "1" + "}" * 50_000, "nested too deep"),
        ("[" * 200_000, "nested too deep"),
    ],
)
def test_a_wrong_configuration_file_is_the_users_mistake(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "zenoh.json5"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        open_session(ZenohOptions(config_file=path))
    assert str(caught.value).startswith(f"--zenoh-config {path}: ")
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["root_ca_certificate", "connect_private_key", "listen_certificate"])
def test_a_key_or_certificate_that_cannot_be_read_is_told_by_its_name(tmp_path: Path, name: str) -> None:
    path = tmp_path / "zenoh.json5"
    ends = "listen: { endpoints: ['tls/127.0.0.1:0'] }, connect: { endpoints: ['tls/127.0.0.1:1'] }"
    keys = f"transport: {{ link: {{ tls: {{ {name}: '{tmp_path}/none.pem' }} }} }}"
    path.write_text(f"{{ {ends}, {keys} }}", encoding="utf-8")
    with pytest.raises(
        UserError, match=rf"{name}: {tmp_path}/none\.pem cannot be read \(No such file or directory\); "
    ):
        open_session(ZenohOptions(config_file=path))


def test_keys_that_no_endpoint_needs_are_not_read(tmp_path: Path, endpoint: str) -> None:
    path = tmp_path / "zenoh.json5"
    keys = f"transport: {{ link: {{ tls: {{ listen_private_key: '{tmp_path}/none.pem' }} }} }}"
    path.write_text(f"{{ listen: {{ endpoints: ['{endpoint}'] }}, {keys} }}", encoding="utf-8")
    with open_session(ZenohOptions(config_file=path)) as session:
        assert peer_count(session) == 0


def test_a_missing_configuration_file_is_the_users_mistake(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot be read \(No such file"):
        open_session(ZenohOptions(config_file=tmp_path / "absent.json5"))


def test_encoding_reaches_the_receiver(pair: tuple[ZenohSession, ZenohSession]) -> None:
    """A queryable's answer and a sample carry the names that a bridge to ROS 2 looks for."""
    sender, receiver = pair
    encodings: list[str] = []
    receiver._session.declare_subscriber("ns/e", lambda sample: encodings.append(str(sample.encoding)))  # noqa: SLF001 (Zenoh's own)

    def has_come() -> bool:
        sender.publish("ns/e", b"", "application/cdr;nav_msgs/msg/Odometry")
        return bool(encodings)

    until(receiver, has_come)
    assert encodings[0] == "application/cdr;nav_msgs/msg/Odometry"


def test_nothing_of_the_librarys_log_reaches_stderr(endpoint: str) -> None:
    code = (
        "import sys; from link.zenoh.session import *; from link.errors import UserError\n"
        f"s = open_session(ZenohOptions(connect=({endpoint!r},), listen=({free_tcp_endpoint()!r},)))\n"
        "s.subscribe('a'); s.publish('a', b'', 'text/plain'); s.wake_up.wait(5.0); s.close()\n"
    )
    environment = os.environ | {"RUST_LOG": "debug"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert json.dumps(done.stdout + done.stderr) == '""'
