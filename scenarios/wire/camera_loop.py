"""The wire loop of the simulated camera: truths off Zenoh in, rendered pictures on Zenoh out, for the real detector.

A picture is rendered as soon as the one before is done, at most at the camera's rate; so on a small computer there are
fewer of them, as of a slow camera.
"""

import signal

import structlog

from companion.eyes.picture import whole
from link.messages import BodyTruth, CameraImage
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.units import NS_PER_S
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.camera.lens import SIZE_PX
from scenarios.config import Scenario
from scenarios.simulation.camera_scene import CameraScene
from scenarios.simulation.noise import Seed

_WAIT_S = 0.2
_IDLE_PERIOD_NS = 200_000_000  # between pictures without the pad: the landing needs the processor


class CameraLoop:
    """Publishes what the drone's camera sees, until a signal comes.

    Args:
        scenario: whose camera.
        seed: of what it sees.
        keys: of the Zenoh contract.
        zenoh: an open session.
    """

    def __init__(self, scenario: Scenario, seed: Seed, keys: Keys, zenoh: ZenohSession) -> None:
        self.bad_payloads = 0
        self._scene = CameraScene(scenario, seed)
        self._period_ns = round(NS_PER_S / scenario.camera.rate_hz)
        self._keys = keys
        self._zenoh = zenoh
        self._drones, self._vehicles = zenoh.subscribe(keys.drone_truth), zenoh.subscribe(keys.vehicle_truth)
        self._vehicle: BodyTruth | None = None
        self._rendered_ns = 0
        self._encoding = cdr.encoding_of(CameraImage)
        self._stopping = False
        self._log = structlog.get_logger("camera")

    def run(self) -> None:
        """Run until a signal comes."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        self._log.info("ready", key=self._keys.camera_image)
        while not self._stopping:
            self._zenoh.wake_up.wait(_WAIT_S)
            self._turn()
        self._log.info("stopped", bad_payloads=self.bad_payloads)

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def _turn(self) -> None:
        self._vehicle = self._newest(self._vehicles) or self._vehicle
        drone = self._newest(self._drones)
        if drone is None or self._vehicle is None:
            return
        picture = self._scene.picture(self._vehicle, drone)
        period_ns = self._period_ns if picture.may_show_pad else max(self._period_ns, _IDLE_PERIOD_NS)
        if 0 <= drone.t_ns - self._rendered_ns < period_ns:
            return
        self._rendered_ns = drone.t_ns
        width_px, height_px = SIZE_PX
        image = CameraImage(
            t_ns=drone.t_ns,
            width_px=width_px,
            height_px=height_px,
            encoding="mono8",
            row_bytes=width_px,
            data=picture.part(whole(SIZE_PX)).shades.tobytes(),
        )
        self._zenoh.publish(self._keys.camera_image, cdr.encode(image), self._encoding)

    def _newest(self, inbox: Inbox) -> BodyTruth | None:
        samples = inbox.take()
        if not samples:
            return None
        try:
            return cdr.decode(BodyTruth, samples[-1].payload)
        except PayloadError:
            self.bad_payloads += 1
            return None
