"""A sortie with a firmware's own simulation: from its moving ship, or a pad that drives off under the drone."""

import math

from link.messages import Vector3
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.config import Scenario
from scenarios.firmware.flight import FirmwareFlight
from scenarios.firmware.options import FlyOptions
from scenarios.firmware.ship import UNDER_DRONE_M
from scenarios.firmware.watch import FirmwareWatch
from scenarios.simulation.noise import Seed
from scenarios.simulation.vehicle import VehicleMemory, vehicle_at
from scenarios.simulation.vehicle_node import plan_of
from scenarios.sortie.script import SortieOperator
from scenarios.sortie.task import on_long_road
from sim_autopilot.physics.contact import GEAR_HEIGHT_M

_DEPARTS_S = 1.0  # after the drone has come off the ground: none of it is over a pad that pulls away from below
_REACHED_M = 2.0  # from where the launch ends, 3 m up: the drone is in the air
_FULL_SPEED_M_S = 0.05  # below the ordered one, of a ship that has sped up


def start_of(scenario: Scenario, seed: Seed) -> Vector3:
    """Return where the pad's vehicle begins, in W."""
    return vehicle_at(VehicleMemory(), 0, plan_of(scenario, seed)).position_enu_m


def departing_from_under(scenario: Scenario, seed: Seed) -> Scenario:
    """Return `scenario` with a long road, and a vehicle that departs once a drone has risen from its place.

    Raises:
        UserError: its vehicle stands.
    """
    scenario = on_long_road(scenario)
    east_m, north_m, up_m = start_of(scenario, seed)
    clear_m = up_m + scenario.system.companion.sortie.launch.clear_height_m
    changes = {"wait_for_drone": True, "hover_s": 0.0, "hover_radius_m": _REACHED_M, "departs_s": _DEPARTS_S}
    departure = scenario.track.departure.model_copy(update=changes)
    track = scenario.track.model_copy(update={"departure": departure})
    return scenario.model_copy(update={"track": track}).with_run(waiting_point_enu_m=(east_m, north_m, clear_m))


class FirmwareSortie(FirmwareFlight):
    """A sortie, the companion waiting for orders.

    Args:
        scenario: about the drone's place.
        options: how the flight is made.
        watch: on the simulation.
        keys: of the Zenoh contract.
        zenoh: an open session.
        operator: who gives the orders.
    """

    ship_begins_m = UNDER_DRONE_M

    def __init__(
        self,
        scenario: Scenario,
        options: FlyOptions,
        watch: FirmwareWatch,
        keys: Keys,
        zenoh: ZenohSession,
        *,
        operator: SortieOperator,
    ) -> None:
        super().__init__(scenario, options, watch, keys, zenoh)
        self._operator = operator

    def _over(self) -> str | None:
        phase = self.phase
        if phase is None or not self.recording.drone:
            return None
        t_ns = self.recording.drone[-1].t_ns
        return phase.value if self._operator.is_over(t_ns, phase, self.recording.elapsed_s) else None

    def _operate(self) -> None:
        drone, vehicle, phase = self._watch.drone, self._state, self.phase
        if drone is None or vehicle is None or phase is None:
            return
        self._operator.hear(self._watcher.take_replies())
        distance_m = math.dist(drone.position_enu_m[:2], vehicle.position_enu_m[:2])
        order = self._operator.order(drone.t_ns, phase, distance_m, may_launch=self._may_launch())
        if order is not None:
            self._watcher.command(order)
        stands_m = vehicle.position_enu_m[2] + GEAR_HEIGHT_M  # the ground is the roof
        self._operator.note_contact(drone.t_ns, phase, touches=drone.position_enu_m[2] <= stands_m)

    def _may_launch(self) -> bool:
        """Return whether each knows where the other is, and the ship has sped up."""
        if self._ship_speed_m_s is None:
            return self._awaits_ship()
        ship = self._watch.ship
        return ship is not None and ship.speed_m_s > self._ship_speed_m_s - _FULL_SPEED_M_S

    def _awaits_ship(self) -> bool:
        status = self.recording.status
        return status is not None and status.relative_position_enu_m is not None
