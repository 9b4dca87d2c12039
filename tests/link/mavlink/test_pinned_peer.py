"""Which senders a session hears, before its autopilot is found and after."""

from typing import cast

from link.mavlink.pinned_peer import PinnedPeer
from link.mavlink.session import MavlinkSession
from link.transports.transport import PeerBytes, Transport

AUTOPILOT, STRANGER = 1, 2


class Port:
    """A transport that notes what it is asked for; it filters nothing itself."""

    def __init__(self) -> None:
        self.asked: list[int | None] = []

    def pin(self, peer: int) -> None:
        self.asked.append(peer)

    def seek_peer(self) -> None:
        self.asked.append(None)


class Session:
    """One that finds its autopilot by the bytes `found`."""

    def __init__(self) -> None:
        self.link_up = False
        self.taken: list[bytes] = []

    def take(self, data: bytes) -> None:
        self.taken.append(data)
        self.link_up = self.link_up or data == b"found"


class Link:
    """A session at a port on which several speak."""

    def __init__(self) -> None:
        self.port, self.session = Port(), Session()
        self._peer = PinnedPeer(cast(Transport, self.port), cast(MavlinkSession, self.session))

    def hear(self, *sent: tuple[int, bytes]) -> list[bytes]:
        self.session.taken.clear()
        for data in self._peer.heard([PeerBytes(peer, data) for peer, data in sent]):
            self.session.take(data)
        return list(self.session.taken)


def test_everybody_is_heard_until_the_autopilot_is_found_and_then_its_peer_is_pinned() -> None:
    link = Link()
    assert link.hear((STRANGER, b"a"), (AUTOPILOT, b"b")) == [b"a", b"b"]
    assert link.port.asked == [None]
    assert link.hear((STRANGER, b"c"), (AUTOPILOT, b"found")) == [b"c", b"found"]
    assert link.port.asked == [None, AUTOPILOT]


def test_what_came_with_the_autopilots_first_bytes_is_heard_of_the_autopilot_only() -> None:
    link = Link()
    sent = ((AUTOPILOT, b"found"), (STRANGER, b"x"), (AUTOPILOT, b"y"), (STRANGER, b"z"), (AUTOPILOT, b"w"))
    assert link.hear(*sent) == [b"found", b"y", b"w"]
    assert link.port.asked == [None, AUTOPILOT]


def test_pinned_peer_stays_as_long_as_the_autopilot_is_heard() -> None:
    link = Link()
    link.hear((AUTOPILOT, b"found"))
    for _ in range(3):
        assert link.hear((AUTOPILOT, b"more")) == [b"more"]
    assert link.port.asked == [None, AUTOPILOT]


def test_peer_is_looked_for_anew_once_and_pinned_where_the_autopilot_is_found_again() -> None:
    link = Link()
    link.hear((AUTOPILOT, b"found"))
    link.session.link_up = False
    assert link.hear((STRANGER, b"a")) == [b"a"]
    assert link.hear() == []
    assert link.hear((STRANGER, b"found")) == [b"found"]
    assert link.port.asked == [None, AUTOPILOT, None, STRANGER]
