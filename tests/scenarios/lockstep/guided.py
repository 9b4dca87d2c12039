"""The autopilots' own precision landing, guided by the companion.

A pilot who sees the vehicle takes off, flies over the pad and changes to LAND (ArduCopter) or Precision Land (PX4); the
companion only tells where the pad is.

    python -m tests.scenarios.lockstep.guided SEEDS FIRMWARE
"""

import json
import statistics
import sys
from enum import Enum, auto
from math import dist

from companion.config.autopilot import Guide
from companion.runtime.node import CompanionNode
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from scenarios.catalogue.catalogue import load_changed_scenario
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Score
from tests.sim_autopilot.copter import GUIDED, LAND, mode
from tests.sim_autopilot.pilot import POSITION_VELOCITY, arm, command, set_mode, setpoint

ABOVE_PAD_M = 6.0
_PERIOD_NS = 100_000_000
_NEAR_M, _SLOW_M_S, _STEADY_NS = 0.5, 0.3, 2_000_000_000
_ON_PAD_NS = 4_000_000_000
_LIMIT_S = 150.0
_GIVES_UP_NS = 60_000_000_000
"""Three times as long as ArduCopter takes."""
_PRECISION = {"ardupilot": {"PLND_ENABLED": 1.0, "PLND_TYPE": 1.0, "PLND_OPTIONS": 1.0}, "px4": {}}


def scenario_at(speed_m_s: float, guide: Guide, firmware: str) -> Scenario:
    """A straight road with nominal sensors and wind, and a pad that stands or drives."""
    road = f"track.speed_m_s={speed_m_s}"
    return load_changed_scenario(
        f"{'straight_2' if speed_m_s else 'static'}+sensors=nominal+wind=nominal+link=nominal+firmware={firmware}",
        [
            *([road] if speed_m_s else []),
            f"system.companion.autopilot.guide={guide.value}",
            *(f"system.parameters.{firmware}.{name}={value}" for name, value in _PRECISION[firmware].items()),
        ],
    )


class _Stage(Enum):
    ON_GROUND = auto()
    TO_PAD = auto()
    LAND = auto()


class GuidedLanding(Lockstep):
    """A run whose drone is flown by a pilot at a ground station; the companion gives no command.

    Attributes:
        land_ns: when the pilot changed to the landing mode.
    """

    def __init__(self, scenario: Scenario, seed: int) -> None:
        super().__init__(scenario, seed)
        self.land_ns: int | None = None
        self._station = MavlinkCodec(255, mavlink.MAV_COMP_ID_MISSIONPLANNER)
        self._is_copter = scenario.firmware == "ardupilot"
        self._stage = _Stage.ON_GROUND
        self._due_ns = self._near_ns = self._off_ns = 0

    def fly(self) -> None:
        """Fly until the motors have been off for a while, or for too long."""
        while self.recording.elapsed_s < _LIMIT_S and not self._has_ended():
            self.step()

    def step(self) -> None:
        """Advance by one step, after what the pilot does now."""
        t_ns = self.simulation.t_ns
        if t_ns >= self._due_ns and self.simulation.vehicle.state is not None:
            self._due_ns = t_ns + _PERIOD_NS
            data = b"".join(map(self._station.encode, self._orders(t_ns)))
            self.simulation.receive(data)
        super().step()

    def _command(self, node: CompanionNode) -> None:
        """Leave the companion alone."""

    def _orders(self, t_ns: int) -> list[Message]:
        own, pad = self.simulation.autopilot.state, self.simulation.vehicle.state
        if pad is None or self._stage is _Stage.LAND:
            return []
        height_m = self._mounting.antenna_flu_m[2] + ABOVE_PAD_M
        if self._stage is _Stage.ON_GROUND:
            if own.position_enu_m[2] > height_m - 1.0:
                self._stage = _Stage.TO_PAD
            return self._rise(height_m)
        place, velocity = pad.position_enu_m, pad.velocity_enu_m_s
        away_m = dist(own.position_enu_m[:2].tolist(), place[:2])
        slip_m_s = dist(own.velocity_enu_m_s[:2].tolist(), velocity[:2])
        self._near_ns = t_ns if away_m > _NEAR_M or slip_m_s > _SLOW_M_S else self._near_ns
        if t_ns - self._near_ns > _STEADY_NS:
            self._stage, self.land_ns = _Stage.LAND, t_ns
            return [mode(LAND) if self._is_copter else set_mode(4, 9)]
        ned = (place[1], place[0], -height_m), (velocity[1], velocity[0], 0.0)
        return [setpoint(*ned, mask=POSITION_VELOCITY)]

    def _rise(self, height_m: float) -> list[Message]:
        """Take off: ArduCopter by a command, PX4 by setpoints, which go on."""
        is_armed = self.simulation.autopilot.memory.armed_ns is not None
        if self._is_copter:
            takeoff = command(mavlink.MAV_CMD_NAV_TAKEOFF, *(0.0,) * 6, height_m)
            return [] if is_armed else [mode(GUIDED), arm(), takeoff]
        hover = setpoint((0.0, 0.0, -height_m))
        return [hover] if is_armed else [hover, set_mode(6), arm()]

    def _has_ended(self) -> bool:
        t_ns = self.simulation.t_ns
        armed = self.simulation.autopilot.memory.armed_ns is not None
        self._off_ns = t_ns if armed or self._stage is not _Stage.LAND else self._off_ns
        gives_up = self.land_ns is not None and armed and t_ns - self.land_ns > _GIVES_UP_NS
        return gives_up or t_ns - self._off_ns > _ON_PAD_NS


def guided(speed_m_s: float, seed: int, firmware: str) -> tuple[Score, float | None]:
    """The score of a guided landing, and the seconds from the change of the mode to the contact."""
    scenario = scenario_at(speed_m_s, Guide.PRECLAND, firmware)
    run = GuidedLanding(scenario, seed)
    run.fly()
    scored = score_run(scenario, seed, run.recording)
    contact = scored.touchdown
    return scored, None if contact is None or run.land_ns is None else (contact.contact_t_ns - run.land_ns) * 1e-9


def own(speed_m_s: float, seed: int, firmware: str) -> tuple[Score, float | None]:
    """The score of the companion's own landing with the same seed, and the seconds from its chase to the contact."""
    scenario = scenario_at(speed_m_s, Guide.SETPOINTS, firmware)
    run = Lockstep(scenario, seed)
    run.run()
    scored = score_run(scenario, seed, run.recording)
    contact, began_s = scored.touchdown, run.recording.phase_times_s().get("chase")
    if contact is None or began_s is None:
        return scored, None
    return scored, (contact.contact_t_ns - run.recording.drone[0].t_ns) * 1e-9 - began_s


def main() -> None:
    """Print a line of JSON for each speed and way of landing."""
    for speed_m_s in (0.0, 1.0, 2.0):
        for land in (guided, own):
            flights = [land(speed_m_s, seed, sys.argv[2]) for seed in range(1, 1 + int(sys.argv[1]))]
            errors_m = [one.touchdown.horizontal_error_m for one, _ in flights if one.touchdown is not None]
            times_s = [time_s for _, time_s in flights if time_s is not None]
            row = {
                "land": land.__name__,
                "speed_m_s": speed_m_s,
                "tiers": [one.tier.value for one, _ in flights],
                "reasons": sorted({one.reason for one, _ in flights}),
                "error_m": [round(find(errors_m), 3) for find in (statistics.median, max) if errors_m],
                "to_contact_s": [round(find(times_s), 1) for find in (statistics.median, max) if times_s],
            }
            sys.stdout.write(json.dumps(row) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
