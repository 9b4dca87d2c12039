"""Whether the vehicle's data contradict each other; pure.

How many of one quantity the estimator has lately rejected tells: an inertial unit, which tells most and fits always,
would hide fixes that do not. Sightings of the pad have a watch of their own.
A velocity with its axes exchanged, or stamps that jump, make the estimator reject what it has just believed, again and
again: its estimate swings between the two. Outages and brakes have a few rejected, one after the other.
"""

from collections.abc import Callable
from operator import add, gt

from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.core.data import Quantity
from companion.core.reasons import Cause, Reason
from companion.situation.situation import Situation
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.filter_step import OF_DRONE, RANK

_EVERY_NS = 500_000_000
_SAMPLES_KEPT = 20  # of 10 s in all: a step of the drone's own frame has measurements of half a second rejected
_MEASUREMENTS_MIN = 20  # measurements that something is said of

_JUDGED = {one: RANK[one] for one in Quantity if one is not Quantity.PAD and one not in OF_DRONE}

Sample = tuple[int, tuple[int, ...], tuple[int, ...]]
"""Monotonic ns, and how many of each of `QUANTITIES` had come and were rejected by then."""


class Contradictions(Struct, frozen=True, kw_only=True):
    """What became of the vehicle's measurements in the last seconds.

    Attributes:
        samples: oldest first.
        rejected_share: of those of one quantity that came, the largest; of all together, where that is more, 0 to 1.
        rejected: that quantity; None of all together, and where nothing is rejected.
    """

    samples: tuple[Sample, ...] = ()
    rejected_share: float = 0.0
    rejected: Quantity | None = None

    def is_due(self, t_ns: int) -> bool:
        """Return whether the next sample is to be taken at `t_ns`."""
        return not self.samples or t_ns - self.samples[-1][0] >= _EVERY_NS


def update_contradictions(before: Contradictions, health: BufferHealth, t_ns: int) -> Contradictions:
    """Return the contradictions with what the estimator tells at `t_ns`; one that was restarted is counted again."""
    arrived = tuple(map(add, health.accepted, health.rejected))
    now = (t_ns, arrived, health.rejected)
    if before.samples and any(map(gt, before.samples[-1][1], arrived)):
        return Contradictions(samples=(now,))
    samples = (*before.samples, now)[-_SAMPLES_KEPT - 1 :]
    _, arrived_then, rejected_then = samples[0]
    counts: dict[Quantity | None, tuple[int, int]] = {
        one: (arrived[k] - arrived_then[k], health.rejected[k] - rejected_then[k]) for one, k in _JUDGED.items()
    }
    counts[None] = (sum(came for came, _ in counts.values()), sum(bad for _, bad in counts.values()))
    shares = {one: bad / came for one, (came, bad) in counts.items() if came >= _MEASUREMENTS_MIN}
    rejected = max(shares, key=shares.__getitem__, default=None)
    share = 0.0 if not shares else shares[rejected]
    return Contradictions(samples=samples, rejected_share=share, rejected=rejected if share > 0.0 else None)


def contradicts_itself(s: Situation, c: CompanionConfig) -> bool:
    """Return whether so many of the vehicle's measurements were rejected that nothing says which are right."""
    return s.vehicle.rejected_share > c.integrity.rejected_share_max


_OF_PLACE = "the unit (m/s) and axes (ENU) of its velocity, its stamps, its receiver"
_OF_TURN = "the unit (rad), zero (East) and sense (counter-clockwise) of its heading and yaw rate"
_MENDS = {
    None: ("data", _OF_PLACE),
    Quantity.POSITION: ("fixes", _OF_PLACE),
    Quantity.VELOCITY: ("velocities", _OF_PLACE),
    Quantity.HEADING: ("headings", _OF_TURN),
    Quantity.YAW_RATE: ("yaw rates", _OF_TURN),
    Quantity.ACCELERATION: ("accelerations", "their unit (m/s^2) and axes (FLU)"),
    Quantity.TILT: ("tilts", "the unit (rad) and axes (FLU) of its roll, pitch and their rates"),
}
"""What is told of data that are rejected, and what to see to: fixes are rejected where the velocity is wrong, too."""


def tell_rejected(reason: Reason) -> Callable[[Situation, CompanionConfig], Cause]:
    """Return what tells `reason` of a vehicle that contradicts itself, and which of its data are rejected."""

    def tell(s: Situation, _: CompanionConfig) -> Cause:
        return Cause(reason, (s.vehicle.rejected_share, *_MENDS[s.vehicle.rejected]))

    return tell
