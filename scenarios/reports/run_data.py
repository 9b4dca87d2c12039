"""A recorded run as arrays for figures: truth, what the companion believed, its phases; seconds from the start.

Frames: W world ENU; V the vehicle's body. Where a companion's recording has no truth beside it, there are no figures.
"""

import json
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeInt, ValidationError

from companion.config.companion import CompanionConfig
from companion.recording.folder import STEM as COMPANION
from link.errors import UserError
from link.messages import BodyTruth
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import fields_of
from link.program.text import read_bounded
from link.program.toml_config import parse_toml, validate
from link.recording.mcap_reader import RecordingHead, read_head, read_messages, recording_files
from link.units import NS_PER_S
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.recordings.truth_file import STEM as TRUTH
from scenarios.recordings.truth_file import read_truth
from scenarios.reports.estimate_track import EstimateTrack, Fields, estimate_track, time_s
from scenarios.scoring.truth_log import TruthLog, truth_log

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class PhaseSpan:
    """A phase and when it lasted."""

    phase: str
    reason: str
    from_s: float
    to_s: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunData:
    """A run.

    Attributes:
        name: of its folder.
        result: as `result.json` has it.
        scenario: that was flown.
        config: of the companion.
        head: of the truth's recording, with the versions.
        log: the truth.
        t_s: (n,) its times.
        vehicle_velocity_enu_m_s: (n, 3).
        phases: in their order.
        estimate: None when the companion estimated nothing.
    """

    name: str
    result: dict[str, Any]
    scenario: Scenario
    config: CompanionConfig
    head: RecordingHead
    log: TruthLog
    t_s: Array
    vehicle_velocity_enu_m_s: Array
    phases: tuple[PhaseSpan, ...]
    estimate: EstimateTrack | None


def read_run(folder: Path) -> RunData:
    """Return the run in `folder`.

    Raises:
        UserError: it is not one, or was not recorded.
    """
    result = read_result(folder / "result.json")
    truth_head = read_head(recording_files(folder, TRUTH)[0])
    head = read_head(recording_files(folder, COMPANION)[0])
    scenario = validate(Scenario, _attached(truth_head, "scenario.toml"), source="scenario.toml")
    config = validate(CompanionConfig, _attached(head, "companion.toml"), source="companion.toml")
    keys = head.keys
    truth = read_truth(folder, keys)
    try:
        log = truth_log(truth.drone, truth.vehicle, truth.rotors)
    except ValueError as error:
        raise UserError(f"{folder}: its truth shows no run ({error}); was it broken off?") from None
    start_ns = int(log.t_ns[0])
    t_s = (log.t_ns - start_ns) / NS_PER_S
    antenna = log.vehicle_position_enu_m + _turn(log, scenario.vehicle.antenna_flu_m)
    steps, estimates, own = _beliefs(folder, keys)
    return RunData(
        name=folder.resolve().name,
        result=result,
        scenario=scenario,
        config=config,
        head=truth_head,
        log=log,
        t_s=t_s,
        vehicle_velocity_enu_m_s=np.gradient(log.vehicle_position_enu_m, t_s, axis=0),
        phases=_phases(steps, start_ns, float(t_s[-1])),
        estimate=estimate_track(estimates, own, log, antenna, scenario),
    )


def read_result(path: Path) -> dict[str, Any]:
    """Return the table of a `result.json`.

    Raises:
        UserError: it cannot be read, or is no result.
    """
    try:
        table = json.loads(read_bounded(path))
    except (OSError, ValueError, RecursionError):
        raise UserError(f"{path}: cannot be read; is this the folder of a run that ended?") from None
    if not isinstance(table, dict):
        raise UserError(f"{path}: is no result: it has to be one object")
    try:
        _Result.model_validate(table)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise UserError(f"{path}: is no result of a run ({where}: {first['msg']})") from None
    return table


class _Shown(BaseModel):
    """What is shown of a result by name; the rest is shown as it is."""

    model_config = ConfigDict(strict=True)


class _Anew(_Shown):
    at_s: FiniteFloat
    phase: str
    lowest_m: FiniteFloat | None
    reason_code: str
    reason: str


class _Approach(_Shown):
    from_s: FiniteFloat
    to_s: FiniteFloat
    ended: str | None
    lowest_m: FiniteFloat | None
    reason_code: str
    reason: str
    begun_anew: list[_Anew]


class _Result(_Shown):
    scenario: str
    seed: int | str
    tier: str
    reason: str
    contact_s: FiniteFloat | None = None
    approaches: list[_Approach] = []
    nees_mean: FiniteFloat | None = None
    nis_sum: FiniteFloat | None = None
    nis_dof: NonNegativeInt | None = None


def _attached(head: RecordingHead, name: str) -> dict[str, Any]:
    return parse_toml(head.attachment(name), f"{name} of {head.path}")


def _turn(log: TruthLog, vector_flu: tuple[float, float, float]) -> Array:
    """Return a vector of V in W, (n, 3): R_WV is R_WB times the inverse of R_VB."""
    rotation_wv = log.rotation @ np.swapaxes(log.rotation_vb, 1, 2)
    return np.asarray(rotation_wv @ np.array(vector_flu))


def _beliefs(folder: Path, keys: Keys) -> tuple[list[Fields], list[Fields], list[BodyTruth]]:
    """Return the fields of the steps and of the estimates, and the drone as its autopilot reported it."""
    found: dict[str, list[Fields]] = {keys.record("step"): [], keys.record("estimate"): []}
    own: list[BodyTruth] = []
    for recorded in read_messages(recording_files(folder, COMPANION)):
        message = recorded.message
        try:
            if message.topic in found:
                found[message.topic].append(fields_of(message.payload, message.type_name))
            elif message.topic == keys.record("own"):
                own.append(cdr.decode(BodyTruth, message.payload))
        except PayloadError as error:
            raise UserError(f"{folder}: the companion's recording is damaged ({error})") from None
    return found[keys.record("step")], found[keys.record("estimate")], own


def _phases(steps: list[Fields], start_ns: int, end_s: float) -> tuple[PhaseSpan, ...]:
    changes: list[tuple[float, str, str]] = []
    for fields in steps:
        t_s = time_s(fields, start_ns)
        if t_s >= 0.0 and (not changes or changes[-1][1] != fields["phase"]):
            changes.append((t_s, fields["phase"], fields["reason"]))
    closed = [*changes, (end_s, "", "")]
    return tuple(
        PhaseSpan(phase=phase, reason=reason, from_s=from_s, to_s=to_s)
        for (from_s, phase, reason), (to_s, _, _) in pairwise(closed)
    )
