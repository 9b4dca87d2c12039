"""A sortie's operator, without I/O: what he orders and when, and what he takes note of.

The drone stands on the deck of a vehicle. It follows at three stations for 20 s each, then stays behind while the
vehicle drives on, until that is 300 m away or a minute has passed; then it comes home and lands.
"""

import math
from collections.abc import Sequence

from companion.situation.phases import Phase
from link.messages import Command, CommandReply, Order, Station, StationFrame
from link.records import replace
from scenarios.config import Scenario

STATIONS = (
    Station(offset_m=(-6.0, 0.0, 4.0), frame=StationFrame.VEHICLE),
    Station(offset_m=(2.0, 6.0, 1.0), frame=StationFrame.VEHICLE),
    Station(offset_m=(0.0, -7.0, 1.0), frame=StationFrame.COURSE),
)
"""Behind and above, then low to the left, then low to the right: the way there leads round the vehicle."""
_BESIDE_M = 1.0  # of the vehicle's corners a low station is kept
HELD_S = 20.0
"""At each station."""
_AWAY_M = 300.0
_AWAY_MAX_S = 60.0
_ASKS_AGAIN_NS = 1_000_000_000  # an operator whose launch is refused
_END_S = 2.5  # after the motors are off; the score looks at the drone 2 s after
_LANDING_MAX_S = 240.0  # from the return to the end
_LIFTED_NS = 200_000_000  # off the deck for so long: a rough road's shaking is over in less
_TOUCHING = frozenset({Phase.DESCEND, Phase.TOUCHDOWN, Phase.SECURED})
_WAY_HOME = frozenset({Phase.RETURN, Phase.CHASE, Phase.ALIGN, Phase.DESCEND})
_OVER = frozenset({Phase.SECURED, Phase.PILOT})


def stations_of(scenario: Scenario) -> tuple[Station, ...]:
    """Return the stations of an operator who knows the vehicle: high over a large one, and clear of the road."""
    vehicle, sortie = scenario.vehicle, scenario.system.companion.sortie
    reach_m = 0.5 * math.hypot(vehicle.length_m, vehicle.width_m) + _BESIDE_M
    high_m, lowest_m = STATIONS[0].offset_m[2], sortie.ground_clearance_m - vehicle.roof_height_m
    stations = []
    for station in STATIONS:
        x_m, y_m, up_m = station.offset_m
        up_m = max(up_m, lowest_m) if math.hypot(x_m, y_m) > reach_m else high_m
        stations.append(replace(station, offset_m=(x_m, y_m, up_m)))
    return tuple(stations)


class SortieOperator:
    """Who launches, changes stations, holds and calls home.

    Args:
        stations: to be ordered, one after the other.

    Attributes:
        orders: stations that were ordered, and when.
        refused: why a station was refused, by when it was ordered.
        times_ns: of what is done once: `launch`, `lifted`, `hold`, `return`.
        contacts_ns: with anything, between the lift-off and the last descent.
        return_from_m: how far away the vehicle was when the way home began.
        comes_by_itself: the drone set out for home without being called, as for its battery.
    """

    def __init__(self, stations: Sequence[Station]) -> None:
        self.orders: list[tuple[int, Station]] = []
        self.refused: dict[int, str] = {}
        self.times_ns: dict[str, int] = {}
        self.contacts_ns: list[int] = []
        self.return_from_m: float | None = None
        self.comes_by_itself = False
        self._stations = tuple(stations)
        self._on_deck_ns = 0
        self._next_ns = 0
        self._over_ns: int | None = None

    def order(self, t_ns: int, phase: Phase, distance_m: float, *, may_launch: bool) -> Order | None:
        """Return what is ordered now, None for nothing.

        Args:
            t_ns: now.
            phase: of the companion.
            distance_m: of the drone from the vehicle, horizontal.
            may_launch: a launch makes sense.
        """
        if phase in _WAY_HOME and "return" not in self.times_ns:
            self.comes_by_itself = True
            self._begin_way_home(t_ns, distance_m)
        if t_ns < self._next_ns:
            return None
        match phase:
            case Phase.IDLE if may_launch:
                self._next_ns = t_ns + _ASKS_AGAIN_NS
                return self._mark("launch", t_ns, Command.LAUNCH)
            case Phase.FOLLOW if len(self.orders) < len(self._stations):
                station = self._stations[len(self.orders)]
                self.orders.append((t_ns, station))
                self._next_ns = t_ns + round(HELD_S * 1e9)
                return Order(command=Command.FOLLOW, station=station)
            case Phase.FOLLOW if "hold" not in self.times_ns:
                return self._mark("hold", t_ns, Command.HOLD)
            case Phase.HOLD if self._is_left_behind(t_ns, distance_m):
                self._begin_way_home(t_ns, distance_m)
                return Order(command=Command.RETURN)
            case _:
                return None

    def hear(self, replies: Sequence[CommandReply]) -> None:
        """Take note of a station that is refused, and when it was ordered; the one before it is kept then."""
        for reply in replies:
            if self.orders and "hold" not in self.times_ns and not reply.accepted:
                self.refused[self.orders[-1][0]] = reply.reason

    def note_contact(self, t_ns: int, phase: Phase, *, touches: bool) -> None:
        """Take note of the lift-off, and of what is touched between that and the last descent."""
        if "lifted" not in self.times_ns:
            self._on_deck_ns = t_ns if touches or phase is not Phase.LIFT_OFF else self._on_deck_ns
            if t_ns - self._on_deck_ns > _LIFTED_NS:
                self.times_ns["lifted"] = self._on_deck_ns
        elif touches and not ("return" in self.times_ns and phase in _TOUCHING):
            self.contacts_ns.append(t_ns)

    def is_over(self, t_ns: int, phase: Phase, elapsed_s: float) -> bool:
        """Return whether there is nothing more to wait for, `elapsed_s` after the beginning."""
        if "launch" in self.times_ns and phase in _OVER:
            self._over_ns = t_ns if self._over_ns is None else self._over_ns
            if (t_ns - self._over_ns) * 1e-9 > _END_S:
                return True
        else:
            self._over_ns = None
        began_ns = self.times_ns.get("return")
        limit_s = 3.0 * HELD_S + _AWAY_MAX_S + _LANDING_MAX_S
        return elapsed_s > limit_s or (began_ns is not None and (t_ns - began_ns) * 1e-9 > _LANDING_MAX_S)

    def _is_left_behind(self, t_ns: int, distance_m: float) -> bool:
        """Return whether it is time to call a drone home that was told to hold."""
        held_ns = self.times_ns.get("hold")
        if held_ns is None or "return" in self.times_ns:
            return False
        return distance_m > _AWAY_M or (t_ns - held_ns) * 1e-9 > _AWAY_MAX_S

    def _begin_way_home(self, t_ns: int, distance_m: float) -> None:
        self.times_ns["return"], self.return_from_m = t_ns, distance_m

    def _mark(self, what: str, t_ns: int, command: Command) -> Order:
        self.times_ns[what] = t_ns
        return Order(command=command)
