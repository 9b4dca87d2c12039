"""What a start needs before a step judges it: an autopilot that knows where it is, a vehicle that was heard."""

from companion.autopilots.state import AutopilotState
from companion.core.reasons import Cause, Reason, sentence
from companion.runtime.vehicle_link import VehicleLink
from link.messages import CommandReply


def is_ready_to_start(state: AutopilotState) -> bool:
    """Return whether the autopilot's link is up and it tells all that places the drone."""
    placed = state.view.frame is not None and state.view.receiver.knows_geoid
    return state.view.link_up and placed and state.own is not None


def refuse_unheard(vehicle: VehicleLink) -> CommandReply:
    """Return the answer to a start for a vehicle that was never heard, with what was refused of it."""
    refused = vehicle.refused_lately()
    why = Cause(Reason.VEHICLE_UNHEARD, (f" ({refused})" if refused else "",))
    return CommandReply(accepted=False, reason=sentence(why))
