"""A few of the configuration's numbers as MAVLink parameters: a ground station lists, reads and sets them.

All are of type REAL32, which every ground station encodes alike: the bytes of an integer differ between PX4's custom
and ArduPilot's. What is set holds until the companion ends; the file stays as it is.
Source: MAVLink parameter protocol, https://mavlink.io/en/services/parameter.html.
"""

from collections.abc import Iterator
from operator import attrgetter
from typing import NamedTuple

from pydantic import ValidationError

from companion.config.companion import CompanionConfig
from companion.config.integrity import ReceiverFrames
from link.mavlink.dialect import Message, mavlink

CHOICES = (ReceiverFrames.AUTO, ReceiverFrames.ONE, ReceiverFrames.APART)
"""Of DL_FRAMES, in the order of its values."""

_SINGLE_DIGITS = 7  # that a single-precision number keeps


class Parameter(NamedTuple):
    """Where in the configuration a parameter is, as `takeoff.waiting_height_m`, and what it means."""

    name: str
    key: str
    description: str
    is_whole: bool = False
    is_choice: bool = False


PARAMETERS = (
    Parameter("DL_WAIT_ALT", "takeoff.waiting_height_m", "Waiting height above the place of take-off"),
    Parameter("DL_CHASE_ALT", "chase.height_m", "Height above the pad in the chase"),
    Parameter("DL_CHASE_TIME", "chase.time_limit_s", "Longest chase"),
    Parameter("DL_PAD_WAIT", "descent.wait.height_m", "Height above the pad at which a descent waits"),
    Parameter("DL_RETRIES", "abort.retries_max", "New approaches after an abort", is_whole=True),
    Parameter("DL_SPEED_MAX", "limits.speed_max_m_s", "Largest horizontal speed"),
    Parameter("DL_SINK_MAX", "limits.descent_max_m_s", "Largest sink rate"),
    Parameter("DL_RANGE_MAX", "limits.range_max_m", "Farthest from the waiting point"),
    Parameter("DL_BATT_MIN", "limits.battery_min_share", "Battery below which no landing begins"),
    Parameter(
        "DL_FRAMES",
        "integrity.receiver_frames",
        "Whether both receivers have one frame",
        is_whole=True,
        is_choice=True,
    ),
)
"""What can be set between flights, in SI units and shares; DL_FRAMES is 0 auto, 1 one, 2 apart."""

_PLACES = {one.name: place for place, one in enumerate(PARAMETERS)}


def answers(
    message: Message, config: CompanionConfig, *, may_change: bool
) -> tuple[CompanionConfig, Iterator[Message]]:
    """Return the configuration after a PARAM_REQUEST_LIST, PARAM_REQUEST_READ or PARAM_SET, and the PARAM_VALUEs.

    A value that cannot be set is answered with the one that holds, as the protocol has it.

    Args:
        message: for this component, or a question to all.
        config: as it is.
        may_change: nothing is flown.
    """
    kind = message.get_msgId()
    if kind == mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST:
        return config, (_told(place, config) for place in range(len(PARAMETERS)))
    place = _place(message)
    if place is None:
        return config, iter(())
    if kind == mavlink.MAVLINK_MSG_ID_PARAM_SET and may_change:
        config = _with_value(config, PARAMETERS[place], float(message.param_value))
    return config, iter((_told(place, config),))


def _place(message: Message) -> int | None:
    """Return which parameter a message means, None for one that is not ours."""
    index = getattr(message, "param_index", -1)
    if 0 <= index < len(PARAMETERS):
        # By its index a question to all components is the autopilot's: no two of them count alike.
        return int(index) if message.target_component else None
    return _PLACES.get(message.param_id)


def _told(place: int, config: CompanionConfig) -> Message:
    one = PARAMETERS[place]
    return mavlink.MAVLink_param_value_message(
        one.name.encode("ascii"), value_of(config, one), mavlink.MAV_PARAM_TYPE_REAL32, len(PARAMETERS), place
    )


def value_of(config: CompanionConfig, one: Parameter) -> float:
    """Return the value of a parameter."""
    value = attrgetter(one.key)(config)
    return float(CHOICES.index(value) if isinstance(value, ReceiverFrames) else value)


def _with_value(config: CompanionConfig, one: Parameter, value: float) -> CompanionConfig:
    """Return the configuration with a value, unchanged where the configuration does not take it."""
    given = float(f"{value:.{_SINGLE_DIGITS}g}")  # as it was written before it became single precision
    if one.is_whole and not given.is_integer():
        return config
    if one.is_choice and given not in range(len(CHOICES)):
        return config
    whole = int(given) if one.is_whole else given
    *sections, key = one.key.split(".")
    table = config.model_dump()
    inner = table
    for section in sections:
        inner = inner[section]
    inner[key] = CHOICES[int(given)] if one.is_choice else whole
    try:
        return CompanionConfig.model_validate(table)
    except ValidationError:
        return config
