"""Holding a session to the one peer in which its autopilot was found, however many speak to the same port.

Whoever sends from another address or port is not listened to. The peer is looked for again once the autopilot has been
silent for as long as the session takes for a loss. Somebody who sends under the peer's own address is only kept out by
signing.
"""

from collections.abc import Iterable, Iterator

from link.mavlink.session import MavlinkSession
from link.transports.transport import PeerBytes, Transport


class PinnedPeer:
    """The bytes of a session's transport, from its peer only.

    Args:
        transport: of the session.
        session: that finds the autopilot.
    """

    def __init__(self, transport: Transport, session: MavlinkSession) -> None:
        self._transport = transport
        self._session = session
        self._is_pinned = False
        transport.seek_peer()

    def heard(self, received: Iterable[PeerBytes]) -> Iterator[bytes]:
        """Give what is the session's of what the transport received, each to be taken by it before the next."""
        if self._is_pinned and not self._session.link_up:
            self._is_pinned = False
            self._transport.seek_peer()
        found: int | None = None
        for peer, data in received:
            if found not in {None, peer}:
                continue
            yield data
            if not self._is_pinned and self._session.link_up:
                self._is_pinned, found = True, peer
                self._transport.pin(peer)
