"""DO_GRIPPER as PX4 answers it: in progress, and accepted when it is done; another order cancels the one under way.

It opens and closes for as long as its parameter says, and knows by that alone that it has. Source: PX4's payload
deliverer, https://docs.px4.io/main/en/peripherals/gripper.html, and what its simulation answers.
"""

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.requests import ACCEPTED, DENIED, Answer, Request, acknowledgement
from sim_autopilot.core.links import Later
from sim_autopilot.ground_station.memory import Gripper, station_of, with_station
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory

_REJECTED = int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
_IN_PROGRESS = int(mavlink.MAV_RESULT_IN_PROGRESS)
_CANCELLED = 6
"""MAV_RESULT_CANCELLED, which the dialect does not have."""
_UNKNOWN_PROGRESS = 255
_ACTIONS = frozenset({int(mavlink.GRIPPER_ACTION_RELEASE), int(mavlink.GRIPPER_ACTION_GRAB)})


def grip(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Open or close the gripper."""
    station, now_ns, action = station_of(memory), memory.now.boot_ns, request.number(2)
    gripper = station.gripper
    moves = gripper.moves(now_ns)
    if action == gripper.action:
        return Answer(memory=memory, result=_REJECTED if moves else ACCEPTED)
    under_way = tuple(later for later in memory.outbox.later if _is_about_gripper(later)) if moves else ()
    told = tuple(_cancel(later.message) for later in under_way)
    if action is None or action not in _ACTIONS:
        return Answer(memory=memory, result=None, messages=(*told, acknowledgement(request, DENIED)))
    done_ns = now_ns + round(memory.tuning.values["PD_GRIPPER_TO"] * 1e9)
    done = Later(boot_ns=done_ns, message=acknowledgement(request, ACCEPTED))
    memory = with_station(memory, replace(station, gripper=Gripper(action=action, done_ns=done_ns)))
    later = (*(later for later in memory.outbox.later if later not in under_way), done)
    begun = acknowledgement(request, _IN_PROGRESS, _UNKNOWN_PROGRESS)
    return Answer(
        memory=replace(memory, outbox=replace(memory.outbox, later=later)), result=None, messages=(*told, begun)
    )


def _is_about_gripper(later: Later) -> bool:
    is_answer = later.message.get_msgId() == mavlink.MAVLINK_MSG_ID_COMMAND_ACK
    return is_answer and bool(later.message.command == mavlink.MAV_CMD_DO_GRIPPER)


def _cancel(answer: Message) -> Message:
    """Tell whoever waits for `answer` that nothing comes of it."""
    return mavlink.MAVLink_command_ack_message(
        answer.command,
        _CANCELLED,
        0,
        0,
        target_system=answer.target_system,
        target_component=answer.target_component,
    )
