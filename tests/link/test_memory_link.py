import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.memory_link import MemoryLink

MS = 1_000_000
S = 1_000_000_000


def passed(link: MemoryLink, count: int, period_ns: int = 10 * MS) -> list[tuple[int, int]]:
    """Numbers packets, sends one each period; returns (number, delay in ns) as they arrive, to the nearest ms."""
    got = []
    for now_ns in range(0, count * period_ns + 2 * S, MS):
        if now_ns % period_ns == 0 and now_ns // period_ns < count:
            link.put((now_ns // period_ns).to_bytes(4, "big"), now_ns)
        for data in link.take(now_ns):
            number = int.from_bytes(data, "big")
            got.append((number, now_ns - number * period_ns))
    return got


def test_a_perfect_link_hands_over_at_once_and_in_order() -> None:
    assert passed(MemoryLink(seed=1), 50) == [(number, 0) for number in range(50)]


def test_packets_come_after_the_delay_and_not_before() -> None:
    link = MemoryLink(seed=1, delay_s=0.02)
    link.put(b"x", 5 * MS)
    assert link.take(25 * MS - 1) == []
    assert link.take(25 * MS) == [b"x"]
    assert link.take(10**18) == []


def test_delays_stay_within_the_jitter_and_packets_overtake_each_other() -> None:
    got = passed(MemoryLink(seed=1, delay_s=0.1, jitter_s=0.05), 300)
    delays_ns = [delay_ns for _, delay_ns in got]
    assert 50 * MS <= min(delays_ns) < 60 * MS
    assert 140 * MS < max(delays_ns) <= 151 * MS
    assert [number for number, _ in got] != sorted(number for number, _ in got)


def test_without_reordering_packets_keep_their_order() -> None:
    got = passed(MemoryLink(seed=1, delay_s=0.1, jitter_s=0.05, reorder=False), 300)
    assert [number for number, _ in got] == list(range(300))


@pytest.mark.parametrize(("loss", "duplication", "expected"), [(0.2, 0.0, 0.8), (0.0, 0.2, 1.2)])
def test_probabilities_are_kept(loss: float, duplication: float, expected: float) -> None:
    link = MemoryLink(seed=4, loss=loss, duplication=duplication)
    share = len(passed(link, 5000)) / 5000
    assert share == pytest.approx(expected, abs=4.0 * math.sqrt(0.2 * 0.8 / 5000))


def test_corruption_flips_one_bit_of_some_packets() -> None:
    link = MemoryLink(seed=4, corruption=0.3)
    for k in range(1000):
        link.put(bytes(20), k)
    flipped = [sum(byte.bit_count() for byte in data) for data in link.take(S)]
    assert set(flipped) == {0, 1}
    assert sum(flipped) / 1000 == pytest.approx(0.3, abs=0.06)


def test_what_is_sent_during_an_outage_is_lost() -> None:
    got = passed(MemoryLink(seed=1, outages_ns=[(100 * MS, 200 * MS), (300 * MS, 310 * MS)]), 50)
    assert sorted(set(range(50)) - {number for number, _ in got}) == [*range(10, 20), 30]


@given(st.integers(0, 2**32), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 0.3))
def test_the_same_seed_gives_the_same_run(seed: int, loss: float, duplication: float, jitter_s: float) -> None:
    def run() -> list[bytes]:
        link = MemoryLink(seed=seed, delay_s=0.1, jitter_s=jitter_s, loss=loss, duplication=duplication)
        for k in range(20):
            link.put(bytes([k]), k * MS)
        return link.take(S)

    assert run() == run()


def test_more_loss_loses_the_same_packets_and_some_more() -> None:
    few, many = ({number for number, _ in passed(MemoryLink(seed=7, loss=loss), 300)} for loss in (0.1, 0.4))
    assert many < few


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("loss", lambda: MemoryLink(seed=1, loss=1.1)),
        ("duplication", lambda: MemoryLink(seed=1, duplication=-0.1)),
        ("jitter_s", lambda: MemoryLink(seed=1, jitter_s=-1.0)),
        ("delay_s", lambda: MemoryLink(seed=1, delay_s=math.nan)),
    ],
)
def test_a_number_that_cannot_be_is_an_error_of_the_caller(name: str, make: Callable[[], MemoryLink]) -> None:
    with pytest.raises(ValueError, match=name):
        make()


def test_spoiling_from_now_on_cuts_some_packets_short_and_flips_a_bit_in_as_many_others() -> None:
    link = MemoryLink(seed=4)
    link.spoil(corruption=0.1, truncation=0.1)
    for k in range(4000):
        link.put(bytes(20), k)
    got = link.take(10**9)
    short, flipped = sum(len(one) < 20 for one in got), sum(any(one) for one in got)
    assert short / 4000 == pytest.approx(0.1, abs=4.0 * math.sqrt(0.09 / 4000))
    assert flipped / 4000 == pytest.approx(0.1, abs=4.0 * math.sqrt(0.09 / 4000))
    assert not any(len(one) < 20 and any(one) for one in got)
