"""What `companion --foxglove` costs: a landing's inputs given to a companion in real time; a client reads all.

The server's and the recorder's threads are told from the one of the steps by their processor time; the client is a
process of its own.
"""

import json
import subprocess
import sys
import time
from typing import Any

from companion.recording.sink import CompanionSink
from companion.runtime.build import build_node
from link.errors import UserError
from link.payloads.decklander_msgs import RosMessage
from link.recording.foxglove_server import FoxgloveServer
from link.recording.recorder import BackgroundRecorder
from link.units import NS_PER_S
from link.zenoh.keys import Keys
from scenarios.bench.foxglove_client import CONNECTED
from scenarios.bench.recording import FlownInputs
from scenarios.config import Scenario
from scenarios.recordings.replay import give

_WAIT_S = 20.0


def foxglove_cost(scenario: Scenario, flown: FlownInputs) -> dict[str, Any]:
    """Measure the live view of a landing.

    Args:
        scenario: what was flown.
        flown: its inputs.

    Returns:
        `latency_ms`: from what a message tells of, the step's inputs, until the client has it; `cpu_share`: of a core,
        of all threads but the steps'; `messages_hz`: that came.

    Raises:
        UserError: no client could connect.
    """
    server = FoxgloveServer(0)
    command = (sys.executable, "-m", "scenarios.bench.foxglove_client", str(server.port))
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as client:
        if client.stdout is None or client.stdout.readline().strip() != CONNECTED:
            raise UserError("no client could connect to the Foxglove server: is decklander[view] installed?")
        store = _WallTimes(server)
        recorder = BackgroundRecorder(CompanionSink(store, Keys(), scenario.system.companion.descent))
        began_s, began_ns = time.perf_counter(), time.process_time_ns() - time.thread_time_ns()
        _give_in_real_time(scenario, flown, store, recorder)
        recorder.close()
        cpu_s = (time.process_time_ns() - time.thread_time_ns() - began_ns) / NS_PER_S
        elapsed_s = time.perf_counter() - began_s
        told = json.loads(client.communicate(timeout=_WAIT_S)[0])
    return {
        "latency_ms": told["latency_ms"],
        "cpu_share": round(cpu_s / elapsed_s, 4),
        "messages_hz": round(told["messages"] / elapsed_s, 1),
    }


class _WallTimes:
    """Serves messages with the time of this machine's clock at which they would have been recorded."""

    def __init__(self, server: FoxgloveServer) -> None:
        self._server = server
        self.wall_from_utc_ns = 0

    def add(self, message: RosMessage, log_ns: int) -> None:
        self._server.add(message, log_ns + self.wall_from_utc_ns)

    def close(self) -> None:
        self._server.close()


def _give_in_real_time(scenario: Scenario, flown: FlownInputs, store: _WallTimes, recorder: BackgroundRecorder) -> None:
    node = build_node(scenario.system.companion, Keys(), recorder=recorder)
    first_ns = next(record.local_ns for record in flown.records if record.local_ns)
    began_ns = time.time_ns()
    store.wall_from_utc_ns = began_ns - first_ns - flown.utc_from_local_ns
    for record in flown.records:
        if record.local_ns:
            time.sleep(max(0.0, (record.local_ns - first_ns - (time.time_ns() - began_ns)) / NS_PER_S))
        give(node, record)
