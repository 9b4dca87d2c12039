"""The simulated vehicle with its sensors, without I/O: time and the drone's truth in, Zenoh payloads out.

The `ground-vehicle` program, the one-process world and the lockstep campaigns all step this one node.
"""

import math
from functools import partial

from link.frames.geodesy import Datum
from link.messages import BodyTruth, Fix, FixVelocity, PadGeometry, PadSighting, Vector3, VehicleImu
from link.payloads import cdr
from link.program.extras import require
from link.zenoh.keys import Keys, Publication
from scenarios.config import Scenario, SensorsConfig
from scenarios.simulation.noise import Seed, named_rng
from scenarios.simulation.sensors import Detector, Mounting, SensorSuite
from scenarios.simulation.vehicle import (
    VehicleInputs,
    VehicleMemory,
    VehiclePlan,
    VehicleState,
    vehicle_step,
    vehicle_truth,
)
from scenarios.tracks.tracks import course_of
from sim_autopilot.runtime.config import DatumConfig

TRUTH_PERIOD_NS = 10_000_000  # 100 Hz, what the score asks for
STEP_PERIOD_NS = 10_000_000  # the fastest sensor of the catalogue takes 100 samples a second


class VehicleNode:
    """The vehicle of a scenario and a seed.

    Args:
        scenario: whose vehicle, sensors and datum.
        seed: of everything random.
        keys: of the Zenoh contract.
        publishes_truth: where nobody listens to it, leaving it out saves a third of the time.
        has_eyes: its sensors have the drone's camera among them, where the scenario has one; else that is a program of
            its own.

    Attributes:
        pad: what the `pad` queryable tells.
        plan: what the vehicle does.
        memory: what has happened to it.
        state: where it is, None before the first step.
        is_silent: it tells nothing; only what sees its pad from the drone publishes.
    """

    def __init__(
        self, scenario: Scenario, seed: Seed, keys: Keys, *, publishes_truth: bool = True, has_eyes: bool = True
    ) -> None:
        self.pad: PadGeometry = scenario.vehicle.pad
        self.plan = plan_of(scenario, seed)
        self.memory = VehicleMemory()
        self.state: VehicleState | None = None
        mounting = Mounting(antenna_flu_m=scenario.vehicle.antenna_flu_m, pad_height_m=scenario.vehicle.roof_height_m)
        detector = _camera_of(scenario, seed) if has_eyes else None
        datum = datum_of(scenario.run.datum)
        self._suite = partial(SensorSuite, seed=seed, mounting=mounting, datum=datum, detector=detector)
        sensors = scenario.sensors.model_copy(update={"pattern": None}) if scenario.has_camera else scenario.sensors
        self._sensors = self._suite(sensors)
        self._keys: dict[type[cdr.Message], str] = {
            Fix: keys.fix,
            FixVelocity: keys.fix_velocity,
            VehicleImu: keys.imu,
            PadSighting: keys.pad_pose,
            BodyTruth: keys.vehicle_truth,
        }
        self._encodings = {kind: cdr.encoding_of(kind) for kind in self._keys}
        self._publishes_truth = publishes_truth
        self.is_silent = scenario.is_silent
        self._truth_due_ns = 0

    def set_sensors(self, sensors: SensorsConfig, mounting: Mounting | None = None) -> None:
        """Let the sensors err otherwise, or sit elsewhere, from now on; what of them is random restarts."""
        self._sensors = self._suite(sensors) if mounting is None else self._suite(sensors, mounting=mounting)

    def set_clock(self, ahead_s: float) -> None:
        """Set the vehicle's clock ahead by `ahead_s`."""
        self._sensors.set_clock(ahead_s)

    def slide_fixes(self, by_enu_m_s: Vector3) -> None:
        """Let the vehicle's fixes slide away from now on; its velocities stay true."""
        self._sensors.slide_fixes(by_enu_m_s)

    def step(self, t_ns: int, drone: BodyTruth | None) -> list[Publication]:
        """Return what is to be published at `t_ns`, truth first; a time that has not advanced yields nothing.

        Args:
            t_ns: the present; every 10 ms does for all sensors of the catalogue.
            drone: the newest truth of the drone, None before there is one.
        """
        if self.state is not None and t_ns <= self.state.t_ns:
            return []
        self.memory, self.state = vehicle_step(self.memory, VehicleInputs(t_ns=t_ns, drone=drone), self.plan)
        return self.published(self.state, drone)

    def published(self, state: VehicleState, drone: BodyTruth | None) -> list[Publication]:
        """Return what is to be published of a vehicle in `state`, truth first."""
        t_ns = state.t_ns
        samples = self._sensors.step(t_ns, state, drone)
        publications = [self._publish(one) for one in samples if not self.is_silent or isinstance(one, PadSighting)]
        if not self._publishes_truth or t_ns < self._truth_due_ns:
            return publications
        self._truth_due_ns = max(self._truth_due_ns + TRUTH_PERIOD_NS, t_ns + 1)
        return [self._publish(vehicle_truth(state)), *publications]

    def _publish(self, message: Fix | FixVelocity | VehicleImu | PadSighting | BodyTruth) -> Publication:
        kind = type(message)
        return Publication(key=self._keys[kind], payload=cdr.encode(message), encoding=self._encodings[kind])


def _camera_of(scenario: Scenario, seed: Seed) -> Detector | None:
    if not scenario.has_camera:
        return None
    require("camera", "+camera")
    from scenarios.simulation.camera_scene import CameraSensor  # noqa: PLC0415 (OpenCV is an extra)

    return CameraSensor(scenario, seed)


def plan_of(scenario: Scenario, seed: Seed) -> VehiclePlan:
    """Return what the vehicle of `scenario` does with `seed`."""
    return VehiclePlan(
        course=course_of(scenario.track, named_rng(seed, "track")),
        departure=scenario.track.departure,
        waiting_point_enu_m=scenario.run.waiting_point_enu_m,
        roof_height_m=scenario.vehicle.roof_height_m,
    )


def datum_of(config: DatumConfig) -> Datum:
    """Return the origin of W."""
    return Datum(
        latitude_rad=math.radians(config.latitude_deg),
        longitude_rad=math.radians(config.longitude_deg),
        altitude_m=config.altitude_m,
    )


def departing_at_once(scenario: Scenario) -> Scenario:
    """Return `scenario` with a vehicle that does not wait for the drone."""
    departure = scenario.track.departure.model_copy(update={"wait_for_drone": False})
    track = scenario.track.model_copy(update={"departure": departure})
    return scenario.model_copy(update={"track": track})
