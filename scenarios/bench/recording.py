"""What recording costs a companion's step: one flight's inputs given to two nodes, with and without, step by step.

The thread of the steps and the recorder's are told apart by their processor time; both nodes meet the same machine.
"""

import statistics
import time
from pathlib import Path
from typing import Any

from companion.recording.folder import recording_sink
from companion.recording.records import InputRecord, StepRecord, size_of
from companion.runtime.build import build_node
from companion.runtime.node import CompanionNode
from link.recording.recorder import BackgroundRecorder
from link.units import NS_PER_S
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.replay import give

_LOOK_S = 0.001
_BLOCK = 25  # steps, after which the recorder catches up: in flight it has most of the time for itself


class FlownInputs:
    """What went into a companion in a landing, to be given to others.

    Attributes:
        records: in their order.
        utc_from_local_ns: UTC less the companion's clock, as it knew it at last.
        elapsed_s: how long the run was.
    """

    dropped = 0
    why_dropped = ""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.records: list[InputRecord] = []
        self.utc_from_local_ns = 0
        flight = Lockstep(scenario, seed, recorder=self)
        flight.run()
        self.elapsed_s = flight.recording.elapsed_s

    def put(self, record: Any) -> None:
        """Keep an input."""
        if isinstance(record, InputRecord):
            self.records.append(record)
        elif isinstance(record, StepRecord):
            self.utc_from_local_ns = record.inputs.t_ns - record.local_ns

    def close(self) -> None:
        """Keep all."""


def recording_cost(scenario: Scenario, flown: FlownInputs, folder: Path) -> dict[str, float]:
    """Measure a flight's recording.

    Args:
        scenario: what was flown.
        flown: its inputs.
        folder: for the recording.

    Returns:
        `step_ratio`: a step's processor time with recording over that without, the median of all steps;
        `writer_cpu_share`: of a core, for the recorder's thread, over the flight's duration; `dropped` records.
    """
    recorder = BackgroundRecorder(recording_sink(folder, scenario.system.companion, Keys()), size_of=size_of)
    nodes = [build_node(scenario.system.companion, Keys(), recorder=one) for one in (None, recorder)]
    began_ns = time.process_time_ns() - time.thread_time_ns()
    steps = _steps(flown.records, nodes, recorder)
    recorder.close()
    writer_s = (time.process_time_ns() - time.thread_time_ns() - began_ns) / NS_PER_S
    return {
        "step_ratio": round(statistics.median(recorded / plain for plain, recorded in steps), 4),
        "writer_cpu_share": round(writer_s / flown.elapsed_s, 4),
        "dropped": recorder.dropped,
    }


def _steps(
    records: list[InputRecord], nodes: list[CompanionNode], recorder: BackgroundRecorder
) -> list[tuple[int, int]]:
    """Return each step's processor time, ns, of both nodes; which of them is first changes from step to step."""
    steps: list[tuple[int, int]] = []
    spent_ns = [0, 0]
    for record in records:
        before = nodes[0].inputs
        for index in (0, 1) if len(steps) % 2 else (1, 0):
            began_ns = time.thread_time_ns()
            give(nodes[index], record)
            spent_ns[index] += time.thread_time_ns() - began_ns
        if nodes[0].inputs is before:
            continue
        steps.append((spent_ns[0], spent_ns[1]))
        spent_ns = [0, 0]
        if len(steps) % _BLOCK == 0:
            _let_catch_up(recorder)
    return steps


def _let_catch_up(recorder: BackgroundRecorder) -> None:
    while recorder.waiting:
        time.sleep(_LOOK_S)
