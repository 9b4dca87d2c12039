"""The inbox is bounded and counts, and the wake-up wakes."""

import select
import threading
from collections.abc import Iterator

import pytest

from link.zenoh.inbox import Inbox, Sample, WakeUp


def sample(number: int) -> Sample:
    return Sample("key", bytes([number]), number)


@pytest.fixture
def wake_up() -> Iterator[WakeUp]:
    wake_up = WakeUp()
    yield wake_up
    wake_up.close()


def test_inbox_gives_each_sample_once_and_in_order(wake_up: WakeUp) -> None:
    inbox = Inbox(capacity=4, wake_up=wake_up)
    for number in range(3):
        inbox.put(sample(number))
    assert inbox.take() == [sample(0), sample(1), sample(2)]
    assert inbox.take() == []


def test_full_inbox_drops_the_oldest_and_counts(wake_up: WakeUp) -> None:
    inbox = Inbox(capacity=2, wake_up=wake_up)
    for number in range(5):
        inbox.put(sample(number))
    assert inbox.take() == [sample(3), sample(4)]
    assert inbox.dropped == 3


def test_wait_ends_early_when_another_thread_puts_a_sample(wake_up: WakeUp) -> None:
    inbox = Inbox(capacity=2, wake_up=wake_up)
    thread = threading.Thread(target=inbox.put, args=(sample(7),))
    thread.start()
    assert wake_up.wait(30.0)
    thread.join()
    assert inbox.take() == [sample(7)]


def test_wait_tells_that_nothing_came(wake_up: WakeUp) -> None:
    assert not wake_up.wait(0.0)


def test_wake_up_can_be_selected_on_until_it_is_cleared(wake_up: WakeUp) -> None:
    for _ in range(3):
        wake_up.set()
    assert select.select([wake_up], [], [], 0.0)[0] == [wake_up]
    wake_up.clear()
    assert select.select([wake_up], [], [], 0.0)[0] == []


def test_setting_a_closed_wake_up_does_nothing(wake_up: WakeUp) -> None:
    wake_up.close()
    wake_up.set()
    assert wake_up.fileno() == -1
