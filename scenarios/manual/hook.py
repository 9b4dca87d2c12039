"""What mkdocs calls while it builds the manual: adds the pages that are made, and links what the written ones name."""

import logging
from pathlib import Path
from typing import Any

import ziamath
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from scenarios.manual.pages import PAGES, fetched_from_elsewhere, with_links, with_whole_options

LOG = logging.getLogger("mkdocs.plugins.manual")  # below mkdocs' own, so that its strict builds count warnings
LETTERS = "STIXTwoMath-Regular.ttf"
"""With brackets, roots and dots that fit what they belong to (SIL Open Font License)."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made from the program, and the letters of equations, which few machines have."""
    for path, make in PAGES.items():
        files.append(File.generated(config, path, content=make()))
    letters = Path(ziamath.__file__).parent / "fonts" / LETTERS
    files.append(File.generated(config, f"assets/{LETTERS}", abs_src_path=str(letters)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Return a page's text with links to the pages that it names."""
    return with_links(markdown, page.file.src_uri)


def on_page_content(html: str, **_: Any) -> str:
    """Return a page's text with options that no line breaks."""
    return with_whole_options(html)


def on_post_page(output: str, page: Page, **_: Any) -> str:
    """Warn of what a page would fetch: the manual needs no network."""
    if found := fetched_from_elsewhere(output):
        LOG.warning("%s fetches what is elsewhere: %s", page.file.src_uri, found)
    return output
