"""Tables of text, shown alike on a terminal, in Markdown and on a page."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TextIO

from rich.box import SIMPLE_HEAD
from rich.console import Console, JustifyMethod
from rich.table import Table

from scenarios.manual.markdown import table

_PLAIN_WIDTH = 1000  # nothing is wrapped where a program may read it


@dataclass(frozen=True, slots=True, kw_only=True)
class Sheet:
    """A table of text.

    Attributes:
        title: what it shows.
        head: of its columns.
        rows: each with as many cells as the head.
        texts: how many of the columns, the first ones, are texts; the others are numbers.
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    texts: int = 1


def open_console(out: TextIO) -> Console:
    """Return what prints tables: as wide as the terminal, and of one line a row elsewhere."""
    is_terminal = out.isatty()
    return Console(file=out, highlight=False, width=None if is_terminal else _PLAIN_WIDTH, no_color=not is_terminal)


def open_table(console: Console, title: str) -> Table:
    """Return an empty table: framed on a terminal, plain elsewhere."""
    framed = console.is_terminal
    return Table(title=title, title_justify="left", box=SIMPLE_HEAD if framed else None, pad_edge=framed)


def print_sheets(sheets: Iterable[Sheet], out: TextIO) -> None:
    """Print tables for people."""
    console = open_console(out)
    for sheet in sheets:
        shown = open_table(console, sheet.title)
        for place, heading in enumerate(sheet.head):
            justify: JustifyMethod = "left" if place < sheet.texts else "right"
            shown.add_column(heading.replace("[", "\\["), justify=justify, overflow="fold")
        for row in sheet.rows:
            shown.add_row(*(text.replace("[", "\\[") for text in row))
        console.print(shown)


def write_sheets(sheets: Iterable[Sheet], out: TextIO) -> None:
    """Write tables as Markdown, each below its title."""
    out.writelines(f"\n**{sheet.title}**\n\n{table(sheet.head, sheet.rows)}" for sheet in sheets)
