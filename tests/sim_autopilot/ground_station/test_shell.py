"""PX4's shell, as MAVSDK and MAVProxy type into it."""

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import Pilot, arm

SHELL = mavlink.SERIAL_CONTROL_DEV_SHELL


def typed(text: str, device: int = SHELL) -> Message:
    data = text.encode()
    return mavlink.MAVLink_serial_control_message(device, 6, 0, 0, len(data), list(data.ljust(70, b"\0")))


def printed(pilot: Pilot, *texts: str) -> str:
    pilot.received.clear()
    for text in texts:
        pilot.step(typed(text))
    pieces = pilot.all("SERIAL_CONTROL")
    assert {(piece.device, piece.flags) for piece in pieces} <= {(SHELL, mavlink.SERIAL_CONTROL_FLAG_REPLY)}
    return b"".join(bytes(piece.data[: piece.count]) for piece in pieces).decode()


def test_a_line_may_come_in_pieces_and_an_empty_one_brings_the_prompt() -> None:
    pilot = Pilot()
    assert printed(pilot, "\n") == "\npxh> "
    assert printed(pilot, "commander st", "atus\n").splitlines()[1:3] == [
        "INFO  [commander] Disarmed",
        "INFO  [commander] navigation mode: Hold",
    ]
    pilot.step(arm())
    assert "[commander] Armed" in printed(pilot, "commander status\n")


def test_parameters_are_shown_and_set_within_their_ranges() -> None:
    pilot = Pilot()
    assert "MPC_XY_CRUISE" in printed(pilot, "param show MPC_XY_C*\n")
    assert "curr: 5.0000 -> new: 7.0000" in printed(pilot, "param set MPC_XY_CRUISE 7\n")
    assert pilot.node.memory.tuning.settings.travel.cruise_m_s == 7.0
    for wrong in ("nan", "fast", "1e9"):
        assert "no value for MPC_XY_CRUISE" in printed(pilot, f"param set MPC_XY_CRUISE {wrong}\n")
    assert "not found" in printed(pilot, "param set NOPE 7\n")
    assert ": 7.0000" in printed(pilot, "param show MPC_XY_CRUISE\n")


def test_another_device_and_arducopter_are_silent() -> None:
    for pilot, message in ((Pilot(), typed("ver all\n", 0)), (Pilot(ardupilot()), typed("ver all\n"))):
        pilot.step(message)
        assert not pilot.all("SERIAL_CONTROL")
