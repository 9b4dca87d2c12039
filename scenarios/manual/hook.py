"""What mkdocs calls while it builds the manual: adds the pages that are made, and links what the written ones name."""

from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from scenarios.manual.pages import PAGES, with_links


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made from the program."""
    for path, make in PAGES.items():
        files.append(File.generated(config, path, content=make()))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Return a page's text with links to the pages that it names."""
    return with_links(markdown, page.file.src_uri)
