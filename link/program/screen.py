"""A small panel at the foot of a terminal, that lines scroll above.

It has the same height all the time and never wraps: where a line is too wide its end is cut. A panel that grows or
wraps would be drawn over the lines above it, which the pilot needs.
"""

import textwrap
from collections.abc import Sequence

from rich.console import Console
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from link.messages import LandingStatus
from link.program.status_rows import Row, status_rows

_WIDTH_MAX = 80
_BORDER = 4  # columns of the panel's frame
_REASON_LINES = 2
_STYLES = {"secured": "bold green", "abort": "bold red", "hold": "bold yellow", "pilot in command": "bold red"}


class Screen:
    """The panel from `start` to `stop`; what is written to stdout meanwhile stands above it.

    Args:
        title: of the panel.
        console: to draw on, stdout's by default.
    """

    def __init__(self, title: str, console: Console | None = None) -> None:
        self._title = title
        self._live = Live(console=console or Console(), auto_refresh=False, redirect_stderr=False)

    def start(self) -> None:
        """Take the foot of the terminal."""
        self._live.start()

    def stop(self) -> None:
        """Leave the last panel where it is."""
        self._live.stop()

    def show(self, status: LandingStatus, more: Sequence[Row] = ()) -> None:
        """Draw the status with further rows below."""
        width = min(self._live.console.width, _WIDTH_MAX)
        self._live.update(_panel(self._title, status, more, width), refresh=True)

    def write_above(self, line: str) -> None:
        """Write a line that stays."""
        self._live.console.print(Text(line), soft_wrap=True)


def _panel(title: str, status: LandingStatus, more: Sequence[Row], width: int) -> Panel:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(no_wrap=True, overflow="ellipsis")
    for name, value in (*status_rows(status), *more):
        table.add_row(name, Text(value))
    lines = Table.grid()
    lines.add_column(no_wrap=True, overflow="ellipsis")
    lines.add_row(Text(status.phase, style=_STYLES.get(status.phase, "bold")))
    for line in _reason_lines(status.reason, width - _BORDER):
        lines.add_row(Text(line))
    lines.add_row(table)
    return Panel(lines, title=Text(title[: width - 2 * _BORDER]), title_align="left", width=width)


def _reason_lines(reason: str, width: int) -> list[str]:
    """Return the reason in a fixed number of lines."""
    lines = textwrap.wrap(reason or "-", max(width, 1), max_lines=_REASON_LINES, placeholder=" ...")
    return [*lines, *[""] * (_REASON_LINES - len(lines))]
