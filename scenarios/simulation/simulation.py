"""The simulated side of a run in one process, without I/O: the vehicle, the air and the autopilot with its drone.

`scenarios world` puts sockets around it, a lockstep run puts it beside a companion.
"""

from msgspec import Struct

from link.messages import BodyTruth, RotorTruth
from link.records import replace
from link.zenoh.keys import Keys, Publication
from scenarios.config import Scenario
from scenarios.simulation.drone import sim_autopilot_config
from scenarios.simulation.noise import Seed, part_seed
from scenarios.simulation.vehicle import vehicle_deck, vehicle_truth
from scenarios.simulation.vehicle_node import VehicleNode
from sim_autopilot.plant.snapshot import drone_truth, rotor_truth
from sim_autopilot.runtime.build import autopilot_config
from sim_autopilot.runtime.node import STEP_NS, AutopilotNode
from sim_autopilot.runtime.physics import air_model

__all__ = ["STEP_NS", "Simulation", "SimulationOutputs"]


class SimulationOutputs(Struct, frozen=True, kw_only=True):
    """What one step of the simulated side brings.

    Attributes:
        mavlink: bytes of the autopilot.
        publications: of the vehicle and its sensors.
        drone: its truth at the end of the step.
        rotors: the drone's, at the end of the step.
        vehicle: its truth at the end of the step.
    """

    mavlink: bytes
    publications: list[Publication]
    drone: BodyTruth
    rotors: RotorTruth
    vehicle: BodyTruth


class Simulation:
    """The world of a scenario and a seed.

    Args:
        scenario: what is flown.
        seed: of everything random.
        keys: of the Zenoh contract.
        start_ns: UTC at its beginning.
        instant: the autopilot is ready at once.
        publishes_truth: the vehicle's truth is among the publications.
        has_eyes: the drone's camera is part of it.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: Seed,
        keys: Keys,
        start_ns: int,
        *,
        instant: bool = False,
        publishes_truth: bool = True,
        has_eyes: bool = True,
    ) -> None:
        self.vehicle = VehicleNode(scenario, seed, keys, publishes_truth=publishes_truth, has_eyes=has_eyes)
        settings = sim_autopilot_config(scenario, seed, instant=instant)
        config = autopilot_config(settings)
        own_state = replace(config.own_state, seed=part_seed(seed, "own state"))
        range_finder = replace(config.range_finder, seed=part_seed(seed, "range finder"))
        self.autopilot = AutopilotNode(replace(config, own_state=own_state, range_finder=range_finder), start_ns)
        self._body = scenario.vehicle
        self._air = air_model(settings, part_seed(seed, "turbulence"), part_seed(seed, "wake"))
        self._drone = drone_truth(self.autopilot.state)

    @property
    def t_ns(self) -> int:
        """UTC now."""
        return self.autopilot.state.t_ns

    def receive(self, data: bytes, peer: int = 0, *, is_datagram: bool = False) -> bytes:
        """Take a peer's bytes of a MAVLink link and return what is answered at once."""
        return self.autopilot.receive(data, self.t_ns, peer=peer, is_datagram=is_datagram)[0]

    def step(self) -> SimulationOutputs:
        """Advance by `STEP_NS`."""
        publications = self.vehicle.step(self.autopilot.next_ns, self._drone)
        state = self.vehicle.state
        if state is None:
            raise ValueError("the vehicle has made no step")
        deck = vehicle_deck(state, self._body)
        air_enu_m_s = self._air.advance(self.autopilot.step_ns * 1e-9, self.autopilot.state, deck)
        (mavlink,) = self.autopilot.step(deck, air_enu_m_s)
        self._drone = drone_truth(self.autopilot.state)
        return SimulationOutputs(
            mavlink=mavlink,
            publications=publications,
            drone=self._drone,
            rotors=rotor_truth(self.autopilot.state),
            vehicle=vehicle_truth(state),
        )
