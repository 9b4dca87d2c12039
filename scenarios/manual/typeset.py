r"""Equations in the manual's pages: TeX between dollar signs becomes MathML, which a browser shows without any script.

`$x$` stands in a line, `$$x$$` on a line of its own. Code is left alone. GitHub shows the same source typeset.
"""

from re import Match
from typing import Any
from xml.etree.ElementTree import Element

from latex2mathml.converter import convert
from markdown import Markdown  # type: ignore[import-untyped]  # it has no annotations
from markdown.extensions import Extension  # type: ignore[import-untyped]
from markdown.inlinepatterns import InlineProcessor  # type: ignore[import-untyped]

_ABOVE_ESCAPES = 185  # code has 190, backslashes 180
_SHOWN = r"\$\$(.+?)\$\$"
_INLINE = r"\$([^$\s](?:[^$\n]*[^$\s])?)\$"


class _Typeset(InlineProcessor):  # type: ignore[misc]  # of a library without annotations
    """Puts MathML in place of TeX."""

    def __init__(self, pattern: str, md: Markdown, display: str) -> None:
        super().__init__(pattern, md)
        self._display = display

    def handleMatch(  # noqa: N802 (the library's name)
        self,
        m: Match[str],
        data: str,  # noqa: ARG002 (the library's arguments)
    ) -> tuple[Element | str, int, int]:
        """Return what stands for a match, and where it was."""
        equation = convert(" ".join(m[1].split()), display=self._display)
        if self._display == "block":
            equation = f'<span class="equation">{equation}</span>'  # which is scrolled on a phone
        return self.md.htmlStash.store(equation), m.start(0), m.end(0)


class TypesetExtension(Extension):  # type: ignore[misc]  # of a library without annotations
    """What Python-Markdown is extended by."""

    def extendMarkdown(self, md: Markdown) -> None:  # noqa: N802 (the library's name)
        """Register both kinds of equations."""
        md.inlinePatterns.register(_Typeset(_SHOWN, md, "block"), "equation", _ABOVE_ESCAPES + 1)
        md.inlinePatterns.register(_Typeset(_INLINE, md, "inline"), "formula", _ABOVE_ESCAPES)


def makeExtension(**options: Any) -> TypesetExtension:  # noqa: N802 (the library's name)
    """Return the extension, as Python-Markdown asks for it."""
    return TypesetExtension(**options)
