"""The view's plots over time: of a landing that goes on up to now, of a recording all of it with a cursor."""

import math
from typing import Any

import numpy as np
from viser import uplot

from scenarios.view.history import NAMES, Array, History
from scenarios.view.models import BLUE, GREEN, GREY, ORANGE

_POINTS_MIN, _POINTS_MAX = 2, 300
_HEIGHT_PX = 165
_PLOTS = (
    ("height and distance [m]", (("height_m", "height", BLUE), ("distance_m", "distance", ORANGE))),
    ("speed [m/s]", (("drone_speed_m_s", "drone", BLUE), ("vehicle_speed_m_s", "vehicle", GREY))),
    ("relative speed [m/s]", (("relative_speed_m_s", "relative", GREEN),)),
    ("error of the estimate [m]", (("error_m", "error", ORANGE),)),
)  # fmt: skip


class Plots:
    """Plots in the panel, each of one unit.

    Args:
        gui: of the page.
        with_cursor: mark the instant that is shown.
    """

    def __init__(self, gui: Any, *, with_cursor: bool) -> None:
        self._with_cursor = with_cursor
        self._plots: list[tuple[Any, tuple[str, ...]]] = []
        cursor = uplot.Series(label="now", stroke="rgba(0,0,0,0.6)", fill="rgba(0,0,0,0.07)", width=1)
        for title, lines in _PLOTS:
            series = [uplot.Series(label=label, stroke=css(color), width=2) for _, label, color in lines]
            series += [cursor] if with_cursor else []
            plot = gui.add_uplot(
                tuple(np.zeros(2) for _ in range(len(series) + 1)),
                (uplot.Series(label="t [s]"), *series),
                title=title,
                scales={"x": uplot.Scale(time=False, auto=True)},
                legend=uplot.Legend(show=True),
                height=_HEIGHT_PX,
            )
            self._plots.append((plot, tuple(name for name, _, _ in lines)))

    def draw(self, history: History, end: int, now_s: float) -> None:
        """Draw the history up to row `end`, with the cursor at `now_s`."""
        times_s, values = history.columns(end, _POINTS_MAX)
        for plot, names in self._plots:
            shown = values[:, [NAMES.index(name) for name in names]]
            known = np.isfinite(shown).all(axis=1)
            if known.sum() >= _POINTS_MIN:
                columns = (times_s[known], *np.ascontiguousarray(shown[known].T))
                plot.data = with_cursor(columns, now_s) if self._with_cursor else columns


def with_cursor(columns: tuple[Array, ...], now_s: float) -> tuple[Array, ...]:
    """Return columns with one more, which steps at `now_s` from their least value to their greatest.

    uPlot has no gaps in what it is given, so the cursor is a line, too: it runs along the edges of the plot.
    """
    times_s, *values = columns
    low, high = float(np.min(values)), float(np.max(values))
    at = min(max(now_s, float(times_s[0])), float(times_s[-1]))
    place = int(np.searchsorted(times_s, at, side="right"))
    before = math.nextafter(at, math.inf)
    times_s = np.insert(times_s, place, (before, math.nextafter(before, math.inf)))
    moved = [np.insert(one, place, (float(np.interp(at, columns[0], one)),) * 2) for one in values]
    step = np.where(np.arange(len(times_s)) <= place, low, high)
    return (times_s, *moved, step)


def css(color: tuple[int, int, int]) -> str:
    """Return a colour as a page writes it."""
    return "rgb({}, {}, {})".format(*color)
