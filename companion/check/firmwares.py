"""The firmwares that can be flown, as the check knows them."""

from collections.abc import Sequence
from dataclasses import dataclass

from companion.check.ardupilot_rules import ARDUPILOT_LAUNCH_RULES, ARDUPILOT_RULES, ARDUPILOT_SINK
from companion.check.px4_rules import PX4_LAUNCH_RULES, PX4_RULES, PX4_SINK
from companion.check.rules import ParameterRule, Spelling, names_of, sink_rule
from companion.config.autopilot import AutopilotKind
from link.mavlink.dialect import mavlink


@dataclass(frozen=True, slots=True, kw_only=True)
class Firmware:
    """A firmware that can be flown.

    Attributes:
        name: for messages.
        kind: what a configuration calls it.
        oldest: release that is known to work.
        rules: of its parameters, but for the one that limits the descent.
        launch: rules for a launch from the deck of a vehicle that drives; of the same parameter they ask for more.
        sink: names of the descent's.
    """

    name: str
    kind: AutopilotKind
    oldest: tuple[int, int]
    rules: Sequence[ParameterRule]
    launch: Sequence[ParameterRule]
    sink: tuple[Spelling, ...]

    def rules_for(self, sink_m_s: float, *, launches: bool = False) -> tuple[ParameterRule, ...]:
        """Return all rules, for a companion that sinks by `sink_m_s` at most and may launch.

        One for a launch comes after that for a landing: the value that it advises is the one that is written.
        """
        return (*self.rules, sink_rule(self.sink, sink_m_s), *(self.launch if launches else ()))

    @property
    def parameters(self) -> tuple[str, ...]:
        """Every name that the rules look for."""
        return tuple(
            dict.fromkeys((*names_of((*self.rules, *self.launch)), *(spelling.name for spelling in self.sink)))
        )


FIRMWARES = {
    mavlink.MAV_AUTOPILOT_PX4: Firmware(
        name="PX4", kind=AutopilotKind.PX4, oldest=(1, 14), rules=PX4_RULES, launch=PX4_LAUNCH_RULES, sink=PX4_SINK
    ),
    mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA: Firmware(
        name="ArduPilot",
        kind=AutopilotKind.ARDUPILOT,
        oldest=(4, 5),
        rules=ARDUPILOT_RULES,
        launch=ARDUPILOT_LAUNCH_RULES,
        sink=ARDUPILOT_SINK,
    ),
}
"""By MAV_AUTOPILOT."""
