"""Whether the vehicle's data contradict each other, or come from the future; pure.

How many of them the estimator has lately rejected tells the one, how old the newest fix was when it came the other.

A velocity with its axes exchanged, or stamps that jump, make the estimator reject what it has just believed, again and
again: its estimate swings between the two. Outages and brakes have a few rejected, one after the other.
"""

from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.situation.situation import Situation
from companion.vehicle.estimator import BufferHealth

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


@dataclass(frozen=True, slots=True, kw_only=True)
class FixStamps:
    """The newest accepted fix.

    Attributes:
        newest_ns: when it was taken, by its own stamp; None before the first.
        age_on_arrival_s: of it in the step that took it in, never negative where both clocks are right.
    """

    newest_ns: int | None = None
    age_on_arrival_s: float | None = None


def update_fix_stamps(stamps: FixStamps, newest_ns: int | None, t_ns: int) -> FixStamps:
    """Return the stamps with the newest fix as it is known at `t_ns`.

    Args:
        stamps: so far.
        newest_ns: stamp of the newest accepted fix.
        t_ns: now.
    """
    if newest_ns == stamps.newest_ns:
        return stamps
    return FixStamps(newest_ns=newest_ns, age_on_arrival_s=None if newest_ns is None else (t_ns - newest_ns) * 1e-9)
