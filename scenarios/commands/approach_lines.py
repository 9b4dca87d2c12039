"""What a person is told of a run's approaches: when, how low, and why each ended."""

from collections.abc import Iterator, Mapping
from typing import Any

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from scenarios.recordings.reason_counts import abort_reasons, counts_of, counts_text

_GIVEN_UP = Reason.NO_RETRY_LEFT.name
_ENDS = {None: "not ended", Phase.ABORT.value: "broken off", Phase.TOUCHDOWN.value: "touchdown"}


def approach_lines(result: Mapping[str, Any]) -> Iterator[str]:
    """Yield a line for each approach of a run's result, one for each time that it went back, and one for its end.

    Args:
        result: as `result.json` has it.
    """
    approaches = result["approaches"]
    if approaches:
        yield "approaches"
    for number, one in enumerate(approaches, 1):
        for anew in one["begun_anew"]:
            when = f"{number:3}{'':9} back at {anew['at_s']:6.1f} s"
            yield f"{when}  lowest {_height(anew)}  to {anew['phase']}: {_why(anew)}"
        when = f"{number:3} {one['from_s']:6.1f} s to {one['to_s']:7.1f} s"
        yield f"{when}  lowest {_height(one)}  {_ENDS.get(one['ended'], one['ended'])}: {_why(one)}"
    if result["ended_reason"] is not None and result["ended"] != Phase.SECURED.value:
        yield f"it ended in {result['ended']}: {result['ended_reason']} ({result['ended_reason_code']})"
    if result["ended_reason_code"] == _GIVEN_UP:
        yield f"approaches were broken off by {counts_text(counts_of(abort_reasons(approaches)))}"


def _height(one: Mapping[str, Any]) -> str:
    return f"{'-':>8}" if one["lowest_m"] is None else f"{one['lowest_m']:6.2f} m"


def _why(one: Mapping[str, Any]) -> str:
    return f"{one['reason']} ({one['reason_code']})"
