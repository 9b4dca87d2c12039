"""What the companion's wire loop is given: how it runs, what connects it with the world, where its times are kept."""

import time
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

import psutil  # type: ignore[import-untyped]  # it has no annotations

from link.mavlink.signing_memory import SigningMemory
from link.transports.device import opening_of
from link.transports.opening import Transport
from link.zenoh.keys import Keys
from link.zenoh.library_config import openings
from link.zenoh.options import ZenohOptions
from link.zenoh.session import ZenohSession

_DURATIONS_MAX = 200_000  # steps whose durations are kept, over an hour's worth


@dataclass(slots=True)
class Timings:
    """How long the loop took, in wall seconds."""

    state_to_setpoint_s: deque[float] = field(default_factory=lambda: deque(maxlen=_DURATIONS_MAX))
    started_s: float = field(default_factory=time.perf_counter)
    started_cpu_s: float = field(default_factory=time.process_time)

    def summary(self) -> dict[str, float | int]:
        """Return what belongs into a timing file.

        `memory_mb` counts what is resident; `own_memory_mb` leaves out what other processes share and what can be read
        again from files, such as a library's code.
        """
        ordered = sorted(self.state_to_setpoint_s)
        wall_s = time.perf_counter() - self.started_s
        memory = psutil.Process().memory_full_info()

        def quantile_ms(share: float) -> float:
            return round(1e3 * ordered[min(int(share * len(ordered)), len(ordered) - 1)], 4) if ordered else 0.0

        return {
            "steps": len(ordered),
            "state_to_setpoint_median_ms": quantile_ms(0.5),
            "state_to_setpoint_p99_ms": quantile_ms(0.99),
            "state_to_setpoint_max_ms": quantile_ms(1.0),
            "cpu_share": round((time.process_time() - self.started_cpu_s) / wall_s, 4),
            "memory_mb": round(memory.rss / 1e6, 1),
            "own_memory_mb": round(memory.uss / 1e6, 1),
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopOptions:
    """How the loop runs.

    Attributes:
        device: of the MAVLink link, for messages.
        timeout_s: without an autopilot or, with `start`, a vehicle; 0 waits for ever.
        start: start the landing without an operator.
        dry_run: no setpoints and no commands are sent.
        use_sim_time: follow `{ns}/clock` instead of the system's clock.
        tlog: file to record MAVLink into.
        open_to_strangers: links by which somebody without a key could take part, in words.
    """

    device: str
    timeout_s: float
    start: bool
    dry_run: bool
    use_sim_time: bool
    tlog: Path | None
    open_to_strangers: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Links:
    """What connects the node with the world; `signing` is where signatures are remembered, if there are any."""

    keys: Keys
    transport: Transport
    zenoh: ZenohSession
    signing: SigningMemory | None = None


def open_links(zenoh: ZenohOptions, device: str, *, signs: bool) -> tuple[str, ...]:
    """Return which links are open to somebody without a key, in words.

    Args:
        zenoh: how the Zenoh session was opened.
        device: of the MAVLink link.
        signs: whether MAVLink is signed.
    """
    mavlink = opening_of(device, signs=signs)
    return (*openings(zenoh), *(() if mavlink is None else (mavlink,)))
