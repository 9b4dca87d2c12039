"""One sortie as a task for a worker: the scenario in which it is flown, and what it was worth."""

from msgspec import Struct

from link.errors import UserError
from link.records import replace
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.completion import place_drone
from scenarios.catalogue.firmware_option import with_firmware
from scenarios.config import Scenario
from scenarios.scoring.score import Tier
from scenarios.scoring.touchdown import rules_of
from scenarios.simulation.drone import mean_wind_enu_m_s
from scenarios.sortie.flight import SortieFlight
from scenarios.sortie.score import SortieScore, score_sortie
from scenarios.tracks.config import MovingTrack
from scenarios.worlds.odd import slices

_ROAD_S = 300.0  # of driving: launch, three stations, a minute out of sight, the way home


def sortie_scenario(cell: str, seed: int, firmware: str) -> Scenario:
    """Return what a sortie of `cell` is flown in: a scenario of the catalogue, or a slice of the worlds and its seed.

    Raises:
        UserError: there is no such cell, or its vehicle stands.
    """
    is_world = cell == "world" or f"world:{cell}" in slices() or cell in slices()
    name = f"{cell if cell.startswith('world') else f'world:{cell}'}@{seed}" if is_world else cell
    scenario = on_long_road(load_scenario(with_firmware(name, firmware)))
    return place_drone(scenario.with_run(place="deck"))


def on_long_road(scenario: Scenario) -> Scenario:
    """Return `scenario` with a road that is long enough for a sortie.

    Raises:
        UserError: its vehicle stands.
    """
    track = scenario.track
    if track.kind == "static":
        name = scenario.name
        raise UserError(f"{name}: its vehicle stands; a sortie begins on one that drives: take straight_10 or urban")
    if isinstance(track, MovingTrack):
        track = track.model_copy(update={"road_s": max(track.road_s, _ROAD_S)})
    return scenario.model_copy(update={"track": track})


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
    rules = rules_of(flight.scenario, wind_mean_enu_m_s=mean_wind_enu_m_s(flight.scenario, flight.seed))
    rules = replace(rules, fence_drives_along=True)
    return FlownSortie(task=task, score=score_sortie(flight.recording, flight.operator, rules, ended))


def lost_sortie(task: SortieTask, why: str) -> FlownSortie:
    """Return what stands for a sortie that could not be flown: unsafe."""
    score = SortieScore(
        ended="",
        reason=why,
        contacts=None,
        error_straight_m=None,
        error_bend_m=None,
        error_max_m=None,
        error_by_station_m=(),
        moved_m=None,
        refused=0,
        tier=Tier.UNSAFE,
        tier_reason=why,
        lift_off_s=None,
        return_s=None,
        return_from_m=None,
        comes_by_itself=False,
    )
    return FlownSortie(task=task, score=score)
