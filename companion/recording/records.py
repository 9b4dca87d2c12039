"""What a companion hands to its recorder: references, which the recorder turns into messages."""

from dataclasses import dataclass
from enum import IntEnum

from companion.landing.state.step_data import StepInputs, StepOutputs
from companion.vehicle.estimator import Estimator, EstimatorMemory
from link.mavlink.statistics import SessionStatistics


class InputKind(IntEnum):
    """By which door of the node something came in."""

    MAVLINK = 0  # data: a piece of the link's stream
    SAMPLE = 1  # key and data: a Zenoh sample
    PAD = 2  # data: the vehicle's description of its pad, JSON
    ALIVE = 3  # data: 1 or 0
    COMMAND = 4  # data: the order as JSON
    POLL = 5  # no data
    LEAVE = 6  # no data
    DATAGRAM = 7  # data: whole frames of the link
    RIVAL = 8  # data: a drone's name, then 1 for this one or 0; none where there is no rival
    PAD_DOUBTED = 9  # no data


@dataclass(frozen=True, slots=True, kw_only=True)
class InputRecord:
    """One call of the node's; in the order of `sequence` they are all that decides what it does."""

    sequence: int
    kind: InputKind
    local_ns: int
    key: str = ""
    data: bytes = b""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepRecord:
    """One step; `estimator_memory` is the one after it, `utc_known` whether its time is UTC."""

    local_ns: int
    utc_known: bool
    inputs: StepInputs
    outputs: StepOutputs
    estimator: Estimator
    estimator_memory: EstimatorMemory | None


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkRecord:
    """The counters of the links."""

    t_ns: int
    session: SessionStatistics
    zenoh_bad_payloads: int
    records_dropped: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StepTimeRecord:
    """How long it took from the bytes that led to a step until its setpoint was sent."""

    t_ns: int
    state_to_setpoint_s: float


Record = InputRecord | StepRecord | LinkRecord | StepTimeRecord


def size_of(record: Record) -> int:
    """Return how many bytes a record holds that somebody else has sent: all else is small."""
    return len(record.data) if isinstance(record, InputRecord) else 0
