"""What heartbeats tell: a single one that says "disarmed" is doubted."""

import pytest

from companion.autopilots.driver import NO_AUTOPILOT, AutopilotView
from companion.autopilots.heartbeat import with_acknowledgement, with_heartbeat
from companion.autopilots.px4 import Px4Driver
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import CommandAcknowledged

DISARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED


def beat(*, armed: bool) -> Message:
    mode = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | (mavlink.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0)
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, mode, 0, mavlink.MAV_STATE_ACTIVE, 3
    )


def answer(result: int) -> CommandAcknowledged:
    return CommandAcknowledged(t_ns=0, command=DISARM, result=result, ticket=1, is_repeat=False)


def after(*told: bool, view: AutopilotView = NO_AUTOPILOT) -> AutopilotView:
    for armed in told:
        view = with_heartbeat(view, beat(armed=armed), Px4Driver())
    return view


@pytest.mark.parametrize(
    ("told", "armed"),
    [
        ((False,), False),
        ((True,), True),
        ((True, False), True),
        ((True, False, False), False),
        ((True, False, True, False), True),
        ((True, False, False, True), True),
    ],
)
def test_disarming_counts_once_it_is_told_again_and_arming_at_once(told: tuple[bool, ...], *, armed: bool) -> None:
    assert after(*told).armed is armed


@pytest.mark.parametrize(("result", "armed"), [(ACCEPTED, False), (DENIED, True)])
def test_disarming_that_was_accepted_counts_with_the_next_heartbeat(result: int, *, armed: bool) -> None:
    answered = with_acknowledgement(after(True), answer(result))
    assert answered.armed
    assert after(False, view=answered).armed is armed


def test_arming_that_was_accepted_leaves_nothing_behind() -> None:
    armed = after(True, view=with_acknowledgement(after(False), answer(ACCEPTED)))
    assert after(False, view=armed).armed
