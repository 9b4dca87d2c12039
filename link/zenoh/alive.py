"""Who lives, as liveliness tokens show it."""

from link.zenoh.inbox import WakeUp


class Alive:
    """Whether anybody declares a liveliness token on a key."""

    def __init__(self, wake_up: WakeUp) -> None:
        self._wake_up = wake_up
        self._keys: set[str] = set()

    @property
    def alive(self) -> bool:
        """Whether a token is there now."""
        return bool(self._keys)

    @property
    def keys(self) -> frozenset[str]:
        """The keys of all tokens that are there now."""
        return frozenset(self._keys)

    def update(self, key: str, *, is_alive: bool) -> None:
        """Take the news of a token; for the receiving thread."""
        (self._keys.add if is_alive else self._keys.discard)(key)
        self._wake_up.set()
