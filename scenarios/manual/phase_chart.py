"""The phases of a landing: the table of transitions as a drawing and as text."""

import io
from collections.abc import Mapping
from types import MappingProxyType

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from companion.situation.phases import FLYING_PHASES, TRANSITIONS, Event, Phase
from scenarios.manual.field_comments import comments_of
from scenarios.manual.markdown import page, table

PLACES: Mapping[Phase, tuple[float, float]] = MappingProxyType(
    {
        Phase.IDLE: (0.0, 2.0),
        Phase.TAKEOFF: (2.2, 2.0),
        Phase.WAITING: (4.4, 2.0),
        Phase.CHASE: (6.6, 2.0),
        Phase.ALIGN: (8.8, 2.0),
        Phase.DESCEND: (11.0, 2.0),
        Phase.TOUCHDOWN: (13.2, 2.0),
        Phase.SECURED: (15.4, 2.0),
        Phase.HOLD: (4.4, 0.0),
        Phase.ABORT: (8.8, 0.0),
        Phase.PILOT: (0.0, 0.0),
        Phase.ON_DECK: (0.0, 4.6),
        Phase.LIFT_OFF: (2.2, 4.6),
        Phase.FOLLOW: (5.5, 4.6),
        Phase.RETURN: (9.9, 4.6),
        Phase.RALLY: (7.7, 6.2),
    }
)
"""Where each phase is drawn."""

WIDTH, HEIGHT = 1.5, 0.5

STRAIGHT = 0.0
BENDS: Mapping[tuple[Phase, Phase], tuple[float, float, float]] = MappingProxyType(
    {
        (Phase.IDLE, Phase.TAKEOFF): (STRAIGHT, 1.1, 2.55),
        (Phase.TAKEOFF, Phase.WAITING): (STRAIGHT, 3.3, 2.55),
        (Phase.WAITING, Phase.CHASE): (STRAIGHT, 5.5, 2.55),
        (Phase.CHASE, Phase.ALIGN): (STRAIGHT, 7.7, 2.55),
        (Phase.ALIGN, Phase.DESCEND): (STRAIGHT, 9.9, 2.55),
        (Phase.DESCEND, Phase.TOUCHDOWN): (STRAIGHT, 12.1, 2.55),
        (Phase.TOUCHDOWN, Phase.SECURED): (STRAIGHT, 14.3, 2.55),
        (Phase.ALIGN, Phase.CHASE): (-0.5, 7.7, 1.6),
        (Phase.DESCEND, Phase.ALIGN): (-0.5, 9.9, 1.6),
        (Phase.TAKEOFF, Phase.IDLE): (-0.5, 1.0, 1.55),
        (Phase.SECURED, Phase.TAKEOFF): (0.22, 8.8, 3.27),
        (Phase.PILOT, Phase.TAKEOFF): (STRAIGHT, 0.75, 0.75),
        (Phase.TAKEOFF, Phase.HOLD): (STRAIGHT, 3.0, 1.1),
        (Phase.WAITING, Phase.HOLD): (0.2, 3.95, 1.1),
        (Phase.HOLD, Phase.WAITING): (0.2, 4.85, 1.1),
        (Phase.ABORT, Phase.HOLD): (STRAIGHT, 6.6, 0.0),
        (Phase.ABORT, Phase.CHASE): (0.2, 8.15, 1.1),
        (Phase.CHASE, Phase.ABORT): (0.2, 7.1, 0.85),
        (Phase.ALIGN, Phase.ABORT): (STRAIGHT, 8.8, 1.1),
        (Phase.DESCEND, Phase.ABORT): (STRAIGHT, 9.95, 1.0),
        (Phase.TOUCHDOWN, Phase.ABORT): (-0.15, 11.9, 0.6),
    }
)
"""How much each arrow is bent, and where its events are written; one that is not listed is straight."""
FROM_ANYWHERE = Event.PILOT_TOOK_OVER
"""Comes from every flying phase to the same one; said in words, not by an arrow from each."""

TEXT = """Each arrow is a row of the one table of transitions (`companion/situation/phases.py`). This page is made from
it when the manual is built. An event that is not listed for a phase leaves it as it is. [Safety](safety.md) says what
each reason to abort means."""


def phases_page(figure: str) -> str:
    """Return the page of the phases; `figure` is the path of the drawing."""
    comments = comments_of(Phase)
    events = comments_of(Event)
    phases = [(phase.value, comments[phase.name], "yes" if phase in FLYING_PHASES else "") for phase in Phase]
    rows = [(a.value, event.value, b.value, events[event.name]) for (a, event), b in TRANSITIONS.items()]
    return page(
        "Phases of a flight",
        TEXT,
        f"![The phases and what leads from one to another]({figure})",
        f'From each flying phase "{FROM_ANYWHERE.value}" leads to "{Phase.PILOT.value}".',
        "## The phases",
        table(("phase", "what happens", "setpoints are sent"), phases),
        "## The transitions",
        table(("in", "event", "leads to", "which means"), sorted(rows)),
    )


def phase_chart() -> str:
    """Return the drawing as SVG: the same bytes for the same table."""
    figure = Figure(figsize=(13.0, 5.6))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-1.0, 16.4), ylim=(-0.5, 7.0), aspect="equal")
    axes.axis("off")
    for (a, b), events in arrows().items():
        _draw_arrow(axes, a, b, "\n".join(event.value for event in events))
    for phase, place in PLACES.items():
        _draw_phase(axes, phase, place)
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": "phases", "svg.fonttype": "none", "font.family": "sans-serif"}):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def arrows() -> dict[tuple[Phase, Phase], list[Event]]:
    """Return the events that lead from one phase to another, for each pair that is drawn."""
    found: dict[tuple[Phase, Phase], list[Event]] = {}
    for (a, event), b in TRANSITIONS.items():
        if event is not FROM_ANYWHERE:
            found.setdefault((a, b), []).append(event)
    return found


def _draw_phase(axes: Axes, phase: Phase, place: tuple[float, float]) -> None:
    x, y = place
    colour = "#dcebf7" if phase in FLYING_PHASES else "#eeeeee"
    box = FancyBboxPatch(
        (x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, boxstyle="round,pad=0.05", facecolor=colour, edgecolor="#333333"
    )
    axes.add_patch(box)
    axes.text(x, y, phase.value, ha="center", va="center", fontsize=9)


def _draw_arrow(axes: Axes, a: Phase, b: Phase, text: str) -> None:
    (x_a, y_a), (x_b, y_b) = PLACES[a], PLACES[b]
    bend, x, y = BENDS.get((a, b), (STRAIGHT, (x_a + x_b) / 2, (y_a + y_b) / 2))
    arrow = FancyArrowPatch(
        _edge((x_a, y_a), (x_b, y_b)),
        _edge((x_b, y_b), (x_a, y_a)),
        connectionstyle=f"arc3,rad={bend}",
        arrowstyle="-|>",
        mutation_scale=12,
        color="#333333",
    )
    axes.add_patch(arrow)
    label = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"}
    axes.text(x, y, text, ha="center", va="center", fontsize=8, bbox=label)


def _edge(place: tuple[float, float], towards: tuple[float, float]) -> tuple[float, float]:
    """Return where a line from the middle of one box to that of another leaves the first."""
    across, up = towards[0] - place[0], towards[1] - place[1]
    share = min(
        (WIDTH / 2 + 0.06) / abs(across) if across else 1.0,
        (HEIGHT / 2 + 0.06) / abs(up) if up else 1.0,
    )
    return place[0] + share * across, place[1] + share * up
