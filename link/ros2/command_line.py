"""The options of every program that may be a node of a ROS 2 graph."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from link.program.option_groups import OptionGroup
from link.ros2.options import Ros2Options, ros2_options

_PANEL = "ROS 2"

_Ros2Option = Annotated[
    int | None,
    typer.Option(
        "--ros2",
        metavar="[DOMAIN]",
        help="Be a node of a ROS 2 graph over rmw_zenoh [default: ROS_DOMAIN_ID, else 0].",
        show_default=False,
        rich_help_panel=_PANEL,
    ),
]
_Ros2MapOption = Annotated[
    Path | None,
    typer.Option("--ros2-map", metavar="FILE", help="Which topics are what, in TOML.", rich_help_panel=_PANEL),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2Arguments(OptionGroup):
    """Whether a program is a node of a ROS 2 graph."""

    ros2: _Ros2Option = None
    ros2_map: _Ros2MapOption = None

    def options(self) -> Ros2Options | None:
        """Return what they say, None without `--ros2`.

        Raises:
            UserError: there is no such domain, or a map without `--ros2`.
        """
        return ros2_options(self.ros2, self.ros2_map)
