"""What a single forged datagram changes in what the companion knows: all that only signing cures, and nothing more."""

import pytest

from link.messages import Command
from scenarios.attack.spoofs import SPOOFS, UNSIGNED, armed_flight, changed_by, heard_though_signed, switched_by
from scenarios.faults.flight import FaultFlight


@pytest.fixture(scope="module")
def flight() -> FaultFlight:
    """One whose drone has just been armed, by a companion that knows all of it."""
    return armed_flight()


def test_each_spoof_has_its_expected_effect() -> None:
    assert UNSIGNED.keys() == SPOOFS.keys()


@pytest.mark.parametrize("name", SPOOFS)
def test_unsigned_datagram_changes_what_it_says_and_nothing_else(name: str, flight: FaultFlight) -> None:
    assert changed_by(name, flight) == UNSIGNED[name]


@pytest.mark.parametrize("command", [Command.START, Command.HOLD, Command.ABORT])
def test_forged_switch_commands_where_no_transmitter_is_heard_and_nowhere_else(
    command: Command, flight: FaultFlight
) -> None:
    assert switched_by(command, flight, is_heard=False) is command
    assert switched_by(command, flight, is_heard=True) is None


@pytest.mark.parametrize("name", SPOOFS)
def test_datagram_without_a_signature_or_by_another_key_changes_nothing_where_frames_are_signed(
    name: str, flight: FaultFlight
) -> None:
    assert heard_though_signed(name, flight) == 0
