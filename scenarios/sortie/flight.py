"""A sortie in one process on a simulated clock: an operator who launches, changes stations, holds and calls home.

The drone stands on the deck of a vehicle that drives. It follows at three stations for 20 s each, then stays behind
while the vehicle drives on, until that is 300 m away or a minute has passed; then it comes home and lands.
"""

import math
from collections.abc import Sequence

from companion.config.companion import CompanionConfig
from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.messages import Command, CommandReply, Station, StationFrame
from link.records import replace
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.simulation.noise import Seed
from sim_autopilot.core.data import Surface

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
_SETTLED_S = 1.0  # before the launch: the first fixes have come
_ASKS_AGAIN_NS = 1_000_000_000  # an operator whose launch is refused
_END_S = 2.5  # after the motors are off; the score looks at the drone 2 s after
_LANDING_MAX_S = 240.0  # from the return to the end
_LIFTED_NS = 200_000_000  # off the deck for so long: a rough road's shaking is over in less
_TOUCHING = frozenset({Phase.DESCEND, Phase.TOUCHDOWN, Phase.SECURED})
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


class SortieFlight(Lockstep):
    """A sortie that is advanced step by step.

    Args:
        scenario: whose drone stands on the deck.
        seed: of everything random.
        config: of the companion, None for the scenario's own.
    """

    def __init__(self, scenario: Scenario, seed: Seed, config: CompanionConfig | None = None) -> None:
        super().__init__(scenario, seed, config)
        self.scenario = scenario
        self.seed = seed
        self.return_from_m: float | None = None
        self._stations = stations_of(scenario)
        self._on_deck_ns = 0
        self.orders: list[tuple[int, Station]] = []
        self.refused: dict[int, str] = {}
        self.times_ns: dict[str, int] = {}
        self.contacts_ns: list[int] = []
        self._next_ns = 0
        self._over_ns: int | None = None

    def fly(self) -> str:
        """Fly to the end and return the phase that it ended in."""
        while not self._is_over():
            self.step()
            self._note_contact()
        return self.companion.phase.value

    @property
    def elapsed_s(self) -> float:
        """Simulated time since the beginning."""
        return self.recording.elapsed_s

    def _command(self, node: CompanionNode) -> None:
        t_ns, phase = self.simulation.t_ns, node.phase
        if t_ns < self._next_ns:
            return
        match phase:
            case Phase.IDLE if self.elapsed_s > _SETTLED_S and node.is_ready_to_start():
                self._mark("launch")
                node.request(Command.LAUNCH)
                self._next_ns = t_ns + _ASKS_AGAIN_NS
            case Phase.FOLLOW if len(self.orders) < len(self._stations):
                station = self._stations[len(self.orders)]
                self.orders.append((t_ns, station))
                node.request(Command.FOLLOW, station)
                self._next_ns = t_ns + round(HELD_S * 1e9)
            case Phase.FOLLOW if "hold" not in self.times_ns:
                self._mark("hold")
                node.request(Command.HOLD)
            case Phase.HOLD if "hold" in self.times_ns and "return" not in self.times_ns and self._is_away():
                self._mark("return")
                self.return_from_m = self._distance_m()
                node.request(Command.RETURN)
            case _:
                pass

    def _take(self, replies: Sequence[CommandReply]) -> None:
        """Take note of a station that is refused, and when it was ordered; the one before it is kept then."""
        for reply in replies:
            if self.orders and "hold" not in self.times_ns and not reply.accepted:
                self.refused[self.orders[-1][0]] = reply.reason

    def _mark(self, what: str) -> None:
        self.times_ns[what] = self.simulation.t_ns

    def _is_away(self) -> bool:
        since_s = (self.simulation.t_ns - self.times_ns["hold"]) * 1e-9
        return self._distance_m() > _AWAY_M or since_s > _AWAY_MAX_S

    def _distance_m(self) -> float:
        vehicle = self.simulation.vehicle.state
        if vehicle is None:
            raise ValueError("the vehicle has made no step")
        x, y, _ = self.simulation.autopilot.state.position_enu_m.tolist()
        return math.hypot(x - vehicle.position_enu_m[0], y - vehicle.position_enu_m[1])

    def _note_contact(self) -> None:
        """Take note of the lift-off, and of what is touched between that and the last descent."""
        phase, t_ns = self.companion.phase, self.simulation.t_ns
        touches = self.simulation.autopilot.state.surface is not Surface.NONE
        if "lifted" not in self.times_ns:
            self._on_deck_ns = t_ns if touches or phase is not Phase.LIFT_OFF else self._on_deck_ns
            if t_ns - self._on_deck_ns > _LIFTED_NS:
                self.times_ns["lifted"] = self._on_deck_ns
        elif touches and not ("return" in self.times_ns and phase in _TOUCHING):
            self.contacts_ns.append(t_ns)

    def _is_over(self) -> bool:
        t_ns = self.simulation.t_ns
        if "launch" in self.times_ns and self.companion.phase in _OVER:
            self._over_ns = t_ns if self._over_ns is None else self._over_ns
            if (t_ns - self._over_ns) * 1e-9 > _END_S:
                return True
        else:
            self._over_ns = None
        began_ns = self.times_ns.get("return")
        limit_s = 3.0 * HELD_S + _AWAY_MAX_S + _LANDING_MAX_S
        return self.elapsed_s > limit_s or (began_ns is not None and (t_ns - began_ns) * 1e-9 > _LANDING_MAX_S)
