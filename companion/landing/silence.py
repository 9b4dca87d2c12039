"""Whether the vehicle or the autopilot has fallen silent; pure."""

from companion.config.companion import CompanionConfig
from companion.landing.condition import Test
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation


def fix_too_old(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the vehicle has been silent for too long."""
    return s.pad is None or s.fix_age_s is None or s.fix_age_s > c.abort.fix_age_max_s


def own_unknown(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    """Return whether nobody knows where the drone is."""
    return s.drone is None


def attitude_unknown(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    """Return whether nobody knows which way the drone looks and leans: sightings of the pad are turned by it."""
    return s.drone is not None and not s.drone.attitude_known


SILENCES = (fix_too_old, own_unknown, attitude_unknown)
"""What an outage leads to; it passes."""


def _is_heard(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return not any(is_silent(s, a, c) for is_silent in SILENCES)


HEARD = Test("heard", frozenset({Phase.ABORT}), _is_heard, lambda c: c.abort.heard_hold_s)
"""The vehicle and the autopilot are, without a break."""
