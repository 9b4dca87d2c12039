"""A slice of the operational design domain as a space to be searched, with the hard brake as the event to aim."""

from collections.abc import Mapping, Sequence

from scenarios.falsify.aim import Aim
from scenarios.falsify.search import Space
from scenarios.falsify.space import MEDIAN, searched
from scenarios.worlds.distributions import Choice, share_below
from scenarios.worlds.draws import Draws
from scenarios.worlds.odd import quantities_of
from scenarios.worlds.world import draw_world, quantities

_KIND, _GAP = "driver.event", "driver.event_gap_s"
_HARDEST = "brake"  # of what a driver does, what changes the vehicle's motion most: by 4.5 to 9 m/s^2
_STRENGTH = ("driver.brake_m_s2", "driver.brakes_to_stop", "driver.slowed_share", "driver.standing_s")


def world_space(slice_name: str, seed: int, only: Sequence[str] = ()) -> Space:
    """Return the space of a slice; without the driver among its quantities there is nothing to aim.

    Args:
        slice_name: of the domain.
        seed: of any world of it: all draw the same names.
        only: first parts of the names of the quantities that are searched; the others are at their medians then.
    """
    every = quantities(slice_name, seed)
    names, ordinary = searched(every, only), dict.fromkeys(every, MEDIAN) if only else {}

    def brake_at(seed: int, chosen: Mapping[str, float], begins_s: float) -> Mapping[str, float] | None:
        return _first_brake(Draws(quantities_of(slice_name), seed, {**ordinary, **chosen}), begins_s)

    aim = Aim(gap=_first(_GAP), strength=tuple(_first(name) for name in _STRENGTH), at=brake_at)
    return Space(
        names=names,
        draw=lambda seed, chosen: draw_world(slice_name, seed, chosen={**ordinary, **chosen}).scenario,
        aim=aim if _first(_KIND) in names else None,
    )


def _first_brake(draws: Draws, begins_s: float) -> dict[str, float] | None:
    """Return the uniform numbers of a first event that is a brake so long after the passing, None where none can be."""
    kind, share = draws.distribution(_KIND), share_below(draws.distribution(_GAP), begins_s)
    if not isinstance(kind, Choice) or share is None:
        return None
    return {_first(_KIND): 0.5 * sum(kind.shares(_HARDEST)), _first(_GAP): share}


def _first(name: str) -> str:
    return f"{name}.0"
