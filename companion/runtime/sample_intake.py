"""Which samples from Zenoh count: none that come too often to be a sensor's, and none that has come before.

Two bridges between the same networks, or a detector that is started twice with one camera's pictures, publish each
sample twice. Taken for two measurements it would count as known better than it is, by the root of two.
"""

from collections import defaultdict

from link.units import NS_PER_S

SAMPLES_MAX_PER_S = 400
"""Of a key: twice the fastest inertial unit's; each is fused again when a late one comes."""


class SampleIntake:
    """Remembers what has come within the last second, and within the one before."""

    def __init__(self) -> None:
        self._second_ns = 0  # when the second began in which samples are counted
        self._heard: defaultdict[str, set[bytes]] = defaultdict(set)
        self._before: defaultdict[str, set[bytes]] = defaultdict(set)

    def refusal(self, key: str, payload: bytes, now_ns: int) -> tuple[str, str] | None:
        """Count a sample; return why it is refused, as one word and in words, None of one that counts.

        Args:
            key: that it was put on.
            payload: as it came.
            now_ns: monotonic.
        """
        if now_ns - self._second_ns >= NS_PER_S:
            self._second_ns = now_ns
            self._before, self._heard = self._heard, defaultdict(set)
        heard = self._heard[key]
        if payload in heard or payload in self._before[key]:
            return "again", "come again, stamp and all: is it published twice?"
        if len(heard) >= SAMPLES_MAX_PER_S:
            return "flood", f"come more than {SAMPLES_MAX_PER_S} times in a second"
        heard.add(payload)
        return None
