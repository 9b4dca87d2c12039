"""A condition of a step's facts with the time that it must hold before it counts, and those of silence; pure."""

from collections.abc import Callable
from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.landing.memory import Held
from companion.situation.phases import LANDING_PHASES, Phase
from companion.situation.situation import Situation


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """What must be true without a break for a while.

    Attributes:
        reason: that it gives, one of its own.
        phases: in which it is asked.
        is_true: of a step's facts.
        hold_s: for how long before it counts.
        cause: what is told of it, where that takes more than the reason.
        is_outage: it passes, and an approach that it breaks off goes on after it.
        anew_max: how often in one approach it leads to aligning or chasing again; then it is unsafe.
    """

    reason: Reason
    phases: frozenset[Phase]
    is_true: Callable[[Situation, CompanionConfig], bool]
    hold_s: Callable[[CompanionConfig], float] = lambda _: 0.0
    cause: Callable[[Situation, CompanionConfig], Cause] | None = None
    is_outage: bool = False
    anew_max: Callable[[CompanionConfig], int] | None = None


def holds(condition: Condition, held: Held, s: Situation, config: CompanionConfig) -> bool:
    """Return whether a condition has been true for its hold time."""
    since_ns = held.get(condition.reason)
    return since_ns is not None and (s.monotonic_ns - since_ns) * 1e-9 >= condition.hold_s(config)


def cause_of(condition: Condition, s: Situation, config: CompanionConfig) -> Cause:
    """Return what is told of a condition that is true."""
    return Cause(condition.reason) if condition.cause is None else condition.cause(s, config)


def is_fix_old(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the vehicle has been silent for too long."""
    age_s = s.vehicle.fix_age_s
    return s.pad is None or age_s is None or age_s > c.abort.fix_age_max_s


def is_drone_unknown(s: Situation, _: CompanionConfig) -> bool:
    """Return whether nobody knows where the drone is."""
    return s.drone is None


def is_attitude_unknown(s: Situation, _: CompanionConfig) -> bool:
    """Return whether nobody knows which way the drone looks and leans: sightings of the pad are turned by it."""
    return s.drone is not None and not s.drone.attitude_known


def _is_heard(s: Situation, c: CompanionConfig) -> bool:
    return not any(silence.is_true(s, c) for silence in SILENCES)


SILENCES = (
    Condition(reason=Reason.VEHICLE_DATA_OLD, phases=LANDING_PHASES, is_true=is_fix_old, is_outage=True),
    Condition(reason=Reason.OWN_POSITION_OLD, phases=LANDING_PHASES, is_true=is_drone_unknown, is_outage=True),
    Condition(reason=Reason.OWN_ATTITUDE_OLD, phases=LANDING_PHASES, is_true=is_attitude_unknown, is_outage=True),
)
"""Of the vehicle, or of the autopilot."""

VEHICLE_SILENT, *AUTOPILOT_SILENT = SILENCES

HEARD = Condition(
    reason=Reason.HEARD,
    phases=frozenset({Phase.ABORT}),
    is_true=_is_heard,
    hold_s=lambda c: c.abort.heard_hold_s,
)
"""The vehicle and the autopilot are, without a break."""
