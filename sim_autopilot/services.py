"""What the autopilot's MAVLink services remember, each in its own part."""

from dataclasses import dataclass

from sim_autopilot.commands.gripper import AT_REST, Gripper
from sim_autopilot.files.ftp_state import NO_FTP, Ftp
from sim_autopilot.files.log_stream import LogStream
from sim_autopilot.files.logs import NO_LOGS, Logs
from sim_autopilot.flight.follow import Leader
from sim_autopilot.flight.manual import Sticks
from sim_autopilot.flight.precision_landing import Target
from sim_autopilot.missions.fence import Fence
from sim_autopilot.missions.flight import NO_PROGRESS, Progress
from sim_autopilot.missions.library import NO_LIBRARY, Library
from sim_autopilot.safety.failsafes import NOTHING_NOTICED, Watch
from sim_autopilot.safety.failures import NO_FAILURES, Failures


@dataclass(frozen=True, slots=True, kw_only=True)
class Services:
    """The services' memories.

    Attributes:
        library: plans, and the transfer of one under way.
        mission: how far it is flown.
        sticks: the pilot's, None before the first.
        fence: of the plan, in W.
        watch: of the failsafes.
        failures: injected.
        events: how many were told, as the 16 bits on the wire count them.
        target: of a precision landing, None before the first sighting.
        leader: who is followed, None before his first word.
        reboot_ns: when it boots again, in ns since boot; None goes on.
        ftp: the files' server.
        logs: of the flights.
        log_stream: to a client, None without one.
        gripper: PX4's.
        typed: into the shell, of a line that is not finished.
        forgets: whether the next boot begins with the defaults of all parameters.
    """

    library: Library = NO_LIBRARY
    mission: Progress = NO_PROGRESS
    sticks: Sticks | None = None
    fence: Fence = ()
    watch: Watch = NOTHING_NOTICED
    failures: Failures = NO_FAILURES
    events: int = 0
    target: Target | None = None
    leader: Leader | None = None
    reboot_ns: int | None = None
    ftp: Ftp = NO_FTP
    logs: Logs = NO_LOGS
    log_stream: LogStream | None = None
    gripper: Gripper = AT_REST
    typed: str = ""
    forgets: bool = False
