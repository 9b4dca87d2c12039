"""Clients on several links of one simulated autopilot, in bytes only."""

from collections import Counter

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.runtime.node import AutopilotNode
from tests.sim_autopilot.pilot import START_NS, STILL_AIR


def beat(kind: int = mavlink.MAV_TYPE_GCS) -> Message:
    """A heartbeat of a client."""
    return mavlink.MAVLink_heartbeat_message(kind, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)


class Clients:
    """An autopilot with one client on each of its links: a ground station on the first, companions on the others."""

    def __init__(self, config: AutopilotConfig, links: int = 2) -> None:
        self.node = AutopilotNode(replace(config, links=(None,) * links), START_NS)
        self.codecs = [MavlinkCodec(255, 190) if not link else MavlinkCodec(1, 190 + link) for link in range(links)]
        self.heard: list[list[Message]] = [[] for _ in range(links)]
        self.sent = [0] * links

    def send(self, link: int, *messages: Message) -> None:
        """Send from the client on `link`."""
        self.send_bytes(link, b"".join(map(self.codecs[link].encode, messages)))

    def send_bytes(self, link: int, data: bytes) -> None:
        """Send any bytes on `link`."""
        self._deliver(self.node.receive(data, self.node.state.t_ns, link))

    def run(self, duration_s: float) -> None:
        """Let time pass."""
        end_ns = self.node.state.t_ns + round(duration_s * 1e9)
        while self.node.state.t_ns < end_ns:
            self._deliver(self.node.step(None, STILL_AIR))

    def counts(self, link: int) -> Counter[str]:
        """How many of each message the client on `link` has heard."""
        return Counter(message.get_type() for message in self.heard[link])

    def forget(self) -> None:
        """Begin to count anew."""
        for heard in self.heard:
            heard.clear()

    def of(self, link: int, name: str) -> list[Message]:
        """The messages of a name that the client on `link` has heard."""
        return [message for message in self.heard[link] if message.get_type() == name]

    def _deliver(self, output: tuple[bytes, ...]) -> None:
        for link, data in enumerate(output):
            self.sent[link] += len(data)
            self.heard[link] += self.codecs[link].decode(data)
