"""The detector on the simulated drone: the real one, which looks at rendered frames in step with the simulation.

Only frames that the pad may be in are looked at, and of these only the parts that the detector asks for are rendered.
"""

from companion.eyes.sight import Frame, SightMemory, sight_step
from link.messages import BodyTruth, PadSighting
from scenarios.config import Scenario
from scenarios.simulation.camera_scene import CameraScene
from scenarios.simulation.noise import Seed, SensorSchedule
from scenarios.simulation.vehicle import VehicleState, vehicle_truth

_DRONE_AGE_MAX_NS = 100_000_000  # an older truth of the drone makes no frame


class CameraSensor:
    """A detector of `SensorSuite`.

    Args:
        scenario: whose camera.
        seed: of what it sees, and of its samples' way.
    """

    def __init__(self, scenario: Scenario, seed: Seed) -> None:
        self.schedule = SensorSchedule(scenario.camera, seed, "camera")
        self._scene = CameraScene(scenario, seed)
        self._memory = SightMemory()

    def sample(self, vehicle: VehicleState, drone: BodyTruth, _elapsed_s: float) -> PadSighting | None:
        """Return what the detector makes of a frame at the drone's own time, None where it sees no pad."""
        if vehicle.t_ns - drone.t_ns > _DRONE_AGE_MAX_NS:
            return None
        picture = self._scene.picture(vehicle_truth(vehicle), drone)
        if not picture.may_show_pad:
            return None
        frame = Frame(t_ns=drone.t_ns, picture=picture, orientation_wxyz=drone.orientation_wxyz)
        self._memory, sight = sight_step(self._memory, frame, self._scene.system)
        return sight.sighting
