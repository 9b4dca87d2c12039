"""What a bench measures on programs that run alone: their first heartbeat, their help, the simulator's full speed."""

import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.program.clock import ClockTick
from link.transports.opening import open_transport
from link.zenoh.keys import Keys
from link.zenoh.session import Inbox, ZenohOptions, open_session
from scenarios.processes.programs import MODULES, ProcessGroup, Program, free_tcp_endpoint, free_udp_port

_DEADLINE_S = 60.0
_POLL_S = 0.005
_SETTLING_S = 1.0
_MEASURED_S = 4.0  # of wall time, after it has settled
_HELP_REPEATS = 3


def help_times_s() -> dict[str, float]:
    """Return how long `--help` of each program takes, the median of three."""
    return {
        name: round(statistics.median(_help_s(module) for _ in range(_HELP_REPEATS)), 3)
        for name, module in MODULES.items()
    }


def _help_s(module: str) -> float:
    began_s = time.perf_counter()
    subprocess.run([sys.executable, "-m", module, "--help"], stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began_s


def first_heartbeats_s(folder: Path) -> dict[str, float]:
    """Return how long after its start each program on MAVLink sends its first heartbeat.

    Args:
        folder: for the programs' logs.
    """
    return {name: round(_first_heartbeat_s(name, folder), 3) for name in ("sim-autopilot", "companion")}


def _first_heartbeat_s(name: str, folder: Path) -> float:
    port = free_udp_port()
    arguments = ("--mavlink", f"udpout:127.0.0.1:{port}", "-l", "tcp/127.0.0.1:0")
    codec = MavlinkCodec(1, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER)
    with open_transport(f"udpin:127.0.0.1:{port}") as transport:
        began_s = time.perf_counter()
        with ProcessGroup([_alone(name, arguments)], folder) as processes:

            def has_come() -> bool:
                messages = codec.decode(transport.receive(_POLL_S))
                return any(message.get_type() == "HEARTBEAT" for message in messages)

            _wait(has_come, processes, f"a heartbeat of {name}")
            return time.perf_counter() - began_s


def full_speed_factor(folder: Path) -> float:
    """Return how many simulated seconds a second `sim-autopilot --speed 0` makes, alone.

    Args:
        folder: for the program's log.
    """
    endpoint = free_tcp_endpoint()
    arguments = ("--speed", "0", "--mavlink", f"udpout:127.0.0.1:{free_udp_port()}", "-e", endpoint)
    with open_session(ZenohOptions(listen=(endpoint,)), receive_clock_ns=time.perf_counter_ns) as zenoh:
        ticks = zenoh.subscribe(Keys().clock)
        with ProcessGroup([_alone("sim-autopilot", arguments)], folder) as processes:
            _wait(lambda: _newest(ticks) is not None, processes, "the simulator's clock")
            first = _newest_after(ticks, processes, _SETTLING_S)
            last = _newest_after(ticks, processes, _MEASURED_S)
    return (last[1] - first[1]) / (last[0] - first[0])


def _newest_after(ticks: Inbox, processes: ProcessGroup, wait_s: float) -> tuple[int, int]:
    """Return when the newest tick after `wait_s` was received, ns, and its time, ns."""
    time.sleep(wait_s)
    ticks.take()
    found: list[tuple[int, int]] = []

    def has_come() -> bool:
        newest = _newest(ticks)
        found.extend([newest] if newest is not None else [])
        return bool(found)

    _wait(has_come, processes, "the simulator's clock")
    return found[-1]


def _newest(ticks: Inbox) -> tuple[int, int] | None:
    samples = ticks.take()
    try:
        return (samples[-1].received_ns, cdr.decode(ClockTick, samples[-1].payload).t_ns) if samples else None
    except PayloadError:
        return None


def _alone(name: str, arguments: Sequence[str]) -> Program:
    return Program(name=f"{name}-alone", module=MODULES[name], arguments=arguments)


def _wait(has_come: Callable[[], bool], processes: ProcessGroup, what: str) -> None:
    end_s = time.monotonic() + _DEADLINE_S
    while not has_come():
        processes.check()
        if time.monotonic() > end_s:
            raise UserError(f"{what} did not come within {_DEADLINE_S:g} s: the machine is too busy to measure on")
        time.sleep(_POLL_S)
