"""An approach that is broken off on purpose, and the next one: how high the climb went, and whether that one landed.

Heights are those of the drone's feet over the pad, on ground truth.
"""

from dataclasses import dataclass

import numpy as np

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.units import NS_PER_S
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import with_firmware
from scenarios.config import FirmwareName
from scenarios.faults.flight import FaultFlight
from scenarios.recordings.approaches import approaches_of
from scenarios.recordings.result import LANDED, score_run
from scenarios.scoring.score import Tier
from scenarios.scoring.touchdown import rules_of
from scenarios.scoring.truth_log import TruthLog, truth_log
from sim_autopilot.physics.contact import GEAR_HEIGHT_M


@dataclass(frozen=True, slots=True, kw_only=True)
class RetryCase:
    """An approach to be broken off.

    Attributes:
        scenario: by its name.
        firmware: of the drone.
        height_m: at which the descent is broken off.
        seed: of everything random.
    """

    scenario: str
    firmware: FirmwareName
    height_m: float
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Retried:
    """What became of it.

    Attributes:
        case: what was flown.
        tier: on ground truth, in the end.
        judged: why.
        lands_at_once: the approach after the one that was broken off is the one that landed.
        overshoot_m: of the highest point before the next descent beyond the height that the climb is meant for; None
            when the descent was not broken off or nothing came after it.
        takes_s: from the breaking off to the contact; None without one.
        reasons: why further approaches were broken off.
    """

    case: RetryCase
    tier: Tier
    judged: str
    lands_at_once: bool
    overshoot_m: float | None
    takes_s: float | None
    reasons: tuple[str, ...]


def fly_retry(case: RetryCase) -> Retried:
    """Break the first descent off at the case's height, and fly on until the run is over, in lockstep."""
    scenario = load_scenario(with_firmware(case.scenario, case.firmware))
    flight = FaultFlight(scenario, case.seed)
    flight.break_off_at(case.height_m)
    flight.run()
    scored = score_run(scenario, case.seed, flight.recording)
    log = truth_log(flight.recording.drone, flight.recording.vehicle, flight.recording.rotors)
    approaches = approaches_of(flight.recording.statuses, log, rules_of(scenario).box.roof_height_m)
    broken = next(
        (n for n, one in enumerate(approaches) if one.reason_code == Reason.OPERATOR_ABORTS.name), len(approaches)
    )
    further = approaches[broken + 1 :]
    contact = scored.touchdown
    return Retried(
        case=case,
        tier=scored.tier,
        judged=scored.reason,
        lands_at_once=scored.tier in LANDED and len(further) == 1,
        overshoot_m=_highest_m(flight, log, approaches[broken].to_ns) - _meant_m(flight) if further else None,
        takes_s=(contact.contact_t_ns - approaches[broken].to_ns) / NS_PER_S if contact and further else None,
        reasons=tuple(one.reason_code for one in further if one.ended == Phase.ABORT.value),
    )


def _meant_m(flight: FaultFlight) -> float:
    return flight.scenario.system.companion.abort.height_m


def _highest_m(flight: FaultFlight, log: TruthLog, from_ns: int) -> float:
    """Return the highest point between the abort at `from_ns` and the descent after it."""
    descents = (
        status.stamp_ns
        for status in flight.recording.statuses
        if status.stamp_ns > from_ns and status.phase == Phase.DESCEND.value
    )
    first, last = np.searchsorted(log.t_ns, (from_ns, next(descents, int(log.t_ns[-1]))))
    roof_m = flight.scenario.vehicle.roof_height_m
    return float(log.position_v_m[first : last + 1, 2].max()) - roof_m - GEAR_HEIGHT_M


def lost(case: RetryCase, why: str) -> Retried:
    """Return what stands for a case whose process ended."""
    return Retried(
        case=case, tier=Tier.UNSAFE, judged=why, lands_at_once=False, overshoot_m=None, takes_s=None, reasons=()
    )
