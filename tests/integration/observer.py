"""A bystander of a landing: it hears truth and the companion's status over Zenoh, and scores on truth."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from companion.situation.phases import Phase
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.catalogue.catalogue import load_scenario
from scenarios.recordings.recording import EndWatch, Recording
from scenarios.recordings.result import score_run
from scenarios.recordings.watcher import Watcher
from scenarios.scoring.score import Score
from tests.integration.programs import until

PASSES_SOON = str(Path(__file__).with_name("passes_soon.toml"))
SCENARIO = load_scenario(PASSES_SOON)
SEED = 1
STEADY_STATUSES = 10
"""What is known may go again while an autopilot's clock is being learnt."""


class Observer:
    """Waits for what a landing shows."""

    def __init__(self, zenoh: ZenohSession, keys: Keys) -> None:
        self.zenoh = zenoh
        self.recording = Recording()
        self._watcher = Watcher(zenoh, keys, self.recording)

    def forget(self) -> None:
        """Hear a new run, whose time may begin anywhere."""
        self._watcher.take()
        self.recording.drone.clear()
        self.recording.vehicle.clear()
        self.recording.rotors.clear()

    def wait_for_phase(self, *phases: Phase) -> None:
        """Wait until a status yet to come has one of `phases`."""
        names, seen = {phase.value for phase in phases}, len(self.recording.statuses)

        def is_there() -> bool:
            self.hear()
            return any(status.phase in names for status in self.recording.statuses[seen:])

        until(is_there, f"phase {names}, last was {self.recording.status}")

    def wait_for_status(self) -> None:
        """Wait until the companion says something."""
        seen = len(self.recording.statuses)

        def is_there() -> bool:
            self.hear()
            return len(self.recording.statuses) > seen

        until(is_there, "a status")

    def wait_for_relative_position(self) -> None:
        """Wait until the companion knows, anew and for a while, where the drone and the pad are."""
        seen = len(self.recording.statuses)

        def is_known() -> bool:
            self.hear()
            last = self.recording.statuses[seen:][-STEADY_STATUSES:]
            return len(last) == STEADY_STATUSES and all(one.relative_position_enu_m is not None for one in last)

        until(is_known, f"a relative position, last was {self.recording.status}")

    def wait_for_height(self, height_m: float) -> None:
        """Wait until the drone, on truth, is at least so high."""

        def is_high() -> bool:
            self.hear()
            return bool(self.recording.drone) and self.height_m >= height_m

        until(is_high, f"a height of {height_m} m")

    def wait_for_time(self, duration_s: float) -> None:
        """Wait for `duration_s` of the drone's own time."""
        until_s = self.recording.elapsed_s + duration_s

        def has_passed() -> bool:
            self.hear()
            return self.recording.elapsed_s >= until_s

        until(has_passed, f"{duration_s} s of truth")

    def wait_for_end(self, meanwhile: Callable[[], None] = lambda: None) -> Score:
        """Wait until the run is over, doing something again and again, and return its score on truth."""
        end = EndWatch(SCENARIO.run.time_limit_s)

        def is_over() -> bool:
            meanwhile()
            self.hear()
            return end.reason(self.recording) is not None

        until(is_over, f"the end of the run, last was {self.recording.status}")
        return score_run(SCENARIO, SEED, self.recording)

    @property
    def height_m(self) -> float:
        """Of the drone now, above the road, on truth."""
        return self.recording.drone[-1].position_enu_m[2]

    def hear(self) -> None:
        """Wait a little and take what has come."""
        self.zenoh.wake_up.wait(0.05)
        self.listen()

    def listen(self) -> None:
        """Take what has come, without waiting."""
        self._watcher.take()


@contextmanager
def observer(endpoint: str, keys: Keys | None = None) -> Iterator[Observer]:
    with open_session(ZenohOptions(connect=(endpoint,))) as zenoh:
        yield Observer(zenoh, keys or Keys())
