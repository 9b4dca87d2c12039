"""Tables and literals in Markdown."""

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; what would end a cell in `rows` is escaped."""
    lines = [_line(head), _line(["---"] * len(head)), *(_line([_cell(text) for text in row]) for row in rows)]
    return "\n".join(lines) + "\n"


def code(text: str) -> str:
    """Return `text` as code within a line; nothing stays nothing."""
    return f"`{text}`" if text else ""


def block(text: str) -> str:
    """Return `text` as it is, in a fixed-width font."""
    return f"```text\n{text.strip()}\n```\n"


def page(title: str, *parts: str) -> str:
    """Return a page of parts below a title."""
    return "\n\n".join([f"# {title}", *(part.strip() for part in parts)]) + "\n"


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
