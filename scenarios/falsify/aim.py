"""Starts that are aimed in time: a driver's first event begins just before a landing would have touched.

What a driver does after the contact changes nothing of it, and up to its beginning an event changes nothing either. So
a plausible world is flown first in which no event comes before the contact, and then the same one in which an event
begins shortly before that instant. Everything but the event stays: a small change of anything else, by a tenth of its
spread, may put the contact off by a second, and what was aimed at is gone.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from scenarios.falsify.space import Z_MAX, Array, normal, plausible, uniforms
from scenarios.falsify.strategy import Start
from scenarios.simulation.noise import named_rng

_LEAD_S, _LEAD_STD_S = 0.3, 0.1
"""How long before the contact a brake begins: a tenth of a second more or less than 0.3 s.

In 0.2 s it changes the speed by what a contact may have against the pad, 1 m/s at 5 m/s^2; within 0.4 s it is told to
the drone, which can break off from then on.
"""
_NEAR_SHARE = 0.5  # of the plain landing's margin: what does not come nearer to failing than to it is left
_PATIENCE = 1  # generation: another world costs one landing more than the next generation of this one

EventAt = Callable[[int, Mapping[str, float], float], Mapping[str, float] | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Aim:
    """The event that can be aimed, by the names of its quantities.

    Attributes:
        gap: says when it begins.
        strength: say how strong it is.
        at: gives, for a seed and its uniform numbers, those of them that make the event begin at an instant, in seconds
            from the vehicle's passing; None where it cannot begin then.
    """

    gap: str
    strength: tuple[str, ...]
    at: EventAt


def plain_world(names: tuple[str, ...], seed: int | None, aim: Aim) -> Array:
    """Return a world (n,) whose first event begins as late as is plausible.

    Args:
        names: of all quantities.
        seed: that draws the others, None for their medians.
        aim: whose event it is.
    """
    dimension = len(names)
    z = np.zeros(dimension) if seed is None else named_rng(seed, "falsify plain").standard_normal(dimension)
    z[names.index(aim.gap)] = Z_MAX
    return plausible(z)


def aimed_start(
    names: tuple[str, ...], seed: int, aim: Aim, plain: Array, *, contact_s: float, margin: float
) -> Start | None:
    """Return the start about a plain world in which the event comes just before its contact, None where it cannot.

    Args:
        names: of all quantities.
        seed: of the world.
        aim: at what.
        plain: the world (n,).
        contact_s: when it touched, from the vehicle's passing.
        margin: of its landing.
    """
    chosen = uniforms(names, plain)
    event, earlier = (aim.at(seed, chosen, contact_s - lead_s) for lead_s in (_LEAD_S, _LEAD_S + _LEAD_STD_S))
    if event is None or earlier is None:
        return None
    mean, spread = plain.copy(), np.zeros(len(names))
    for name, u in event.items():
        mean[names.index(name)] = normal(u)
    for name in aim.strength:
        mean[names.index(name)], spread[names.index(name)] = 0.0, 1.0
    spread[names.index(aim.gap)] = normal(event[aim.gap]) - normal(earlier[aim.gap])
    return Start(mean=mean, spread=spread, margin=_NEAR_SHARE * margin, patience=_PATIENCE)
