"""The approaches of a run: from each chase's beginning to the touchdown, or to what broke it off, and why.

Times and reasons are those of the companion's status, heights those of truth.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from companion.situation.phases import Phase
from link.messages import LandingStatus
from link.units import NS_PER_S
from scenarios.scoring.truth_log import Array, TruthLog
from sim_autopilot.physics.contact import GEAR_HEIGHT_M

_DIGITS = 3  # a millimetre, a millisecond
_ORDER = {Phase.CHASE.value: 0, Phase.ALIGN.value: 1, Phase.DESCEND.value: 2, Phase.TOUCHDOWN.value: 3}
"""The phases of an approach; one that follows a later one begins it again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Anew:
    """An approach that goes back, from a descent into alignment or from there into a chase, and is not ended by it.

    Attributes:
        t_ns: when.
        phase: that it goes back to.
        lowest_m: of the drone's feet over the pad since the approach, or its part before, began; None without truth.
        reason_code: name of the reason.
        reason: its sentence.
    """

    t_ns: int
    phase: str
    lowest_m: float | None
    reason_code: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Approach:
    """One approach.

    Attributes:
        from_ns: when it began.
        to_ns: when it ended.
        ended: the phase that ended it, a touchdown where the contact lasted; None where the run ended before.
        lowest_m: of the drone's feet over the pad; None without truth.
        reason_code: name of the reason for its end.
        reason: its sentence.
        begun_anew: how it went back, in order.
    """

    from_ns: int
    to_ns: int
    ended: str | None
    lowest_m: float | None
    reason_code: str
    reason: str
    begun_anew: tuple[Anew, ...]

    def to_json(self, start_ns: int) -> dict[str, Any]:
        """Return the approach as a table of plain values, its times in seconds from `start_ns` on."""
        return {
            "from_s": _since_s(self.from_ns, start_ns),
            "to_s": _since_s(self.to_ns, start_ns),
            "ended": self.ended,
            "lowest_m": self.lowest_m,
            "reason_code": self.reason_code,
            "reason": self.reason,
            "begun_anew": [
                {
                    "at_s": _since_s(anew.t_ns, start_ns),
                    "phase": anew.phase,
                    "lowest_m": anew.lowest_m,
                    "reason_code": anew.reason_code,
                    "reason": anew.reason,
                }
                for anew in self.begun_anew
            ],
        }


def approaches_of(statuses: Sequence[LandingStatus], log: TruthLog, pad_height_m: float) -> list[Approach]:
    """Return the approaches in their order.

    Args:
        statuses: of the companion, in order of time.
        log: truth of the run.
        pad_height_m: over the vehicle's origin.
    """
    height_m = log.position_v_m[:, 2] - pad_height_m - GEAR_HEIGHT_M
    return [_approach(steps, statuses[-1], log, height_m) for steps in _list_approaches(statuses)]


def _list_approaches(statuses: Sequence[LandingStatus]) -> list[list[LandingStatus]]:
    """Return for each approach the statuses with which its phases began, and last of all what ended it, if anything."""
    begun = [*statuses[:1], *(after for before, after in pairwise(statuses) if after.phase != before.phase)]
    found: list[list[LandingStatus]] = []
    goes_on = False
    for status in begun:
        if goes_on:
            found[-1].append(status)
        elif status.phase in _ORDER:
            found.append([status])
        goes_on = status.phase in _ORDER
    return found


def _approach(steps: Sequence[LandingStatus], newest: LandingStatus, log: TruthLog, height_m: Array) -> Approach:
    phases = [step.phase for step in steps]
    stands = phases[-1] == Phase.SECURED.value and phases[-2] == Phase.TOUCHDOWN.value
    end = steps[-2] if stands else steps[-1]
    unfinished = end.phase in _ORDER and end.phase != Phase.TOUCHDOWN.value
    if unfinished:
        end = newest
    begun_anew: list[Anew] = []
    since_ns = steps[0].stamp_ns
    for before, after in pairwise(steps):
        if _ORDER.get(after.phase, len(_ORDER)) < _ORDER[before.phase]:
            begun_anew.append(
                Anew(
                    t_ns=after.stamp_ns,
                    phase=after.phase,
                    lowest_m=_lowest_m(log, height_m, since_ns, after.stamp_ns),
                    reason_code=after.reason_code,
                    reason=after.reason,
                )
            )
            since_ns = after.stamp_ns
    return Approach(
        from_ns=steps[0].stamp_ns,
        to_ns=end.stamp_ns,
        ended=None if unfinished else end.phase,
        lowest_m=_lowest_m(log, height_m, steps[0].stamp_ns, end.stamp_ns),
        reason_code=end.reason_code,
        reason=end.reason,
        begun_anew=tuple(begun_anew),
    )


def _lowest_m(log: TruthLog, height_m: Array, from_ns: int, to_ns: int) -> float | None:
    first, last = np.searchsorted(log.t_ns, (from_ns, to_ns + 1))
    return round(float(height_m[first:last].min()), _DIGITS) if last > first else None


def _since_s(t_ns: int, start_ns: int) -> float:
    return round((t_ns - start_ns) / NS_PER_S, _DIGITS)
