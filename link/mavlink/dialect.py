"""The one home of pymavlink's message classes: MAVLink 2, every public dialect in one, and PX4's drafts."""

from typing import TypeAlias

from pymavlink.dialects.v20 import all as mavlink

from link.mavlink.draft_messages import DRAFT_MESSAGES

Message: TypeAlias = mavlink.MAVLink_message

mavlink.mavlink_map.update(DRAFT_MESSAGES)

__all__ = ["Message", "mavlink"]
