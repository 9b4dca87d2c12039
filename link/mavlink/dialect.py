"""The one home of pymavlink's message classes: MAVLink 2, every public dialect in one, and PX4's drafts."""

from typing import TypeAlias

from pymavlink.dialects.v20 import all as mavlink

from link.mavlink.draft_messages import DRAFT_MESSAGES

Message: TypeAlias = mavlink.MAVLink_message

mavlink.mavlink_map.update(DRAFT_MESSAGES)

COMMAND_CANCEL_ID, COMPONENT_INFORMATION_BASIC_ID = 80, 396
"""Of drafts, which the dialect has no names for."""
MAV_RESULT_CANCELLED = 6
"""Likewise."""

__all__ = ["COMMAND_CANCEL_ID", "COMPONENT_INFORMATION_BASIC_ID", "MAV_RESULT_CANCELLED", "Message", "mavlink"]
