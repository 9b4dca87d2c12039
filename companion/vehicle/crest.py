"""How high waves lift a deck: a drone that stops above it has to be clear of that, not only of where it is now."""

from math import inf

from msgspec import Struct

from link.records import replace

_SPAN_S = 30.0  # two waves of sea state 7 (STANAG 4194: 15 s)
_MOST_M = 10.0  # from the lowest to the highest, 57 m aft on a destroyer in sea state 7; more is a step of the frame


class Crest(Struct, frozen=True, kw_only=True):
    """The highest that a deck has been, in W, over the last one or two spans.

    Attributes:
        highest_enu_m: in this span.
        before_enu_m: in the span before.
        since_ns: monotonic time at which this span began; None before the first.
    """

    highest_enu_m: float = -inf
    before_enu_m: float = -inf
    since_ns: int | None = None


def update_crest(crest: Crest, monotonic_ns: int, deck_enu_m: float) -> Crest:
    """Return the crest with a deck that is `deck_enu_m` high now."""
    if crest.since_ns is None or monotonic_ns - crest.since_ns > _SPAN_S * 1e9:
        return Crest(highest_enu_m=deck_enu_m, before_enu_m=crest.highest_enu_m, since_ns=monotonic_ns)
    return replace(crest, highest_enu_m=deck_enu_m) if deck_enu_m > crest.highest_enu_m else crest


def crest_above_m(crest: Crest, deck_enu_m: float) -> float:
    """Return how far above its present height the deck has been."""
    return min(max(crest.highest_enu_m, crest.before_enu_m, deck_enu_m) - deck_enu_m, _MOST_M)
