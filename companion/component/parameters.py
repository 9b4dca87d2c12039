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

_FRAMES = (ReceiverFrames.AUTO, ReceiverFrames.ONE, ReceiverFrames.APART)
_SINGLE_DIGITS = 7  # that a single-precision number keeps


class _Parameter(NamedTuple):
    """Where in the configuration a parameter is, as `takeoff.waiting_height_m`."""

    name: str
    key: str
    is_whole: bool = False


PARAMETERS = (
    _Parameter("DL_WAIT_ALT", "takeoff.waiting_height_m"),
    _Parameter("DL_CHASE_ALT", "chase.height_m"),
    _Parameter("DL_CHASE_TIME", "chase.time_limit_s"),
    _Parameter("DL_PAD_WAIT", "descent.wait.height_m"),
    _Parameter("DL_RETRIES", "abort.retries_max", is_whole=True),
    _Parameter("DL_SPEED_MAX", "limits.speed_max_m_s"),
    _Parameter("DL_SINK_MAX", "limits.descent_max_m_s"),
    _Parameter("DL_RANGE_MAX", "limits.range_max_m"),
    _Parameter("DL_BATT_MIN", "limits.battery_min_share"),
    _Parameter("DL_FRAMES", "integrity.receiver_frames", is_whole=True),
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
        one.name.encode("ascii"), _value(config, one), mavlink.MAV_PARAM_TYPE_REAL32, len(PARAMETERS), place
    )


def _value(config: CompanionConfig, one: _Parameter) -> float:
    value = attrgetter(one.key)(config)
    return float(_FRAMES.index(value) if isinstance(value, ReceiverFrames) else value)


def _with_value(config: CompanionConfig, one: _Parameter, value: float) -> CompanionConfig:
    """Return the configuration with a value, unchanged where the configuration does not take it."""
    given = float(f"{value:.{_SINGLE_DIGITS}g}")  # as it was written before it became single precision
    if one.is_whole and not given.is_integer():
        return config
    is_choice = isinstance(attrgetter(one.key)(config), ReceiverFrames)
    if is_choice and given not in range(len(_FRAMES)):
        return config
    whole = int(given) if one.is_whole else given
    *sections, key = one.key.split(".")
    table = config.model_dump()
    inner = table
    for section in sections:
        inner = inner[section]
    inner[key] = _FRAMES[int(given)] if is_choice else whole
    try:
        return CompanionConfig.model_validate(table)
    except ValidationError:
        return config
