"""The view in a browser: it follows a landing to its end, and its buttons fly it."""

import shutil
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Error, Page, sync_playwright
from playwright.sync_api import TimeoutError as TooLateError

from link.payloads.decklander_msgs import fields_of
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from scenarios.recordings.replay import read_flights
from tests.integration.observer import PASSES_SOON
from tests.integration.programs import DEADLINE_S, Program, Programs, until

CHROMIUM = shutil.which("chromium")
DEADLINE_MS = DEADLINE_S * 1e3
FLAGS = (
    *("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
# Keeps each phase that the panel has shown, however short.
WATCH = """() => {
    window.phases = [];
    const look = () => {
        const phase = document.querySelector('#phase')?.textContent;
        if (phase && phase !== window.phases.at(-1)) window.phases.push(phase);
    };
    new MutationObserver(look).observe(document.body, {childList: true, subtree: true, characterData: true});
    look();
}"""

pytestmark = [
    pytest.mark.wire,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium; apt-get install chromium"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    profile = tmp_path_factory.mktemp("profile")
    with sync_playwright() as playwright:
        context = playwright.chromium.launch_persistent_context(
            profile, executable_path=CHROMIUM, headless=True, args=list(FLAGS), viewport={"width": 900, "height": 400}
        )
        context.set_default_timeout(DEADLINE_MS)
        yield context.new_page()
        context.close()


@pytest.fixture
def programs() -> Iterator[Programs]:
    with Programs() as started:
        yield started


def open_page(page: Page, address: str) -> None:
    """Open a page that may not be there yet."""

    def is_there() -> bool:
        try:
            page.goto(address)
        except Error:
            page.wait_for_timeout(200)
            return False
        return True

    until(is_there, address)
    page.wait_for_selector("#phase", timeout=DEADLINE_MS)
    page.evaluate(WATCH)


def address_of(program: Program) -> str:
    return program.out.wait_for("view: ").removeprefix("view: ")


def press(page: Page, buttons: tuple[str, ...], command: str, phase: str) -> None:
    """Press buttons until the page shows `phase`: a busy companion answers late, and one that is not ready refuses."""
    end_s = time.monotonic() + DEADLINE_S
    while True:
        for name in buttons:
            # The last of them: a question that was answered may still be fading out.
            page.get_by_role("button", name=name, exact=True).last.dispatch_event("click")
        page.wait_for_selector(f"#reply:has-text('{command}:')", timeout=DEADLINE_MS)
        try:
            page.wait_for_function("phase => window.phases.includes(phase)", arg=phase, timeout=3000.0)
        except TooLateError:
            assert time.monotonic() < end_s, f"no {phase} after {command}: {page.inner_text('#reply')}"
        else:
            return


def wait_for_phase(page: Page, phase: str) -> list[str]:
    """Return the phases that the page has shown once `phase` is among them."""
    end_s = time.monotonic() + DEADLINE_S
    while phase not in (phases := [str(one) for one in page.evaluate("() => window.phases")]):
        assert time.monotonic() < end_s, f"no {phase} among {phases}: {page.inner_text('#reason')}"
        page.wait_for_timeout(100)
    return phases


def open_world(page: Page, programs: Programs, *options: str) -> Program:
    """Let the world, the companion and the view run until the page shows the companion; return the companion.

    At the speed of a real flight: beside a browser that draws, two cores have no time to spare.
    """
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    speaking = ("--mavlink", f"udpout:127.0.0.1:{port}", "-l", endpoint)
    programs.start("scenarios", "world", PASSES_SOON, *speaking)
    listening = ("--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint, "--use-sim-time")
    companion = programs.start("companion", *listening, *options)
    open_page(page, address_of(programs.start("scenarios", "view", "--port", "0", "-e", endpoint)))
    wait_for_phase(page, "idle")
    return companion


@pytest.fixture(scope="module")
def landing(page: Page, tmp_path_factory: pytest.TempPathFactory) -> tuple[list[str], Path]:
    """The phases that the page has shown of a landing, and the companion's recording of it."""
    folder = tmp_path_factory.mktemp("recorded")
    with Programs() as programs:
        companion = open_world(page, programs, "--record", str(folder))
        press(page, ("Start",), "start", "takeoff")
        phases = wait_for_phase(page, "secured")
        companion.send(signal.SIGINT)
        companion.wait()
    return phases, folder


def test_page_shows_the_phases_that_the_companion_went_through_until_it_is_secured(
    landing: tuple[list[str], Path],
) -> None:
    phases, folder = landing
    assert phases[:3] == ["idle", "takeoff", "waiting"]
    assert phases[-1] == "secured"
    ((_, flight),) = read_flights(folder)
    steps = flight.outputs[flight.keys.record("step")]
    told = (fields_of(step.payload, step.type_name)["phase"] for step in steps)
    assert all(phase in told for phase in phases)  # an iterator: each one after the one before


def test_recording_waits_plays_pauses_and_shows_any_instant(
    page: Page, programs: Programs, landing: tuple[list[str], Path]
) -> None:
    open_page(page, address_of(programs.start("scenarios", "view", "--port", "0", str(landing[1]))))
    page.get_by_role("button", name="Play", exact=True).dispatch_event("click")
    page.get_by_role("button", name="Pause", exact=True).dispatch_event("click")
    page.get_by_role("button", name="Play", exact=True).wait_for(timeout=DEADLINE_MS)
    instant = page.locator("input[type=text]").first
    instant.fill("60")  # behind the end, so the end
    instant.press("Enter")
    wait_for_phase(page, "secured")


def test_buttons_of_the_page_start_and_abort_a_flight(page: Page, programs: Programs) -> None:
    open_world(page, programs)
    press(page, ("Start",), "start", "takeoff")
    wait_for_phase(page, "waiting")
    press(page, ("Abort ...", "Abort now"), "abort", "hold")
    assert "descend" not in wait_for_phase(page, "hold")
