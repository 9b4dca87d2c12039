"""A lockstep sortie in which things can be made to fail: beside a vehicle that drives, and on the way home to it."""

import math

from companion.core.data import Rival
from companion.situation.phases import Phase
from link.messages import Command, Station, StationFrame
from link.records import replace
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.faults.flight import FaultFlight
from scenarios.simulation.vehicle_node import departing_at_once
from scenarios.tracks.config import MovingTrack

STATION = Station(offset_m=(-2.0, 6.0, 2.0), frame=StationFrame.VEHICLE)
_AT_STATION_S = 6.0  # the way there is over
_LEFT_BEHIND_M = 60.0  # so far away the vehicle is when the drone is called home: a way of some seconds
_LEFT_BEHIND_MAX_S = 60.0
_ROAD_S = 240.0
_TIME_LIMIT_S = 200.0  # longer than any case: no operator calls it off


def sortie_of(scenario: Scenario) -> Scenario:
    """Return `scenario` with a vehicle that drives from the start, on a road that is long enough for a sortie."""
    scenario = departing_at_once(scenario).with_run(time_limit_s=_TIME_LIMIT_S)
    track = scenario.track
    if isinstance(track, MovingTrack):
        track = track.model_copy(update={"road_s": max(track.road_s, _ROAD_S)})
    return scenario.model_copy(update={"track": track})


class SortieFaultFlight(FaultFlight):
    """A sortie to be disturbed.

    Args:
        scenario: what is flown, from the road.
        seed: of everything random.
    """

    def __init__(self, scenario: Scenario, seed: int) -> None:
        super().__init__(sortie_of(scenario), seed)

    def fly_to(self, phase: Phase) -> None:
        """Go on to a station, or, left behind by the vehicle, to the first step of the way home.

        Raises:
            ValueError: it is not reached.
        """
        super().fly_to(Phase.WAITING)
        self._follow()
        self.fly(_AT_STATION_S)
        if phase is Phase.FOLLOW:
            return
        self._order(Command.HOLD, Phase.HOLD)
        until_s = self.recording.elapsed_s + _LEFT_BEHIND_MAX_S
        while self._distance_m() < _LEFT_BEHIND_M and self.recording.elapsed_s < until_s:
            self.step()
        self._order(Command.RETURN, phase)

    def empty_battery(self, share: float) -> None:
        """Let the autopilot's battery have `share` left."""
        self.simulation.autopilot.set_charge(share)

    def brake_vehicle(self) -> None:
        """Let the vehicle brake as hard as its track has it, to a stop."""
        vehicle = self.simulation.vehicle
        vehicle.memory = replace(vehicle.memory, brakes_ns=self.simulation.t_ns)

    def lose_corrections(self, white_m: float, bias_m: float) -> None:
        """Let the vehicle's receiver err like one without corrections, and say so."""
        fix = self.scenario.sensors.fix.model_copy(update={"white_m": white_m, "bias_m": bias_m})
        self.simulation.vehicle.set_sensors(self.scenario.sensors.model_copy(update={"fix": fix}))

    def add_rival(self) -> None:
        """Let another companion be found that was there first for this drone."""
        self.companion.receive_rival(Rival(drone=Keys().drone, is_this_drone=True))

    def _follow(self) -> None:
        self.companion.request(Command.FOLLOW, STATION)
        while self.phase is not Phase.FOLLOW:
            self.step()

    def _distance_m(self) -> float:
        drone, vehicle = self.recording.drone[-1], self.recording.vehicle[-1]
        return math.dist(drone.position_enu_m[:2], vehicle.position_enu_m[:2])
