"""A view in Foxglove: what the page shows, as messages, live from Zenoh or from a recording that plays."""

import signal
import sys
import time
from collections.abc import Iterator

from companion.config.descent import DescentConfig
from link.messages import CompressedPicture
from link.payloads import cdr
from link.payloads.decklander_msgs import RosMessage
from link.payloads.scene import Cone, Scene, log_message, scene_message, transform_message
from link.recording.foxglove_server import FoxgloveServer
from link.zenoh.keys import Keys
from scenarios.view.live import LiveSource
from scenarios.view.recorded import RecordedSource
from scenarios.view.shapes import estimated_vehicle, true_vehicle
from scenarios.view.state import ViewState

_PERIOD_S = 0.05
_SCENE_EVERY = 2  # of these periods


def scene_of(state: ViewState, descent: DescentConfig) -> Scene:
    """Return what a state knows of the landing's geometry: the truth, where there is one, else the estimate."""
    status = state.status
    return Scene(
        t_ns=state.t_ns,
        drone=None if state.drone is None else (state.drone.position_enu_m, state.drone.orientation_wxyz),
        vehicle=true_vehicle(state) or estimated_vehicle(state),
        pad=state.pad,
        cone=Cone(radius_at_pad_m=descent.cone.radius_at_pad_m, slope=descent.cone.slope),
        forecast_enu_m=None if state.forecast is None else state.forecast.position_enu_m,
        forecast_std_m=None if state.forecast is None else state.forecast.std_m,
        plan_enu_m=state.plan_enu_m,
        label="" if status is None else _label(status.phase, status.reason),
    )


def _label(phase: str, reason: str) -> str:
    return f"{phase}: {reason}" if reason else phase


class FoxgloveView:
    """Shows a source in Foxglove, 20 times a second.

    Args:
        source: what it shows.
        descent: for the cone.
        keys: of the Zenoh contract.
        server: to show it by.
    """

    def __init__(
        self, source: LiveSource | RecordedSource, descent: DescentConfig, keys: Keys, server: FoxgloveServer
    ) -> None:
        self._source = source
        self._descent = descent
        self._keys = keys
        self._server = server
        self._told = ""
        self._picture_ns = 0
        self._stopping = False

    def run(self) -> None:
        """Show it until a signal comes."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        sys.stdout.write(f"foxglove: ws://127.0.0.1:{self._server.port}\n")
        sys.stdout.flush()
        tick, due_s = 0, time.monotonic()
        while not self._stopping:
            self.show(tick, time.monotonic())
            tick += 1
            due_s = max(due_s + _PERIOD_S, time.monotonic())
            time.sleep(max(due_s - time.monotonic(), 0.0))
        self._server.close()

    def show(self, tick: int, now_s: float) -> None:
        """Show the source's state of now."""
        state = self._source.advance(now_s)
        if state.t_ns:
            for message in self._messages(scene_of(state, self._descent), tick):
                self._server.add(message, state.t_ns)
        picture = state.picture
        if picture is not None and picture.t_ns != self._picture_ns:
            self._picture_ns = picture.t_ns
            kind = cdr.ROS_TYPES[CompressedPicture]
            self._server.add(
                RosMessage(topic=self._keys.pad_view, type_name=kind, payload=cdr.encode(picture)), picture.t_ns
            )

    def _messages(self, scene: Scene, tick: int) -> Iterator[RosMessage]:
        transforms = transform_message(scene)
        if transforms is not None:
            yield transforms
        if tick % _SCENE_EVERY == 0:
            yield scene_message(scene, self._keys.record("scene"))
        if scene.label != self._told:
            self._told = scene.label
            yield log_message(self._keys.record("log"), scene.t_ns, "companion", scene.label)

    def _stop(self, *_: object) -> None:
        self._stopping = True
