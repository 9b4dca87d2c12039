"""Who commands a step: the pilot's switch before all others, and what the pilot hears of a refusal."""

from dataclasses import dataclass

import pytest

from companion.config.autopilot import AutopilotConfig, PilotSwitchConfig
from companion.config.companion import CompanionConfig
from companion.situation.phases import Phase
from link.mavlink.dialect import Message, mavlink
from link.messages import Command, CommandReply
from tests.companion.autopilots.test_pilot_switch import CHANNEL, HIGH, LOW, MIDDLE, SETTLED_S, channels
from tests.companion.peer import FakePx4, Setup

RC_CHANNELS = mavlink.MAVLINK_MSG_ID_RC_CHANNELS


@dataclass
class SwitchedPx4(FakePx4):
    """One that has a receiver."""

    pulse_us: int = LOW

    def message(self, message_id: int, t_ns: int) -> Message:
        return channels(self.pulse_us) if message_id == RC_CHANNELS else super().message(message_id, t_ns)


class Piloted:
    """A companion that waits, and its pilot."""

    def __init__(self, *, arms: bool, armed: bool = False) -> None:
        switch = PilotSwitchConfig(channel=CHANNEL, arms=arms)
        config = CompanionConfig(autopilot=AutopilotConfig(pilot_switch=switch))
        self.autopilot = SwitchedPx4(armed=armed)
        self.setup = Setup(autopilot=self.autopilot, is_component=True, config=config)
        self.setup.run(3.0, self.setup.fixes)

    def switch(self, pulse_us: int) -> Phase:
        """Switch; return the phase that follows."""
        self.autopilot.pulse_us = pulse_us
        self.setup.run(SETTLED_S, self.setup.fixes)
        return self.setup.node.phase

    def texts(self) -> str:
        """All that the pilot was told."""
        return "".join(text.text for text in self.autopilot.of_type("STATUSTEXT"))


@pytest.mark.slow
def test_switch_starts_holds_and_starts_again() -> None:
    pilot = Piloted(arms=True)
    assert pilot.setup.node.phase is Phase.IDLE
    assert pilot.switch(HIGH) is Phase.TAKEOFF
    pilot.setup.run(2.0, pilot.setup.fixes)
    assert pilot.autopilot.armed
    pilot.autopilot.landed_state = mavlink.MAV_LANDED_STATE_IN_AIR
    assert pilot.switch(MIDDLE) is Phase.HOLD
    assert pilot.switch(LOW) is Phase.HOLD
    assert pilot.switch(HIGH) is Phase.WAITING
    assert "refuses" not in pilot.texts()


@pytest.mark.slow
def test_switch_that_holds_a_drone_on_the_ground_stops_its_motors_and_starts_again() -> None:
    pilot = Piloted(arms=True)
    assert pilot.switch(HIGH) is Phase.TAKEOFF
    pilot.setup.run(2.0, pilot.setup.fixes)
    was_armed = pilot.autopilot.armed
    assert pilot.switch(MIDDLE) is Phase.HOLD
    pilot.setup.run(2.0, pilot.setup.fixes)
    assert (was_armed, pilot.autopilot.armed) == (True, False)
    assert pilot.setup.node.phase is Phase.IDLE
    pilot.switch(LOW)
    assert pilot.switch(HIGH) is Phase.TAKEOFF


def test_switch_starts_no_motors_unless_it_is_allowed_to() -> None:
    pilot = Piloted(arms=False)
    assert pilot.switch(HIGH) is Phase.IDLE
    assert "refuses: the motors are off" in pilot.texts()
    pilot.switch(LOW)
    pilot.autopilot.armed = True
    pilot.setup.run(1.5, pilot.setup.fixes)
    assert pilot.switch(HIGH) is Phase.TAKEOFF


def test_switch_that_ends_nothing_is_not_told_so() -> None:
    pilot = Piloted(arms=True)
    assert pilot.switch(MIDDLE) is Phase.IDLE
    assert pilot.switch(LOW) is Phase.IDLE
    assert "refuses" not in pilot.texts()


@pytest.mark.parametrize(("command", "is_refused"), [(Command.LAUNCH, True), (Command.ABORT, False)])
def test_pilot_who_ends_a_landing_has_nothing_begun_that_waits(command: Command, *, is_refused: bool) -> None:
    pilot = Piloted(arms=True)
    node = pilot.setup.node
    pilot.switch(HIGH)
    pilot.autopilot.pulse_us = LOW
    replies = list[CommandReply]()

    def insist() -> None:
        pilot.setup.fix()
        if node.phase is Phase.TAKEOFF:
            node.request(command)
        replies.extend(node.take_replies())

    pilot.setup.run(SETTLED_S, insist)
    assert node.phase in (Phase.IDLE, Phase.HOLD)
    assert any("the pilot's switch has just ended" in reply.reason for reply in replies) is is_refused


def test_vehicle_that_was_never_heard_is_not_started_for() -> None:
    switch = PilotSwitchConfig(channel=CHANNEL, arms=True)
    config = CompanionConfig(autopilot=AutopilotConfig(pilot_switch=switch))
    autopilot = SwitchedPx4()
    setup = Setup(autopilot=autopilot, is_component=True, config=config)
    setup.run(3.0)
    autopilot.pulse_us = HIGH
    setup.run(SETTLED_S)
    assert setup.node.phase is Phase.IDLE
    assert "refuses: nothing usable has come" in "".join(text.text for text in autopilot.of_type("STATUSTEXT"))
