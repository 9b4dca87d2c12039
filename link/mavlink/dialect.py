"""The one home of pymavlink's message classes: MAVLink 2, every public dialect in one."""

from typing import TypeAlias

from pymavlink.dialects.v20 import all as mavlink

Message: TypeAlias = mavlink.MAVLink_message

__all__ = ["Message", "mavlink"]
