"""Whether the vehicle's data contradict each other: how many of them the estimator has lately rejected; pure.

A velocity with its axes exchanged, or stamps that jump, make the estimator reject what it has just believed, again and
again: its estimate swings between the two. Outages and brakes have a few rejected, one after the other.
"""

from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.situation.situation import Situation
from companion.vehicle.buffered import BufferHealth

_EVERY_NS = 500_000_000
_OVER = 20  # samples, of 10 s in all: a step of the drone's own frame has measurements of half a second rejected
_LEAST = 20  # measurements that something is said of

Sample = tuple[int, int, int]
"""Monotonic ns, and how many measurements were accepted and rejected by then."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contradictions:
    """What became of the vehicle's measurements in the last seconds.

    Attributes:
        samples: oldest first.
        rejected_share: of those that came, 0 to 1.
    """

    samples: tuple[Sample, ...] = ()
    rejected_share: float = 0.0

    def is_due(self, t_ns: int) -> bool:
        """Return whether the next sample is to be taken at `t_ns`."""
        return not self.samples or t_ns - self.samples[-1][0] >= _EVERY_NS


def update_contradictions(before: Contradictions, health: BufferHealth, t_ns: int) -> Contradictions:
    """Return the contradictions with what the estimator tells at `t_ns`; one that was begun anew is counted anew."""
    now = (t_ns, health.fused, health.gated)
    if before.samples and before.samples[-1][1] > health.fused:
        return Contradictions(samples=(now,))
    samples = (*before.samples, now)[-_OVER - 1 :]
    accepted, rejected = health.fused - samples[0][1], health.gated - samples[0][2]
    arrived = accepted + rejected
    return Contradictions(samples=samples, rejected_share=rejected / arrived if arrived >= _LEAST else 0.0)


def contradicts_itself(s: Situation, c: CompanionConfig) -> bool:
    """Return whether so many of the vehicle's measurements were rejected that nothing says which are right."""
    return s.vehicle.rejected_share > c.abort.rejected_share_max
