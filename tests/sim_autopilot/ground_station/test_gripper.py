"""PX4's gripper."""

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.pilot import Pilot, command

ACCEPTED, REJECTED, DENIED, IN_PROGRESS, CANCELLED = 0, 1, 2, 5, 6


def grip(action: float) -> Message:
    return command(mavlink.MAV_CMD_DO_GRIPPER, 1.0, action)


def test_the_gripper_is_in_progress_until_its_time_is_over() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(grip(1.0)) == [ACCEPTED]  # it is closed from the start
    assert pilot.acknowledged(grip(0.0)) == [IN_PROGRESS]
    assert pilot.acknowledged(grip(0.0)) == [REJECTED]
    pilot.received.clear()
    pilot.run(1.0)  # PD_GRIPPER_TO
    assert [answer.result for answer in pilot.all("COMMAND_ACK")] == [ACCEPTED]
    assert pilot.acknowledged(grip(0.0)) == [ACCEPTED]


def test_another_order_cancels_what_the_gripper_is_at() -> None:
    pilot = Pilot()
    pilot.step(grip(0.0))
    assert pilot.acknowledged(grip(1.0)) == [CANCELLED, IN_PROGRESS]
    assert pilot.acknowledged(grip(2.0)) == [CANCELLED, DENIED]
    pilot.received.clear()
    pilot.run(1.5)
    assert [answer.result for answer in pilot.all("COMMAND_ACK")] == [ACCEPTED]
