"""The scenario of a sortie: its drone begins on the deck, and the road is long enough for all of it."""

from link.errors import UserError
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import with_firmware
from scenarios.catalogue.placement import place_drone
from scenarios.config import Scenario
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
    scenario = load_scenario(with_firmware(name, firmware))
    track = scenario.track
    if track.kind == "static":
        raise UserError(f"{cell}: its vehicle stands; a sortie begins on one that drives: take straight_10 or urban")
    if isinstance(track, MovingTrack):
        track = track.model_copy(update={"road_s": max(track.road_s, _ROAD_S)})
    return place_drone(scenario.model_copy(update={"place": "deck", "track": track}))
