"""What a user may say the autopilot is; light to import, for the command line."""

from enum import Enum


class AutopilotKind(Enum):
    """What a user says of the autopilot."""

    AUTO = "auto"  # its heartbeat tells
    PX4 = "px4"
    ARDUPILOT = "ardupilot"
