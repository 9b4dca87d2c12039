"""The page: the loop that shows a source 20 times a second until it is interrupted.

The page can fly the drone. So it is served to this machine only, and its WebSocket takes no connection that a page of
another site opens in a browser here.
"""

import io
import logging
import math
import re
import signal
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from http import HTTPStatus
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from companion.config.companion import CompanionConfig
from scenarios.simulation.vehicle_node import plan_of
from scenarios.view.live import LiveSource
from scenarios.view.panel import Panel
from scenarios.view.recorded import RecordedSource, Road
from scenarios.view.scene import Scene

_ICON = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 32 32'%3E%3Crect x='2' y='22' width='28'"
    " height='7' rx='2' fill='%236e7682'/%3E%3Cpath d='M6 8h20M16 8v10m-5-4 5 5 5-5' stroke='%232563eb'"
    " stroke-width='3' fill='none'/%3E%3C/svg%3E"
)
# On a phone viser's panel is a sheet of 60 % of the height over the scene: here it has 40 %, and the scene ends above.
_STYLE = """@media (max-width: 48em) {
  div[style*="max-height: 60%"] { max-height: 40% !important; width: 100% !important; }
  div[style*="max-height: 60%"] div[style*="width: 20em"] { width: 100% !important; }
  div[style*="background-color"][style*="flex-grow: 1"] { height: 60% !important; }
}"""


def client_page() -> bytes:
    """Return the page: viser's under our name. It is never a file, which a process that is killed would leave."""
    plain = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")
    head = f'<title>Decklander</title><link rel="icon" href="{_ICON}"><style>{_STYLE}</style>'
    return plain.replace("<title>Viser</title>", head).encode()


_PERIOD_S = 0.05
_LINES_EVERY = 2  # of these periods
_TEXT_EVERY = 4
_PLOTS_EVERY = 10
_TRAIL_ROWS, _TRAIL_EVERY = 600, 3
_STALE_S = 3.0
_LOOPBACK = "127.0.0.1"
_PAGE_PATHS = ("/", "/index.html")
_OWN_ORIGINS = (None, re.compile(r"http://(127\.0\.0\.1|localhost|\[::1\])(:[0-9]+)?"))
"""Of the page by any name of loopback, at the port of a tunnel, too; what is no browser has none."""


class Page:
    """A page on loopback, until the end of a `with` block.

    Args:
        source: what it shows.
        road: of the vehicle, where it is known.
        port: where; a later one if it is taken, any free one if it is 0.
    """

    def __init__(self, source: LiveSource | RecordedSource, road: Road | None, port: int) -> None:
        self._source = source
        self._server = open_server(port)
        descent = CompanionConfig().descent if road is None else road.scenario.system.companion.descent
        self._scene = Scene(self._server, descent)
        if road is not None:
            self._scene.draw_road(plan_of(road.scenario, road.seed).course.road)
        self._panel = Panel(self._server, self._scene)
        if isinstance(source, RecordedSource):
            self._panel.add_playback(source)
        else:
            self._panel.add_commands(source.send)
        self._panel.add_known_camera_and_plots(with_cursor=isinstance(source, RecordedSource))
        self._stopping = self._was_playing = False
        self._stamp_ns: int | None = None
        self._stamp_seen_s = 0.0
        self._plotted_s: float | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with redirect_stdout(io.StringIO()):  # nor has its end anything to say
            self._server.stop()

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{_LOOPBACK}:{self._server.get_port()}"

    def run(self) -> None:
        """Show it until a signal comes."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)
        sys.stdout.write(f"view: {self.address}\n")
        sys.stdout.flush()
        tick, due_s = 0, time.monotonic()
        while not self._stopping:
            self._show(tick, time.monotonic())
            tick += 1
            due_s = max(due_s + _PERIOD_S, time.monotonic())
            time.sleep(max(due_s - time.monotonic(), 0.0))

    def _stop(self, *_: object) -> None:
        self._stopping = True

    def _show(self, tick: int, now_s: float) -> None:
        source, state = self._source, self._source.advance(now_s)
        end, history = source.shown, source.history
        with self._server.atomic():
            self._scene.show(state)
            if tick % _LINES_EVERY == 0:
                trails = [
                    history.trail(column, end, _TRAIL_ROWS, _TRAIL_EVERY) for column in (history.drone, history.pad)
                ]
                self._scene.show_lines(state, *trails)
        if tick % _TEXT_EVERY == 0:
            t_s = history.times_s[end - 1] if end else 0.0
            self._panel.show(state, t_s=t_s, stale=self._is_stale(now_s))
            if isinstance(source, RecordedSource) and (source.playing or self._was_playing):
                self._was_playing = source.playing
                self._panel.follow(source)
        if tick % _PLOTS_EVERY == 0:
            self._scene.write_labels(state)
            self._plot()

    def _plot(self) -> None:
        """Draw a landing up to now; of a recording, all of it, when another instant is shown."""
        source, history = self._source, self._source.history
        if isinstance(source, LiveSource):
            self._panel.plot(history, source.shown, math.inf)
        elif source.position_s != self._plotted_s:
            self._plotted_s = source.position_s
            self._panel.plot(history, len(history.times_s), source.position_s)

    def _is_stale(self, now_s: float) -> bool:
        """Return whether a live companion has fallen silent."""
        if isinstance(self._source, RecordedSource):
            return False
        status = self._source.state.status
        if status is not None and status.stamp_ns != self._stamp_ns:
            self._stamp_ns, self._stamp_seen_s = status.stamp_ns, now_s
        return now_s - self._stamp_seen_s > _STALE_S


def open_server(port: int) -> viser.ViserServer:
    """Return viser's server on loopback, at a later port if `port` is taken, at any free one if it is 0.

    It takes WebSockets of its own page only: viser itself does not ask where a browser got the page from. Of who speaks
    neither HTTP nor WebSocket nothing is written.
    """
    plain = websockets.asyncio.server.serve
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    websockets.asyncio.server.serve = _serving(plain, client_page())  # type: ignore[assignment,misc]  # for viser
    try:
        with redirect_stdout(io.StringIO()):  # it has a banner of its own
            return viser.ViserServer(host=_LOOPBACK, port=port, verbose=False)
    finally:  # for everybody else
        websockets.asyncio.server.serve = plain  # type: ignore[misc]  # a module's function


def _serving(serve: Callable[..., Any], page: bytes) -> Callable[..., Any]:
    """Return `serve` with our page in place of viser's, for WebSockets of that page."""

    def our_serve(*arguments: Any, process_request: Callable[..., Response | None], **options: Any) -> Any:
        def answer(connection: ServerConnection, request: Request) -> Response | None:
            if "Upgrade" in request.headers or request.path.partition("?")[0] not in _PAGE_PATHS:
                return process_request(connection, request)
            headers = Headers({"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(page))})
            return Response(HTTPStatus.OK, "OK", headers, page)

        return serve(*arguments, process_request=answer, origins=_OWN_ORIGINS, **options)

    return our_serve
