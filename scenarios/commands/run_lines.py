"""What a person sees of a run: progress while it lasts, the score at its end."""

import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.messages import LandingStatus
from link.program.screen import Screen
from link.program.status_rows import Row
from scenarios.config import Scenario
from scenarios.recordings.reason_counts import abort_reasons, counts_of, counts_text
from scenarios.recordings.recording import Recording
from scenarios.recordings.result import LANDED
from scenarios.recordings.run_folder import RunOutcome
from scenarios.scoring.score import Tier

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
    return f"{'-':>8}" if one["lowest_m"] is None else f"{one['lowest_m']:z6.2f} m"


def _why(one: Mapping[str, Any]) -> str:
    return f"{one['reason']} ({one['reason_code']})"


_OF_LANDING = frozenset({"ended", "reason", "tier", "tier_reason"})
_PLAIN_EVERY_S = 2.0  # simulated, between lines that are not overwritten


class Reporter:
    """Shows a run: a panel on a terminal, plain lines elsewhere.

    Args:
        scenario: what is flown.
        folder: of the run.
        as_json: show nothing but the result, as JSON.
        flies: the firmware, or what else is flown; the scenario's own where it is not said.
    """

    def __init__(self, scenario: Scenario, folder: Path, *, as_json: bool, flies: str | None = None) -> None:
        self._scenario = scenario
        self._flies = scenario.firmware if flies is None else flies
        self._folder = folder
        self._as_json = as_json
        self._screen = Screen(f"{scenario.name} in {folder}") if sys.stdout.isatty() and not as_json else None
        self._phase = ""
        self._shown_s = 0.0

    def __enter__(self) -> Self:
        if not self._as_json:
            sys.stdout.write(f"{self._scenario.name}, {self._flies}: {self._scenario.description}\n")
        if self._screen is not None:
            self._screen.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._screen is not None:
            self._screen.stop()

    def progress(self, recording: Recording, factor: float) -> None:
        """Show how far the run is."""
        status = recording.status
        if self._as_json or status is None:
            return
        is_new, self._phase = status.phase != self._phase, status.phase
        line = _progress_line(recording, status, factor)
        if self._screen is not None:
            if is_new:
                self._screen.write_above(line)
            self._screen.show(status, _run_rows(recording, status, factor))
        elif is_new or recording.elapsed_s - self._shown_s >= _PLAIN_EVERY_S:
            self._shown_s = recording.elapsed_s
            sys.stdout.write(f"{line}\n")
            sys.stdout.flush()

    def conclude(self, outcome: RunOutcome) -> int:
        """Show the result and return the exit code: 0 for a landing, 1 for anything else."""
        if self._as_json:
            table = {**outcome.result, "folder": str(self._folder), "timing": outcome.timing}
            sys.stdout.write(json.dumps(table, indent=2) + "\n")
        else:
            sys.stdout.write("\n".join(_score_lines(outcome.result, outcome.timing)) + f"\n{self._folder}\n")
        return 0 if Tier(outcome.result["tier"]) in LANDED else 1


def _progress_line(recording: Recording, status: LandingStatus, factor: float) -> str:
    parts = [f"{recording.elapsed_s:6.1f} s", f"{factor:5.2f}x", f"{status.phase:16}"]
    if status.relative_position_enu_m is not None and status.relative_velocity_enu_m_s is not None:
        x_m, y_m, z_m = status.relative_position_enu_m
        vx_m_s, vy_m_s, _ = status.relative_velocity_enu_m_s
        parts.append(f"distance {(x_m**2 + y_m**2) ** 0.5:6.2f} m  height {z_m:z5.2f} m")
        parts.append(f"relative speed {(vx_m_s**2 + vy_m_s**2) ** 0.5:5.2f} m/s")
    parts.append(status.reason)
    return "  ".join(parts)


def _run_rows(recording: Recording, status: LandingStatus, factor: float) -> list[Row]:
    return [
        ("time, pace", f"{recording.elapsed_s:.1f} s, {factor:.2f}x"),
        ("bad bytes, bad payloads", f"{status.links.mavlink_bad_bytes}, {status.links.zenoh_bad_payloads}"),
    ]


def _score_lines(result: dict[str, Any], timing: dict[str, Any]) -> list[str]:
    lines = ["", f"tier {result['tier']}: {result['reason']}"]
    shown = (
        ("horizontal_error_m", "horizontal error", "m", 1.0),
        ("relative_speed_m_s", "relative speed", "m/s", 1.0),
        ("sink_rate_m_s", "sink rate", "m/s", 1.0),
        ("tilt_over_trim_rad", "tilt over trim", "degrees", 57.29577951308232),
        ("time_to_contact_s", "time from the vehicle's passing to contact", "s", 1.0),
        ("pass_to_contact_s", "the same, from passing where the drone waited", "s", 1.0),
        ("motors_off_s", "motors off after contact", "s", 1.0),
        ("slid_m", "slid", "m", 1.0),
    )
    for key, label, unit, scale in shown:
        if result.get(key) is not None:
            lines.append(f"  {label:46}{result[key] * scale:8.3f} {unit}")
    lines.append(f"  {'real-time factor':46}{timing['real_time_factor']:8.3f}")
    lines += sortie_lines(result["sortie"]) if "sortie" in result else ()
    return [*lines, *approach_lines(result)]


def sortie_lines(sortie: Mapping[str, Any]) -> Iterator[str]:
    """Yield a line for each figure of a sortie, which is no landing's.

    Args:
        sortie: as `result.json` has it.
    """
    yield "sortie"
    yield from (f"  {name:46}{value}" for name, value in sortie.items() if name not in _OF_LANDING)
