"""The links of a lockstep run: MAVLink down and up, and Zenoh, each with seeded delay, loss and outage."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from link.memory_link import MemoryLink
from scenarios.config import ChannelConfig, Scenario
from scenarios.simulation.noise import Seed, Span, named_rng, outages_ns

_SEPARATOR = b"\0"


class Way(Protocol):
    """What payloads are sent by."""

    def put(self, key: str, payload: bytes, t_ns: int) -> None:
        """Send a payload."""


class KeyedLink:
    """A memory link for payloads with their keys."""

    def __init__(self, link: MemoryLink) -> None:
        self._link = link

    def put(self, key: str, payload: bytes, t_ns: int) -> None:
        """Send a payload."""
        self._link.put(key.encode() + _SEPARATOR + payload, t_ns)

    def take(self, t_ns: int) -> list[tuple[str, bytes]]:
        """Return what has arrived, with the keys."""
        packets = [packet.partition(_SEPARATOR) for packet in self._link.take(t_ns)]
        return [(key.decode(), payload) for key, _, payload in packets]


@dataclass(frozen=True, slots=True, kw_only=True)
class Channels:
    """The directions that matter.

    Attributes:
        down: from the autopilot to the companion.
        up: from the companion to the autopilot.
        zenoh: from the vehicle to the companion.
        detector: from the detector on the drone to the companion.
    """

    down: MemoryLink
    up: MemoryLink
    zenoh: KeyedLink
    detector: KeyedLink


def channels_of(scenario: Scenario, seed: Seed, start_ns: int) -> Channels:
    """Return fresh channels for a run that starts at `start_ns`; an outage of MAVLink is one of both directions."""
    link = scenario.link
    outages = outages_ns(link.mavlink, scenario, seed, "mavlink", start_ns)
    return Channels(
        down=_channel(link.mavlink, seed, "mavlink down", outages),
        up=_channel(link.mavlink, seed, "mavlink up", outages),
        zenoh=_keyed_link(link.zenoh, scenario, seed, "zenoh", start_ns),
        detector=_keyed_link(link.detector, scenario, seed, "detector", start_ns),
    )


def _keyed_link(config: ChannelConfig, scenario: Scenario, seed: Seed, name: str, start_ns: int) -> KeyedLink:
    return KeyedLink(_channel(config, seed, name, outages_ns(config, scenario, seed, name, start_ns)))


def _channel(config: ChannelConfig, seed: Seed, name: str, outages: Sequence[Span]) -> MemoryLink:
    rng = named_rng(seed, name)
    return MemoryLink(
        seed=int(rng.integers(2**31)) if isinstance(seed, int) else rng,
        delay_s=config.delay_s,
        jitter_s=config.jitter_s,
        loss=config.loss,
        outages_ns=outages,
    )
