"""A lossy channel in one direction without I/O: the same seed and calls give the same packets at the same times."""

import heapq
from collections.abc import Iterator, Sequence

import numpy as np

from link.units import NS_PER_S

_DRAWS = 6  # for each packet
_BLOCK = 256  # packets whose draws are made at once


class MemoryLink:
    """Holds packets until their time has come, and loses, doubles, spoils or overtakes some of them.

    Args:
        seed: of all that is random, or the generator that draws it.
        delay_s: mean time from `put` to `take`.
        jitter_s: the delay is uniform within plus or minus this about its mean, never below zero.
        loss: probability that a packet is lost.
        duplication: probability that a packet comes twice, each copy with its own delay.
        corruption: probability that one bit of a packet is flipped.
        truncation: probability that a packet is cut short.
        reorder: whether a packet with a shorter delay overtakes one put before it.
        outages_ns: spans from start to end, during which whatever is put is lost.

    Raises:
        ValueError: A probability is outside 0 to 1 or a time is negative.
    """

    def __init__(
        self,
        *,
        seed: int | np.random.Generator,
        delay_s: float = 0.0,
        jitter_s: float = 0.0,
        loss: float = 0.0,
        duplication: float = 0.0,
        corruption: float = 0.0,
        truncation: float = 0.0,
        reorder: bool = True,
        outages_ns: Sequence[tuple[int, int]] = (),
    ) -> None:
        _check(delay_s=delay_s, jitter_s=jitter_s, loss=loss, duplication=duplication)
        self._draws = _draws(np.random.default_rng(seed))
        self._delay_ns = round(delay_s * NS_PER_S)
        self._jitter_ns = round(jitter_s * NS_PER_S)
        self._loss = loss
        self._duplication = duplication
        self.spoil(corruption=corruption, truncation=truncation)
        self._reorder = reorder
        self._outages_ns = tuple(outages_ns)
        self._last_due_ns: int | None = None
        self._packets_put = 0
        self._waiting: list[tuple[int, int, bytes]] = []

    def spoil(self, *, corruption: float = 0.0, truncation: float = 0.0) -> None:
        """Spoils packets with these probabilities from now on, in place of those before.

        Raises:
            ValueError: A probability is outside 0 to 1, or both together are.
        """
        _check(corruption=corruption, truncation=truncation, spoilt=corruption + truncation)
        self._corruption, self._truncation = corruption, truncation

    def put(self, data: bytes, t_ns: int) -> None:
        """Sends a packet.

        Args:
            data: the packet.
            t_ns: now.
        """
        # A fixed number of draws for each packet keeps the rest of a run the same when one probability changes.
        lose, double, delay, second_delay, spoil, place = next(self._draws)
        if lose < self._loss or (self._outages_ns and self._is_out(t_ns)):
            return
        if spoil < self._corruption and data:
            data = _with_flipped_bit(data, int(place * len(data) * 8))
        elif spoil > 1.0 - self._truncation:
            data = data[: int(place * len(data))]
        self._push(data, t_ns, delay)
        if double < self._duplication:
            self._push(data, t_ns, second_delay)

    def take(self, t_ns: int) -> list[bytes]:
        """Receives the packets that have come by now.

        Args:
            t_ns: now.

        Returns:
            Packets in their order of arrival.
        """
        packets = []
        while self._waiting and self._waiting[0][0] <= t_ns:
            packets.append(heapq.heappop(self._waiting)[2])
        return packets

    def _is_out(self, t_ns: int) -> bool:
        return any(start <= t_ns < end for start, end in self._outages_ns)

    def _push(self, data: bytes, t_ns: int, draw: float) -> None:
        due_ns = t_ns + max(0, self._delay_ns + round(self._jitter_ns * (2.0 * draw - 1.0)))
        if not self._reorder:
            due_ns = max(due_ns, self._last_due_ns or due_ns)
            self._last_due_ns = due_ns
        heapq.heappush(self._waiting, (due_ns, self._packets_put, data))
        self._packets_put += 1


def _draws(random: np.random.Generator) -> Iterator[list[float]]:
    """Yield what decides about one packet after another."""
    while True:
        yield from random.random((_BLOCK, _DRAWS)).tolist()


def _with_flipped_bit(data: bytes, bit: int) -> bytes:
    spoiled = bytearray(data)
    spoiled[bit // 8] ^= 1 << bit % 8
    return bytes(spoiled)


def _check(*, delay_s: float = 0.0, jitter_s: float = 0.0, **probabilities: float) -> None:
    for name, value in {"delay_s": delay_s, "jitter_s": jitter_s}.items():
        if not value >= 0.0:
            raise ValueError(f"{name} must not be negative, is {value}")
    for name, value in probabilities.items():
        if not 0.0 <= value <= 1.0:
            raise ValueError(f"{name} must be within 0 and 1, is {value}")
