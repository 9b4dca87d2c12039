"""Samples that are made to fill the memory."""

from types import SimpleNamespace
from typing import Any

from link.zenoh.inbox import Inbox, Sample
from link.zenoh.session import ZenohOptions, open_session
from scenarios.processes.programs import free_tcp_endpoint
from tests.integration.programs import until

WAKE_UP: Any = SimpleNamespace(set=lambda: None)
MB = 1 << 20
KEY = "ns/vehicle/fix"


def waiting_bytes(inbox: Inbox) -> int:
    return sum(len(sample.payload) for sample in inbox.take())


def test_samples_that_wait_are_bounded_in_bytes_and_the_newest_are_kept() -> None:
    inbox = Inbox(capacity=1024, wake_up=WAKE_UP)
    for number in range(300):
        inbox.put(Sample(KEY, bytes([number % 256]) * 50_000, number))
    inbox.put(Sample(KEY, bytes(200 * MB), 300))
    inbox.put(Sample(KEY, b"a fix", 301))
    samples = inbox.take()
    assert sum(len(sample.payload) for sample in samples) <= MB
    assert samples[-1].payload == b"a fix"
    assert inbox.dropped + len(samples) == 302


def test_room_is_there_again_once_samples_were_taken() -> None:
    inbox = Inbox(capacity=1024, wake_up=WAKE_UP)
    for _ in range(5):
        for _ in range(10):
            inbox.put(Sample(KEY, bytes(MB // 10), 0))
        assert waiting_bytes(inbox) == 10 * (MB // 10)
    assert inbox.dropped == 0


def test_message_larger_than_any_of_ours_does_not_reach_a_program_and_the_next_one_does() -> None:
    endpoint = free_tcp_endpoint()
    with open_session(ZenohOptions(listen=(endpoint,))) as companion:
        inbox = companion.subscribe(KEY)
        with open_session(ZenohOptions(connect=(endpoint,))) as stranger:
            found: list[bytes] = []

            def has_come() -> bool:
                stranger.publish(KEY, bytes(10 * MB), "a/b")
                stranger.publish(KEY, b"a fix", "a/b")
                companion.wake_up.wait(0.05)
                found.extend(sample.payload for sample in inbox.take())
                return bool(found)

            until(has_come, "the small one")
        assert set(found) == {b"a fix"}
