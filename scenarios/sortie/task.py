"""One sortie as a task for a worker: flown, scored and forgotten."""

from msgspec import Struct

from scenarios.scoring.score import Tier
from scenarios.sortie.flight import SortieFlight
from scenarios.sortie.scenario import sortie_scenario
from scenarios.sortie.score import SortieScore, score_sortie


class SortieTask(Struct, frozen=True, kw_only=True):
    """Which sortie."""

    cell: str
    firmware: str
    seed: int


class FlownSortie(Struct, frozen=True, kw_only=True):
    """A sortie and what it was worth."""

    task: SortieTask
    score: SortieScore


def fly_sortie(task: SortieTask) -> FlownSortie:
    """Return what a sortie was worth."""
    flight = SortieFlight(sortie_scenario(task.cell, task.seed, task.firmware), task.seed)
    ended = flight.fly()
    return FlownSortie(task=task, score=score_sortie(flight, ended))


def lost_sortie(task: SortieTask, why: str) -> FlownSortie:
    """Return what stands for a sortie that could not be flown: unsafe."""
    score = SortieScore(
        ended="",
        reason=why,
        contacts=0,
        error_straight_m=None,
        error_bend_m=None,
        error_max_m=None,
        tier=Tier.UNSAFE,
        tier_reason=why,
        lift_off_s=None,
        return_s=None,
        return_from_m=None,
    )
    return FlownSortie(task=task, score=score)
