"""What an autopilot says of its build and its board."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Identity:
    """What AUTOPILOT_VERSION tells besides: eight bytes of the commit, numbers of board and operating system, ids."""

    custom_version: bytes = bytes(8)
    os_version: int = 0
    board_version: int = 0
    uid: int = 0
    uid2: bytes = bytes(18)
