"""A small panel at the foot of a terminal, that lines scroll above."""

from collections.abc import Sequence

from rich.console import Console
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from link.messages import LandingStatus
from link.program.status_rows import Row, status_rows

_WIDTH = 64
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
        self._live.update(_panel(self._title, status, more), refresh=True)

    def write_above(self, line: str) -> None:
        """Write a line that stays."""
        self._live.console.print(Text(line), soft_wrap=True)


def _panel(title: str, status: LandingStatus, more: Sequence[Row]) -> Panel:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row(Text(status.phase, style=_STYLES.get(status.phase, "bold")), Text(status.reason or "-"))
    for name, value in (*status_rows(status), *more):
        table.add_row(name, Text(value))
    return Panel(table, title=Text(title), title_align="left", width=_WIDTH)
