"""The approaches of a run, from statuses and truth of the tests' own making."""

from typing import Any

import numpy as np
import pytest

from companion.core.reasons import Cause, Reason, sentence
from companion.situation.phases import Phase
from link.messages import BodyTruth, LandingStatus, RotorTruth
from link.records import replace
from scenarios.commands.run_lines import approach_lines
from scenarios.recordings.approaches import Approach, approaches_of
from scenarios.recordings.reason_counts import abort_reasons, add_counts, counts_of, counts_text, reasons_in
from scenarios.recordings.recording import TIME_LIMIT, Recording
from scenarios.scoring.truth_log import TruthLog, truth_log
from tests.scenarios.statuses import status_of

START_NS = 1_800_000_000_000_000_000
ROOF_M = 1.5
STANDING_M = 0.12  # of the centre of mass over the feet
Step = tuple[float, Phase, Reason]

CHASE = (2.0, Phase.CHASE, Reason.VEHICLE_PASSES)
ALIGN = (4.0, Phase.ALIGN, Reason.OVER_PAD)
DESCEND = (6.0, Phase.DESCEND, Reason.ALIGNED)


def at_ns(t_s: float) -> int:
    return START_NS + round(t_s * 1e9)


def height_m(t_s: float) -> float:
    """Of the feet over the pad: sinks by 0.4 m/s from 5 m."""
    return 5.0 - 0.4 * t_s


def log() -> TruthLog:
    times_s = np.arange(0.0, 20.0, 0.01).tolist()
    drone = [body(t_s, (0.3, -0.2, ROOF_M + STANDING_M + height_m(t_s))) for t_s in times_s]
    return truth_log(drone, [body(t_s, (0.0, 0.0, 0.0)) for t_s in times_s], list[RotorTruth]())


def body(t_s: float, position: tuple[float, float, float]) -> BodyTruth:
    still = (0.0, 0.0, 0.0)
    return BodyTruth(
        t_ns=at_ns(t_s),
        position_enu_m=position,
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=still,
        angular_velocity_flu_rad_s=still,
    )


def status(t_s: float, phase: Phase, reason: Reason) -> LandingStatus:
    said = status_of(at_ns(t_s), phase)
    return replace(said, reason=f"because of {reason.name}", reason_code=reason.name)


def approaches(*steps: Step) -> list[Approach]:
    """Return the approaches of a flight that says each step twice."""
    waits = (1.0, Phase.WAITING, Reason.AT_WAITING_POINT)
    said = [status(t_s + late_s, phase, why) for t_s, phase, why in (waits, *steps) for late_s in (0.0, 0.02)]
    return approaches_of(said, log(), ROOF_M)


def test_approach_lasts_from_the_chase_to_the_touchdown_that_lasts() -> None:
    contact, off = (11.0, Phase.TOUCHDOWN, Reason.CONTACT), (12.0, Phase.SECURED, Reason.MOTORS_OFF)
    (found,) = approaches(CHASE, ALIGN, DESCEND, contact, off)
    assert (found.from_ns, found.to_ns) == (at_ns(2.0), at_ns(11.0))
    assert (found.ended, found.reason_code) == ("touchdown", "CONTACT")
    assert found.reason == "because of CONTACT"
    assert found.lowest_m == pytest.approx(height_m(11.0), abs=1e-3)


def test_contact_that_is_lost_is_an_approach_that_was_broken_off() -> None:
    contact, lost = (11.0, Phase.TOUCHDOWN, Reason.CONTACT), (11.5, Phase.ABORT, Reason.ABOVE_AFTER_CONTACT)
    (found,) = approaches(CHASE, ALIGN, DESCEND, contact, lost)
    assert (found.ended, found.reason_code, found.to_ns) == ("abort", "ABOVE_AFTER_CONTACT", at_ns(11.5))


@pytest.mark.parametrize("phase", [Phase.ABORT, Phase.HOLD, Phase.PILOT])
@pytest.mark.parametrize("last", [CHASE, ALIGN, DESCEND])
def test_approach_is_ended_by_abort_hold_and_pilot_from_each_phase(phase: Phase, last: Step) -> None:
    before = [one for one in (CHASE, ALIGN, DESCEND) if one[0] <= last[0]]
    (found,) = approaches(*before, (9.0, phase, Reason.OPERATOR_ABORTS))
    assert (found.ended, found.reason_code, found.to_ns) == (phase.value, "OPERATOR_ABORTS", at_ns(9.0))


def test_each_retry_is_an_approach_of_its_own() -> None:
    first, second = (7.0, Phase.ABORT, Reason.OUTSIDE_CONE), (10.0, Phase.ABORT, Reason.SETPOINT_NOT_FOLLOWED)
    again, given_up = (8.0, Phase.CHASE, Reason.RETRY), (11.0, Phase.HOLD, Reason.NO_RETRY_LEFT)
    found = approaches(CHASE, ALIGN, DESCEND, first, again, second, given_up)
    assert [one.reason_code for one in found] == ["OUTSIDE_CONE", "SETPOINT_NOT_FOLLOWED"]
    assert found[1].from_ns == at_ns(8.0)


