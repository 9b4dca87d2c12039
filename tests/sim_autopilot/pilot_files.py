"""A pilot's client of the autopilot's files."""

from tests.link.ftp.file_client import FileClient
from tests.sim_autopilot.pilot import Pilot


class PilotFiles(FileClient):
    """The client of `pilot`."""

    def __init__(self, pilot: Pilot) -> None:
        super().__init__(pilot.step)
        self.pilot = pilot
