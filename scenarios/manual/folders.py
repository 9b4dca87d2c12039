"""The page of the packages' folders, from the sentence that opens each."""

import ast
from collections.abc import Iterator
from pathlib import Path

from scenarios.manual.markdown import code, page, table

ROOT = Path(__file__).parents[2]
PACKAGES = ("companion", "sim_autopilot", "scenarios", "link")
TEXT = """What each folder's `__init__.py` says is in it; `tests/` mirrors them. [Architecture](../architecture.md) says
how they fit together, [Contributing](../contributing.md) where a change begins."""


def folders_page() -> str:
    """Return the page, a section a package."""
    parts = [TEXT]
    for package in PACKAGES:
        parts += [f"## {package}", table(("folder", "what is in it"), _rows(package))]
    return page("Folders", *parts)


def folders_of(package: str) -> Iterator[tuple[str, str]]:
    """Yield each folder of a package, itself first, and the text that opens it."""
    for path in sorted((ROOT / package).rglob("__init__.py")):
        text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
        yield path.parent.relative_to(ROOT).as_posix(), text


def _rows(package: str) -> Iterator[tuple[str, str]]:
    for folder, text in folders_of(package):
        yield code(f"{folder}/"), text.split("\n\n")[0]
