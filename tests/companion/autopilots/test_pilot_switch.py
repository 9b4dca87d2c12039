"""The switch on the transmitter: a change commands, once it has lasted, and silence never does."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.pilot_switch import PilotSwitch
from companion.config.autopilot import PilotSwitchConfig
from link.mavlink.dialect import Message, mavlink
from link.messages import Command

CHANNEL = 7
LOW, MIDDLE, HIGH, UNUSED = 1000, 1500, 2000, 65535
COMMANDS = {LOW: Command.ABORT, MIDDLE: Command.HOLD, HIGH: Command.START}
SETTLED_S, SHORT_S, SILENT_S = 0.4, 0.1, 3.0
PERIOD_NS = 100_000_000


def channels(pulse_us: int) -> Message:
    """What a receiver with eight channels gives, the seventh at `pulse_us`."""
    others = [UNUSED] * 10
    return mavlink.MAVLink_rc_channels_message(0, 8, *[1500] * 6, pulse_us, 1100, *others, 255)


class Transmitter:
    """A switch that is held, and what it has commanded."""

    def __init__(self, config: PilotSwitchConfig | None = None) -> None:
        self.switch = PilotSwitch(config or PilotSwitchConfig(channel=CHANNEL))
        self.t_ns = 0

    def hold(self, pulse_us: int, duration_s: float) -> list[Command]:
        """Hold the switch at a pulse; return what that commands."""
        found = []
        for _ in range(round(duration_s * 1e9 / PERIOD_NS) + 1):
            self.switch.hear(channels(pulse_us), self.t_ns)
            found.append(self.switch.take())
            self.t_ns += PERIOD_NS
        return [command for command in found if command is not None]

    def wait(self, duration_s: float) -> None:
        """Hear nothing."""
        self.t_ns += round(duration_s * 1e9)


@pytest.mark.parametrize("first", COMMANDS)
@pytest.mark.parametrize("then", COMMANDS)
def test_each_change_commands_once_and_the_first_position_nothing(first: int, then: int) -> None:
    transmitter = Transmitter()
    assert transmitter.hold(first, SETTLED_S) == []
    assert transmitter.hold(then, 10.0 * SETTLED_S) == ([COMMANDS[then]] if then != first else [])


@given(turns=st.lists(st.sampled_from((1, 2)), max_size=40))
def test_positions_that_last_for_one_message_command_nothing(turns: list[int]) -> None:
    transmitter, pulses, place = Transmitter(), sorted(COMMANDS), 0
    transmitter.hold(pulses[place], SETTLED_S)
    for turn in turns:
        place = (place + turn) % len(pulses)
        assert transmitter.hold(pulses[place], 0.0) == []


def test_switch_that_passes_the_middle_on_its_way_does_not_hold() -> None:
    transmitter = Transmitter()
    transmitter.hold(HIGH, SETTLED_S)
    assert transmitter.hold(MIDDLE, SHORT_S) + transmitter.hold(LOW, SETTLED_S) == [Command.ABORT]


def test_thresholds_are_those_of_the_configuration() -> None:
    config = PilotSwitchConfig(channel=CHANNEL, start_above_us=1600, abort_below_us=1400)
    transmitter = Transmitter(config)
    transmitter.hold(1400, SETTLED_S)
    assert [transmitter.hold(pulse, SETTLED_S) for pulse in (1600, 1601, 1400, 1399)] == [
        [],
        [Command.START],
        [Command.HOLD],
        [Command.ABORT],
    ]


@pytest.mark.parametrize("lost", [0, UNUSED, 700])
@pytest.mark.parametrize("held", COMMANDS)
def test_receiver_that_tells_no_pulse_commands_nothing_nor_does_its_return(held: int, lost: int) -> None:
    transmitter = Transmitter()
    transmitter.hold(held, SETTLED_S)
    assert transmitter.hold(lost, SILENT_S) + transmitter.hold(held, SETTLED_S) == []


@pytest.mark.parametrize("held", COMMANDS)
def test_silence_commands_nothing_nor_does_its_end(held: int) -> None:
    transmitter = Transmitter()
    transmitter.hold(held, SETTLED_S)
    transmitter.wait(SILENT_S)
    assert transmitter.hold(held, SETTLED_S) == []


@pytest.mark.parametrize("pulse_us", COMMANDS)
def test_what_was_switched_during_a_silence_may_end_a_landing_and_starts_none(pulse_us: int) -> None:
    transmitter = Transmitter()
    transmitter.hold(LOW if pulse_us == HIGH else HIGH, SETTLED_S)
    transmitter.wait(SILENT_S)
    expected = [] if pulse_us == HIGH else [COMMANDS[pulse_us]]
    assert transmitter.hold(pulse_us, SETTLED_S) == expected
    assert transmitter.hold(MIDDLE if pulse_us != MIDDLE else LOW, SETTLED_S) != []


def test_messages_that_come_in_one_burst_settle_nothing() -> None:
    transmitter = Transmitter()
    transmitter.hold(LOW, SETTLED_S)
    for _ in range(20):
        transmitter.switch.hear(channels(HIGH), transmitter.t_ns)
    assert transmitter.switch.take() is None


def test_restart_of_the_autopilot_makes_the_next_position_the_first() -> None:
    transmitter = Transmitter()
    transmitter.hold(LOW, SETTLED_S)
    transmitter.switch.forget()
    assert transmitter.hold(HIGH, SETTLED_S) == []


def test_without_a_channel_nothing_is_asked_for_and_nothing_commanded() -> None:
    transmitter = Transmitter(PilotSwitchConfig())
    assert transmitter.switch.streams_hz == {}
    assert transmitter.hold(LOW, SETTLED_S) + transmitter.hold(HIGH, SETTLED_S) == []


def test_thresholds_without_a_middle_are_refused() -> None:
    with pytest.raises(ValueError, match="abort_below_us must be below start_above_us, 1500"):
        PilotSwitchConfig(start_above_us=1500, abort_below_us=1500)
