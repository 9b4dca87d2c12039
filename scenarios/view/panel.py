"""The view's panel: what the landing does now, the operator's buttons or the playback, and the plots."""

import io
from collections.abc import Callable
from html import escape
from typing import Any

import imageio.v3 as iio
import numpy as np
import viser
from numpy.typing import NDArray

from link.messages import Command, CommandReply, CompressedPicture, Vector3
from scenarios.view.history import History
from scenarios.view.panel_text import known_text, phase_text
from scenarios.view.plots import Plots
from scenarios.view.recorded import RecordedSource
from scenarios.view.scene import CAMERAS, FOLLOWED, Scene
from scenarios.view.state import ViewState

_REDUCTION = 2  # of a picture of 1280 x 720 what the panel's width shows


def pixels_of(picture: CompressedPicture) -> NDArray[np.uint8] | None:
    """Return the pixels (rows, columns, 3), reduced, None of bytes that are no picture; of a moving one, the first."""
    try:
        found = iio.imread(io.BytesIO(picture.data), plugin="pillow", index=0, mode="RGB")
    except Exception:  # noqa: BLE001 (pillow raises whatever its decoders meet, such as IndexError and struct.error)
        return None
    return np.ascontiguousarray(np.asarray(found, np.uint8)[::_REDUCTION, ::_REDUCTION])


_RATES = ("0.25", "0.5", "1", "2", "4")


class Panel:
    """The panel beside the scene."""

    def __init__(self, server: viser.ViserServer, scene: Scene) -> None:
        self._gui = gui = server.gui
        gui.configure_theme(control_layout="fixed", control_width="medium", show_logo=False, show_share_button=False)
        gui.set_panel_label("Decklander")
        self._phase = gui.add_html("")
        self._known: Any = None
        self._scene = scene
        self._reply: Any = None
        self._slider: Any = None
        self._button: Any = None
        self._moves = False
        self._plots: Plots | None = None
        self._picture: Any = None
        self._picture_ns: int | None = None

    def add_commands(self, send: Callable[[Command], CommandReply]) -> None:
        """Add the operator's buttons."""
        gui = self._gui

        def ask(command: Command) -> None:
            answer = send(command)
            told = str(answer)
            reply.content = _small(f"{command.value}: {told}")

        def confirm(_: object) -> None:
            with gui.add_modal("Abort the landing?") as question:
                gui.add_html(_small("The drone climbs away from the vehicle and hovers."))
                yes, no = gui.add_button("Abort now", color="red"), gui.add_button("Go on", color="gray")

            def abort_now(_: object) -> None:
                question.close()
                ask(Command.ABORT)

            yes.on_click(abort_now)
            no.on_click(lambda _: question.close())

        start = gui.add_button("Start", color="green", icon=viser.Icon.PLAYER_PLAY)
        hold = gui.add_button("Hold", color="yellow", icon=viser.Icon.HAND_STOP)
        abort = gui.add_button("Abort ...", color="red", icon=viser.Icon.ALERT_TRIANGLE)
        self._reply = reply = gui.add_html("")
        start.on_click(lambda _: ask(Command.START))
        hold.on_click(lambda _: ask(Command.HOLD))
        abort.on_click(confirm)

    def add_playback(self, source: RecordedSource) -> None:
        """Add play, speed and the slider over time."""
        gui = self._gui
        button = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY)
        self._button = button
        self._slider = slider = gui.add_slider("Time [s]", 0.0, max(round(source.duration_s, 1), 0.1), 0.1, 0.0)
        rate = gui.add_dropdown("Speed", _RATES, initial_value="1")

        def played(_: object) -> None:
            source.playing = not source.playing
            if source.playing and source.position_s >= source.duration_s:
                source.position_s = 0.0
            self._show_playing(button, playing=source.playing)

        def scrubbed(_: object) -> None:
            if not self._moves:
                source.playing = False
                source.position_s = float(slider.value)
                self._show_playing(button, playing=False)

        button.on_click(played)
        slider.on_update(scrubbed)
        rate.on_update(lambda _: setattr(source, "rate", float(rate.value)))

    def add_known_camera_and_plots(self, *, with_cursor: bool) -> None:
        """Add what is below the buttons; the plots of a recording mark the instant that is shown."""
        self._known = self._gui.add_html("")
        views = self._gui.add_button_group("Camera", tuple(CAMERAS))
        views.on_click(lambda event: _place_camera(event.client, CAMERAS[views.value]))
        camera = self._gui.add_dropdown("Camera follows", FOLLOWED, initial_value=FOLLOWED[0])
        camera.on_update(lambda _: setattr(self._scene, "followed", camera.value))
        self._plots = Plots(self._gui, with_cursor=with_cursor)

    def show(self, state: ViewState, *, t_s: float, stale: bool) -> None:
        """Write what is known now."""
        self._phase.content = phase_text(state, stale=stale)
        self._known.content = known_text(state, t_s)
        self._show_picture(state.picture)

    def _show_picture(self, picture: CompressedPicture | None) -> None:
        """Show what the detector looks at, once there is such a thing."""
        if picture is None or picture.t_ns == self._picture_ns:
            return
        self._picture_ns = picture.t_ns
        pixels = pixels_of(picture)
        if pixels is None:
            return
        if self._picture is None:
            self._picture = self._gui.add_image(pixels, label="What the detector sees", format="jpeg")
        else:
            self._picture.image = pixels

    def follow(self, source: RecordedSource) -> None:
        """Move the slider along with the playback; at its end the button plays it again."""
        self._moves = True
        self._slider.value = round(source.position_s, 1)
        self._moves = False
        if not source.playing:
            self._show_playing(self._button, playing=False)

    def plot(self, history: History, end: int, now_s: float) -> None:
        """Draw the history up to row `end`."""
        if self._plots is not None:
            self._plots.draw(history, end, now_s)

    @staticmethod
    def _show_playing(button: Any, *, playing: bool) -> None:
        button.label = "Pause" if playing else "Play"
        button.icon = viser.Icon.PLAYER_PAUSE if playing else viser.Icon.PLAYER_PLAY


def _place_camera(client: Any, place: tuple[Vector3, Vector3]) -> None:
    """Move the camera of who asked for it; of a page that has been closed meanwhile there is none."""
    if client is not None:
        client.camera.position, client.camera.look_at = place


def _small(text: str) -> str:
    return f'<div style="font-size:.8rem;padding:0 .8rem" id="reply">{escape(text)}</div>'
