"""A board as a vector PDF in true size, with a ruler to check the print by."""

from pathlib import Path

from fpdf import FPDF
from fpdf.enums import RenderStyle

from companion.eyes.board import BoardConfig
from companion.eyes.plate import Rectangle, rectangles_of
from link.errors import UserError

_MARGIN_MM = 5.0
_FOOT_MM = 16.0  # below the board, for the ruler and a line about it
_OVERLAP_MM = 0.02  # of white on white: viewers show seams between areas that only touch
_RULER_MAX_MM = 1000
_MM = 1000.0


def write_pdf(board: BoardConfig, path: Path) -> None:
    """Write a page of the board's size with a margin; the upper edge of the page is the one that points forward.

    Raises:
        UserError: the file cannot be written.
    """
    length_mm, width_mm = (size_m * _MM for size_m in board.size_m)
    page = (width_mm + 2.0 * _MARGIN_MM, length_mm + 2.0 * _MARGIN_MM + _FOOT_MM)
    pdf = FPDF(unit="mm", format=page)
    pdf.set_auto_page_break(auto=False)
    pdf.add_page()
    for rectangle in rectangles_of(board):
        _fill(pdf, rectangle, 0.5 * length_mm + _MARGIN_MM, 0.5 * width_mm + _MARGIN_MM)
    pdf.set_draw_color(160)
    pdf.set_line_width(0.1)
    pdf.rect(_MARGIN_MM, _MARGIN_MM, width_mm, length_mm)
    _draw_ruler(pdf, _MARGIN_MM, length_mm + 2.0 * _MARGIN_MM, width_mm)
    ids = [tag.id for tag in board.tags]
    pdf.set_font("Helvetica", size=7)
    pdf.text(
        _MARGIN_MM,
        page[1] - 2.0,
        f"board {length_mm:g} x {width_mm:g} mm, {board.family}, ids {min(ids)} to {max(ids)}; this edge points back; "
        "print at 100 % and check the ruler",
    )
    try:
        pdf.output(str(path))
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --out") from None


def _fill(pdf: FPDF, rectangle: Rectangle, middle_y_mm: float, middle_x_mm: float) -> None:
    (back_m, front_m), (right_m, left_m) = rectangle.forward_m, rectangle.left_m
    pdf.set_fill_color(255 if rectangle.is_white else 0)
    height_mm = (front_m - back_m) * _MM + (_OVERLAP_MM if rectangle.is_white else 0.0)
    pdf.rect(
        middle_x_mm - left_m * _MM,
        middle_y_mm - front_m * _MM,
        (left_m - right_m) * _MM,
        height_mm,
        style=RenderStyle.F,
    )


def _draw_ruler(pdf: FPDF, x_mm: float, y_mm: float, width_mm: float) -> None:
    """Draw whole centimetres, with their number at each tenth and at the end."""
    length_mm = int(min(width_mm, _RULER_MAX_MM)) // 10 * 10
    pdf.set_draw_color(0)
    pdf.set_line_width(0.2)
    pdf.set_font("Helvetica", size=6)
    pdf.line(x_mm, y_mm, x_mm + length_mm, y_mm)
    for at_mm in range(0, length_mm + 1, 10):
        is_named = at_mm % 100 == 0 or at_mm == length_mm
        pdf.line(x_mm + at_mm, y_mm, x_mm + at_mm, y_mm + (4.0 if is_named else 2.0))
        if is_named:
            pdf.text(x_mm + at_mm - 2.0, y_mm + 7.0, f"{at_mm} mm")
