"""What a user may say about ROS 2."""

from dataclasses import dataclass
from pathlib import Path

from link.errors import UserError

DOMAIN_MAX = 232
"""The largest ROS_DOMAIN_ID for which DDS has ports (docs.ros.org, "The ROS_DOMAIN_ID")."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2Options:
    """What a user may say about ROS 2.

    Attributes:
        domain: ROS_DOMAIN_ID.
        map_file: a TOML file after `link.ros2.topic_map`; None is the defaults.

    Raises:
        UserError: There is no such domain.
    """

    domain: int
    map_file: Path | None = None

    def __post_init__(self) -> None:
        """Check the domain."""
        if not 0 <= self.domain <= DOMAIN_MAX:
            raise UserError(f"--ros2 {self.domain} is no domain: give a number from 0 to {DOMAIN_MAX}")


def ros2_options(domain: int | None, map_file: Path | None) -> Ros2Options | None:
    """Return the options of a command line, None without `--ros2`.

    Raises:
        UserError: There is no such domain, or a map without `--ros2`.
    """
    if domain is not None:
        return Ros2Options(domain=domain, map_file=map_file)
    if map_file is not None:
        raise UserError(f"--ros2-map {map_file} is read with --ros2 only: add --ros2 [DOMAIN]")
    return None
