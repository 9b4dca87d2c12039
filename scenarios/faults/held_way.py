"""A vehicle's way to the companion whose program, or whose router, stands still for a while."""

from scenarios.lockstep.channels import KeyedLink


class HeldWay:
    """A link that holds back, or loses, what is put into it while that is wanted.

    Args:
        link: that it goes on by.

    Attributes:
        holds: what is put is kept until this is no longer so, and then goes on at once, late.
        loses: what is put is lost.
    """

    def __init__(self, link: KeyedLink) -> None:
        self._link = link
        self._held: list[tuple[str, bytes]] = []
        self.holds = False
        self.loses = False

    def put(self, key: str, payload: bytes, t_ns: int) -> None:
        """Send a payload, now or later or never."""
        if self.loses:
            return
        self._held.append((key, payload))
        if self.holds:
            return
        for held in self._held:
            self._link.put(*held, t_ns)
        self._held.clear()
