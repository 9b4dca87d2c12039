"""Numbers in messages that are none."""

import math
from collections.abc import Iterable

from link.mavlink.dialect import Message, mavlink

_NAN_IS_UNKNOWN = frozenset({"COMMAND_LONG", "COMMAND_INT"})  # there it stands for a parameter that is not given


def count_not_finite(messages: Iterable[Message]) -> int:
    """Count numbers that are none; in PX4's PARAM_VALUE the bits of an integer may look like one."""
    count = 0
    for message in messages:
        if message.get_type() == "PARAM_VALUE" and message.param_type != mavlink.MAV_PARAM_TYPE_REAL32:
            continue
        if message.get_type() in _NAN_IS_UNKNOWN:
            continue
        for value in message.to_dict().values():
            numbers = value if isinstance(value, list) else (value,)
            count += sum(isinstance(one, float) and not math.isfinite(one) for one in numbers)
    return count
