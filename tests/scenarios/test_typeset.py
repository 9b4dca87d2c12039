"""Equations of the manual."""

import pytest
from markdown import Markdown  # type: ignore[import-untyped]  # it has no annotations

from scenarios.manual.typeset import makeExtension


def html(markdown: str) -> str:
    return str(Markdown(extensions=[makeExtension()]).convert(markdown))


def test_formula_in_a_line_becomes_mathml_and_keeps_its_underscores() -> None:
    page = html("The *rate* is $w_a + w_b$ in m/s.")
    assert page.startswith("<p>The <em>rate</em> is <math")
    assert page.count("<msub>") == 2
    assert "$" not in page


def test_equation_over_two_lines_is_shown_by_itself() -> None:
    page = html("$$\\frac{a}{b}\n= c$$")
    assert 'class="equation"><math xmlns="http://www.w3.org/1998/Math/MathML" display="block">' in page
    assert "<mfrac>" in page


@pytest.mark.parametrize("text", ["`$HOME/$USER`", "It costs 5 $ or 6 $ more."])
def test_code_and_lone_dollars_are_left_alone(text: str) -> None:
    assert "<math" not in html(text)