def test_approach_that_goes_back_goes_on_and_tells_why() -> None:
    strays, lost = (8.0, Phase.ALIGN, Reason.STRAYS), (8.5, Phase.CHASE, Reason.ALIGNMENT_LOST)
    over, abort = (9.0, Phase.ALIGN, Reason.OVER_PAD), (10.0, Phase.ABORT, Reason.ALIGN_TOO_LONG)
    (found,) = approaches(CHASE, ALIGN, DESCEND, strays, lost, over, abort)
    assert [(one.phase, one.reason_code) for one in found.begun_anew] == [
        ("align", "STRAYS"),
        ("chase", "ALIGNMENT_LOST"),
    ]
    assert [one.lowest_m for one in found.begun_anew] == pytest.approx([height_m(8.0), height_m(8.5)], abs=1e-3)
    assert found.reason_code == "ALIGN_TOO_LONG"


def test_approach_that_is_under_way_at_the_end_has_none() -> None:
    (found,) = approaches(CHASE, ALIGN)
    assert (found.ended, found.to_ns) == (None, at_ns(4.02))


def test_flight_without_a_chase_has_no_approach() -> None:
    assert approaches() == []
    assert approaches_of([], log(), ROOF_M) == []


def test_counts_are_the_same_after_they_were_written_as_text() -> None:
    reasons = ["STRAYS", "CONTACT", "STRAYS", "BELOW_PAD"]
    text = counts_text(counts_of(reasons))
    assert text == "STRAYS 2, BELOW_PAD 1, CONTACT 1"
    assert sorted(reasons_in(text)) == sorted(reasons)
    assert reasons_in("") == []
    assert add_counts([{"A": 1}, {"A": 1, "B": 3}]) == {"B": 3, "A": 2}


def result(found: list[Approach], ended: str, why: Cause) -> dict[str, Any]:
    told = [one.to_json(START_NS) for one in found]
    return {
        "approaches": told,
        "ended": ended,
        "ended_reason": sentence(why),
        "ended_reason_code": why.reason.name,
    }


def test_lines_tell_of_each_approach_why_it_was_broken_off() -> None:
    strays, first = (7.0, Phase.ALIGN, Reason.STRAYS), (8.0, Phase.ABORT, Reason.OUTSIDE_CONE)
    again, second = (9.0, Phase.CHASE, Reason.RETRY), (10.0, Phase.ABORT, Reason.SETPOINT_NOT_FOLLOWED)
    found = approaches(CHASE, ALIGN, DESCEND, strays, first, again, second)
    table = result(found, "hold", Cause(Reason.NO_RETRY_LEFT, ("too fast",)))
    assert abort_reasons(table["approaches"]) == ["OUTSIDE_CONE", "SETPOINT_NOT_FOLLOWED"]
    heading, anew, one, two, ended, why = approach_lines(table)
    assert heading == "approaches"
    assert " ".join(anew.split()) == "1 back at 7.0 s lowest 2.20 m to align: because of STRAYS (STRAYS)"
    assert " ".join(one.split()).startswith("1 2.0 s to 8.0 s lowest 1.80 m broken off: ")
    assert two.endswith("broken off: because of SETPOINT_NOT_FOLLOWED (SETPOINT_NOT_FOLLOWED)")
    assert ended == "it ended in hold: no retry left: too fast (NO_RETRY_LEFT)"
    assert why == "approaches were broken off by OUTSIDE_CONE 1, SETPOINT_NOT_FOLLOWED 1"


def test_lines_of_a_landing_are_those_of_its_approaches_only() -> None:
    contact, off = (11.0, Phase.TOUCHDOWN, Reason.CONTACT), (12.0, Phase.SECURED, Reason.MOTORS_OFF)
    table = result(approaches(CHASE, ALIGN, DESCEND, contact, off), "secured", Cause(Reason.MOTORS_OFF))
    assert len(list(approach_lines(table))) == 2


def test_height_that_is_nothing_has_no_sign() -> None:
    table = result(approaches(CHASE, ALIGN, DESCEND), "descend", Cause(Reason.ALIGNED))
    table["approaches"][0]["lowest_m"] = -0.004
    assert " lowest 0.00 m " in " ".join(list(approach_lines(table))[1].split())


def test_run_at_its_time_limit_ended_in_what_was_waited_for_before_it_was_called_off() -> None:
    waits = status(1.0, Phase.WAITING, Reason.HEADING_UNKNOWN)
    recording = Recording(statuses=[waits, status(2.0, Phase.HOLD, Reason.OPERATOR_ABORTS)])
    assert recording.status_at_end(TIME_LIMIT) is waits
    assert recording.status_at_end(Phase.HOLD.value) is recording.statuses[-1]
