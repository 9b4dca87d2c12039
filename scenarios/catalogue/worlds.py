"""The worlds by their names, as every command that takes a scenario loads them."""

from dataclasses import replace
from itertools import accumulate

from link.errors import UserError
from scenarios.catalogue.world_names import WorldName
from scenarios.config import FirmwareName
from scenarios.worlds.distributions import Choice
from scenarios.worlds.odd import quantities_of
from scenarios.worlds.seeds import check_world
from scenarios.worlds.world import World, draw_world

_FIRMWARE = "drone.firmware"


def named_world(name: WorldName) -> World:
    """Return the world called `name`.

    Raises:
        UserError: the name is of a whole slice, or the seed is held back.
    """
    if name.seed is None:
        raise UserError(f"{name.text} means many worlds: name one by its seed, such as {replace(name, seed=1).text}")
    check_world(name.slice, name.seed)
    return drawn_world(name, name.seed)


def drawn_world(name: WorldName, seed: int) -> World:
    """Return the world that `seed` draws of the slice in `name`, whose own seed does not count.

    With a firmware that it would not draw, everything else is drawn as it was; only a vehicle that is too fast for
    this firmware drives slower.
    """
    chosen = {} if name.firmware is None else {_FIRMWARE: _uniform_of(name.slice, name.firmware)}
    world = draw_world(name.slice, seed, chosen=chosen)
    scenario = world.scenario.model_copy(update={"name": replace(name, seed=seed).text})
    return replace(world, scenario=scenario)


def _uniform_of(slice_name: str, firmware: FirmwareName) -> float:
    """Return a uniform number at which a slice draws this firmware.

    Raises:
        UserError: it never does.
    """
    quantity = quantities_of(slice_name)[_FIRMWARE]
    if not isinstance(quantity, Choice) or firmware not in quantity.values:
        raise UserError(f"{slice_name} is never flown with {firmware}: leave out --firmware")
    place = quantity.values.index(firmware)
    ends = [0.0, *accumulate(quantity.weights)]
    return 0.5 * (ends[place] + ends[place + 1]) / ends[-1]
