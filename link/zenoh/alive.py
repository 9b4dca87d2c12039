"""Who lives, as liveliness tokens show it."""

from link.zenoh.inbox import WakeUp

_TOKENS_MAX = 100
"""On a key with wildcards; no network has so many drones at one vehicle, and each token costs time in every step."""


class Alive:
    """Whether anybody declares a liveliness token on a key; tokens beyond a hundred are not taken note of."""

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
        if not is_alive:
            self._keys.discard(key)
        elif len(self._keys) < _TOKENS_MAX:
            self._keys.add(key)
        self._wake_up.set()
