"""A sortie in one process on a simulated clock, from the deck of a vehicle that drives."""

import math
from collections.abc import Sequence

from companion.runtime.node import CompanionNode
from link.messages import CommandReply
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.simulation.noise import Seed
from scenarios.sortie.script import SortieOperator, stations_of
from sim_autopilot.core.data import Surface

_SETTLED_S = 1.0  # before the launch: the first fixes have come


class SortieFlight(Lockstep):
    """A sortie that is advanced step by step.

    Args:
        scenario: whose drone stands on the deck.
        seed: of everything random.
    """

    def __init__(self, scenario: Scenario, seed: Seed) -> None:
        super().__init__(scenario, seed)
        self.scenario = scenario
        self.seed = seed
        self.operator = SortieOperator(stations_of(scenario))

    def fly(self) -> str:
        """Fly to the end and return the phase that it ended in."""
        operator, simulation = self.operator, self.simulation
        while not operator.is_over(simulation.t_ns, self.companion.phase, self.elapsed_s):
            self.step()
            touches = simulation.autopilot.state.surface is not Surface.NONE
            operator.note_contact(simulation.t_ns, self.companion.phase, touches=touches)
        return self.companion.phase.value

    @property
    def elapsed_s(self) -> float:
        """Simulated time since the beginning."""
        return self.recording.elapsed_s

    def _command(self, node: CompanionNode) -> None:
        may_launch = self.elapsed_s > _SETTLED_S and node.is_ready_to_start()
        t_ns, distance_m = self.simulation.t_ns, self._distance_m()
        order = self.operator.order(t_ns, node.phase, distance_m, may_launch=may_launch)
        if order is not None:
            node.request(order.command, order.station)

    def _take(self, replies: Sequence[CommandReply]) -> None:
        self.operator.hear(replies)

    def _distance_m(self) -> float:
        vehicle = self.simulation.vehicle.state
        if vehicle is None:
            raise ValueError("the vehicle has made no step")
        x, y, _ = self.simulation.autopilot.state.position_enu_m.tolist()
        return math.hypot(x - vehicle.position_enu_m[0], y - vehicle.position_enu_m[1])
