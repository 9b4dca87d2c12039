"""The view's panel: what the landing does now, the operator's buttons or the playback, and the plots."""

import math
from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np
import viser
from viser import uplot

from link.messages import Command, CommandReply, CompressedPicture
from link.program.status_rows import link_rows, number, status_rows
from scenarios.view.history import NAMES, History
from scenarios.view.picture import pixels_of
from scenarios.view.recorded import RecordedSource
from scenarios.view.scene import BLUE, FOLLOWED, GREEN, GREY, ORANGE, Scene
from scenarios.view.state import ViewState

_POINTS_MIN, _POINTS_MAX = 2, 300
_RATES = ("0.25", "0.5", "1", "2", "4")
_LEGEND = ((BLUE, "flown"), (GREY, "pad's way"), (GREEN, "plan, cone"), (ORANGE, "estimate, forecast"))
_PLOTS = (
    ("height and distance [m]", (("height_m", "height", BLUE), ("distance_m", "distance", ORANGE))),
    ("speed [m/s]", (("drone_speed_m_s", "drone", BLUE), ("vehicle_speed_m_s", "vehicle", GREY))),
    ("relative speed [m/s]", (("relative_speed_m_s", "relative", GREEN),)),
    ("error of the estimate [m]", (("error_m", "error", ORANGE),)),
)  # fmt: skip
_VALUE = "text-align:right;white-space:nowrap"
_PAINT = {
    "descend": "#169146", "touchdown": "#169146", "secured": "#0f6b33", "abort": "#c62828", "hold": "#b26a00",
    "pilot in command": "#c62828",
}  # fmt: skip


class Panel:
    """The panel beside the scene."""

    def __init__(self, server: viser.ViserServer, scene: Scene) -> None:
        self._gui = gui = server.gui
        gui.configure_theme(control_layout="fixed", control_width="medium", show_logo=False, show_share_button=False)
        gui.set_panel_label("Decklander")
        self._text = gui.add_html("")
        self._scene = scene
        self._reply: Any = None
        self._slider: Any = None
        self._button: Any = None
        self._moves = False
        self._plots: list[tuple[Any, tuple[str, ...]]] = []
        self._picture: Any = None
        self._picture_ns: int | None = None

    def add_commands(self, send: Callable[[Command], CommandReply]) -> None:
        """Add the operator's buttons."""
        gui = self._gui

        def ask(command: Command) -> None:
            answer = send(command)
            told = "accepted" if answer.accepted else f"refused: {answer.reason}"
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

    def add_camera_and_plots(self) -> None:
        """Add what is below."""
        camera = self._gui.add_dropdown("Camera follows", FOLLOWED, initial_value=FOLLOWED[0])
        camera.on_update(lambda _: setattr(self._scene, "followed", camera.value))
        for title, lines in _PLOTS:
            series = tuple(uplot.Series(label=label, stroke=_css(color), width=2) for _, label, color in lines)
            plot = self._gui.add_uplot(
                tuple(np.zeros(2) for _ in range(len(lines) + 1)),
                (uplot.Series(label="t [s]"), *series),
                title=title,
                scales={"x": uplot.Scale(time=False, auto=True)},
                legend=uplot.Legend(show=True),
                height=165,
            )
            self._plots.append((plot, tuple(name for name, _, _ in lines)))

    def show(self, state: ViewState, *, t_s: float, stale: bool) -> None:
        """Write what is known now."""
        self._text.content = _text(state, t_s, stale=stale)
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

    def plot(self, history: History, end: int) -> None:
        """Draw the history up to row `end`."""
        times_s, values = history.columns(end, _POINTS_MAX)
        for plot, names in self._plots:
            shown = values[:, [NAMES.index(name) for name in names]]
            known = np.isfinite(shown).all(axis=1)
            if known.sum() >= _POINTS_MIN:
                plot.data = (times_s[known], *np.ascontiguousarray(shown[known].T))

    @staticmethod
    def _show_playing(button: Any, *, playing: bool) -> None:
        button.label = "Pause" if playing else "Play"
        button.icon = viser.Icon.PLAYER_PAUSE if playing else viser.Icon.PLAYER_PLAY


def _css(color: tuple[int, int, int]) -> str:
    return "rgb({}, {}, {})".format(*color)


def _small(text: str) -> str:
    return f'<div style="font-size:.8rem;padding:0 .8rem" id="reply">{escape(text)}</div>'


def _text(state: ViewState, t_s: float, *, stale: bool) -> str:
    status = state.status
    phase = "no companion" if status is None or stale else status.phase
    reason = "waiting for its status" if status is None or stale else status.reason
    paint = _PAINT.get(phase, "#2563eb")
    rows = "".join(
        f'<tr><td style="color:#667">{escape(name)}</td><td style="{_VALUE}">{escape(value)}</td></tr>'
        for name, value in _rows(state, t_s)
    )
    legend = " ".join(
        f'<span style="white-space:nowrap"><span style="color:{_css(color)}">&#9632;</span> {name}</span>'
        for color, name in _LEGEND
    )
    return (
        '<div style="padding:.2rem .8rem;font-size:.78rem;line-height:1.35">'
        f'<div id="phase" style="font-size:1.35rem;font-weight:700;color:{paint}">{escape(phase)}</div>'
        f'<div id="reason" style="min-height:2.7em;color:#334">{escape(reason)}</div>'
        f'<table style="width:100%;font-variant-numeric:tabular-nums">{rows}</table>'
        f'<div style="margin-top:.3rem;font-size:.72rem">{legend}</div></div>'
    )


def _rows(state: ViewState, t_s: float) -> list[tuple[str, str]]:
    speed_m_s = None if state.drone is None else math.hypot(*state.drone.velocity_flu_m_s)
    rows = [("time", f"{t_s:.1f} s"), *status_rows(state.status), ("drone's speed", number(speed_m_s, "m/s"))]
    vehicle_m_s = None
    if state.vehicle_truth is not None:
        vehicle_m_s = math.hypot(*state.vehicle_truth.velocity_flu_m_s)
    elif state.estimate is not None:
        vehicle_m_s = math.hypot(*(float(value) for value in state.estimate.velocity_enu_m_s))
    rows += [("vehicle's speed", number(vehicle_m_s, "m/s")), ("pad seen", seen_text(state))]
    if state.link is not None:
        link = state.link
        rows += link_rows(
            link.messages_received, link.messages_sent, link.lost_messages, link.bad_bytes, link.bad_payloads
        )
    return rows


def seen_text(state: ViewState) -> str:
    """Return how far away the detector last saw the pad, how well, and how long ago."""
    sighting = state.sighting
    if sighting is None:
        return "-"
    age_s = (state.t_ns - sighting.t_ns) * 1e-9
    std_m = math.sqrt(max(0.0, *sighting.position_covariance_m2[::4]))
    return f"{math.hypot(*sighting.position_flu_m):.2f} m away to {std_m:.2f} m, {max(age_s, 0.0):.1f} s ago"
