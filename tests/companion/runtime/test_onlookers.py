"""Who looks on: told what they ask for, and of no consequence to the node."""

import io
from collections.abc import Iterator
from typing import Any

import pytest
from rich.console import Console

from companion.runtime import live_state
from companion.runtime.live_state import LiveState
from companion.runtime.terminal import Terminal
from link.payloads.decklander_msgs import fields_of
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_tcp_endpoint
from tests.companion.peer import Setup

KEYS = Keys()


@pytest.fixture
def pair() -> Iterator[tuple[ZenohSession, ZenohSession]]:
    endpoint = free_tcp_endpoint()
    with (
        open_session(ZenohOptions(listen=(endpoint,))) as near,
        open_session(ZenohOptions(connect=(endpoint,))) as far,
    ):
        yield near, far


def told(live: LiveState, setup: Setup) -> None:
    """Let the node see a vehicle, and tell of its steps often enough for everything to be due."""

    def tell() -> None:
        for _ in range(10):
            live.tell(setup.node, setup.t_ns)

    setup.fix()
    setup.run(0.1, tell)


def test_view_that_listens_is_told_and_one_that_does_not_costs_no_message(
    pair: tuple[ZenohSession, ZenohSession], monkeypatch: pytest.MonkeyPatch
) -> None:
    near, far = pair
    published: list[str] = []
    send = ZenohSession.publish

    def noted(self: ZenohSession, key: str, payload: bytes, encoding: str) -> None:
        published.append(key)
        send(self, key, payload, encoding)

    monkeypatch.setattr(ZenohSession, "publish", noted)
    setup = Setup()
    setup.run(2.0)
    unheard = LiveState(near, KEYS)
    told(unheard, setup)
    unheard.close()
    assert published == []

    inbox = far.subscribe(KEYS.record("*"))
    encoding = "application/cdr;nav_msgs/msg/Odometry"
    for _ in range(500):
        if near.is_heard(KEYS.record("own"), encoding):
            break
        far.wake_up.wait(0.01)
    heard = LiveState(near, KEYS)
    told(heard, setup)
    heard.close()
    samples: dict[str, bytes] = {}
    for _ in range(500):
        samples |= {sample.key: sample.payload for sample in inbox.take()}
        if len(samples) == 4:
            break
        far.wake_up.wait(0.01)
    assert set(samples) == {KEYS.record(name) for name in ("own", "estimate", "forecast", "link")}
    forecast = fields_of(samples[KEYS.record("forecast")], "decklander_msgs/msg/Forecast")
    assert len(forecast["position_m"]) == 3 * len(forecast["offset_s"]) > 0


class Listener:
    """A session whose only listener wants some keys; keeps the keys that are published, by their encodings."""

    def __init__(self, *wanted: str) -> None:
        self._wanted = wanted
        self.published: dict[str, str] = {}

    def is_heard(self, key: str, _: str) -> bool:
        return key in self._wanted

    def publish(self, key: str, payload: bytes, encoding: str) -> None:
        assert fields_of(payload, encoding.removeprefix("application/cdr;"))
        self.published[key] = encoding


def encoded_for_nobody(record: object, _: Keys) -> None:
    raise AssertionError(f"{record} was encoded, and nobody listens")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["own", "estimate", "forecast", "link"])
def test_who_listens_to_one_topic_is_told_that_one_and_nothing_else_is_encoded(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for other in {"own", "estimate", "forecast", "link"} - {name}:
        monkeypatch.setattr(live_state, f"{other}_message", encoded_for_nobody)
    setup, listener = Setup(), Listener(KEYS.record(name))
    setup.run(2.0)
    session: Any = listener
    live = LiveState(session, KEYS)
    told(live, setup)
    live.close()
    assert set(listener.published) == {KEYS.record(name)}


def test_terminal_shows_what_the_node_waits_for_and_its_links() -> None:
    setup, drawn = Setup(), io.StringIO()
    terminal = Terminal("udpin:127.0.0.1:14540", Console(file=drawn, width=80))
    setup.run(2.0)
    for _ in range(25):
        terminal.tell(setup.node, setup.t_ns)
    terminal.close()
    text = drawn.getvalue()
    for words in ("udpin:127.0.0.1:14540", "idle", "waiting for a start", "behind its setpoint", "messages in, out"):
        assert words in text
