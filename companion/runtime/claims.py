"""Who else flies this drone, or lands on this vehicle: one companion for a drone, and one drone on a vehicle at a time.

Each companion shows by a liveliness token that it runs, and by another that it lands on its vehicle or stands there.
The one that was there first counts; a token goes with its program, however that ends. Who flies a drone goes on,
whoever comes then: two computers' clocks can be off by years, and tell who began earlier only where neither flies, or
where both do when they first meet.
"""

import time
from collections.abc import Callable, Iterable
from typing import Protocol

from companion.core.data import Rival
from companion.situation.phases import FLYING_PHASES, Phase
from link.zenoh.inbox import Alive
from link.zenoh.keys import Keys


class Tokens(Protocol):
    """What tokens are shown and seen by, such as a Zenoh session."""

    def declare_alive(self, key: str) -> Callable[[], None]:
        """Show a token on `key`, and return what takes it back."""

    def watch_alive(self, key: str) -> Alive:
        """Return which tokens there are on `key`, which may hold wildcards, from now on."""


class Claims:
    """The tokens of this companion and of others.

    Args:
        zenoh: to show and see them by.
        keys: of the Zenoh contract.
        begun_ns: when this companion began by its computer's clock.
        dry_run: it flies nothing, and claims no vehicle.
    """

    def __init__(self, zenoh: Tokens, keys: Keys, begun_ns: int | None = None, *, dry_run: bool = False) -> None:
        self._zenoh, self._dry_run = zenoh, dry_run
        self._keys = keys
        self._name = f"{time.time_ns() if begun_ns is None else begun_ns:020d}"
        self._companions = zenoh.watch_alive(keys.companion_alive("*"))
        self._landings = zenoh.watch_alive(keys.landing_claim("*", "*"))
        zenoh.declare_alive(keys.companion_alive(self._name))
        self._release: Callable[[], None] | None = None
        self._met: frozenset[str] = frozenset()  # other companions that were there when this one claimed its vehicle

    def update(self, phase: Phase, *, armed: bool) -> None:
        """Claim the vehicle while this drone lands there or stands there, and no longer."""
        lands = not self._dry_run and (phase in FLYING_PHASES or (phase is Phase.SECURED and not armed))
        if lands and self._release is None:
            self._met = self._others()
            self._release = self._zenoh.declare_alive(self._keys.landing_claim(self._keys.drone, self._name))
        elif not lands and self._release is not None:
            self._release()
            self._release = None

    @property
    def rival(self) -> Rival | None:
        """Who was there first, None where this companion was."""
        if self._is_drone_taken():
            return Rival(drone=self._keys.drone, is_this_drone=True)
        claims = sorted((name, drone) for drone, name in _ends(self._landings.keys, 2))
        for name, drone in claims:
            is_first = (name, drone) < (self._name, self._keys.drone)
            if drone != self._keys.drone and (self._release is None or is_first):
                return Rival(drone=drone, is_this_drone=False)
        return None

    def _is_drone_taken(self) -> bool:
        flying = frozenset(name for drone, name in _ends(self._landings.keys, 2) if drone == self._keys.drone)
        flying -= {self._name}
        if self._release is None:
            return bool(flying) or any(name < self._name for name in self._others())
        return any(name < self._name for name in flying | (self._met & self._others()))

    def _others(self) -> frozenset[str]:
        """Return the other companions of this drone."""
        return frozenset(name for (name,) in _ends(self._companions.keys, 1)) - {self._name}


def _ends(keys: Iterable[str], chunks: int) -> list[list[str]]:
    return [key.split("/")[-chunks:] for key in keys]
