"""What the companion's wire loop is given: how it runs, and what connects it with the world."""

from dataclasses import dataclass
from pathlib import Path

from link.mavlink.transports import Transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopOptions:
    """How the loop runs.

    Attributes:
        device: of the MAVLink link, for messages.
        timeout_s: without an autopilot or, with `start`, a vehicle; 0 waits for ever.
        start: start the landing without an operator.
        use_sim_time: follow `{ns}/clock` instead of the system's clock.
        tlog: file to record MAVLink into.
    """

    device: str
    timeout_s: float
    start: bool
    use_sim_time: bool
    tlog: Path | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Links:
    """What connects the node with the world."""

    keys: Keys
    transport: Transport
    zenoh: ZenohSession
