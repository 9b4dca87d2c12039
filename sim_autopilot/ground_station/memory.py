"""What the services remember, each in its own part; the flight carries it along without reading it."""

from msgspec import Struct

from link.ftp.state import NO_FTP, Ftp
from link.records import replace
from sim_autopilot.ground_station.logs.log_stream import LogStream
from sim_autopilot.ground_station.logs.logs import NO_LOGS, Logs
from sim_autopilot.ground_station.missions.library import NO_LIBRARY, Library
from sim_autopilot.memory import AutopilotMemory


class Gripper(Struct, frozen=True, kw_only=True):
    """What it was last told: to release (0) or to grab (1), as it does at boot; and when it is done, since boot."""

    action: int = 1
    done_ns: int = 0

    def moves(self, boot_ns: int) -> bool:
        """Return whether it is still at it."""
        return boot_ns < self.done_ns


AT_REST = Gripper()


class StationMemory(Struct, frozen=True, kw_only=True):
    """The services' memories.

    Attributes:
        library: plans, and the transfer of one under way.
        ftp: the files' server.
        logs: of the flights.
        log_stream: to a client, None without one.
        gripper: PX4's.
        typed: into the shell, of a line that is not finished.
    """

    library: Library = NO_LIBRARY
    ftp: Ftp = NO_FTP
    logs: Logs = NO_LOGS
    log_stream: LogStream | None = None
    gripper: Gripper = AT_REST
    typed: str = ""


EMPTY = StationMemory()


def station_of(memory: AutopilotMemory) -> StationMemory:
    """Return what the services remember.

    Raises:
        TypeError: they were not there when it was booted.
    """
    if not isinstance(memory.station, StationMemory):
        raise TypeError(f"{type(memory.station).__name__} is no memory of the services")
    return memory.station


def with_station(memory: AutopilotMemory, station: StationMemory) -> AutopilotMemory:
    """Return the autopilot with another memory of the services."""
    return replace(memory, station=station)


def keep_stored(station: StationMemory) -> StationMemory:
    """Return what is stored over a reboot: plans, files and logs."""
    return StationMemory(
        library=replace(station.library, transfer=None),
        ftp=replace(station.ftp, opened=None, burst=None, last=None, asked_ns=0),
        logs=replace(station.logs, sending=None, next_ns=0),
    )
