"""Parameters in their one float on the wire, by either of the two customs.

PX4 puts an integer's bytes into the float ("bytewise"), ArduPilot its value ("C cast").
Source: MAVLink parameter protocol, https://mavlink.io/en/services/parameter.html#parameter-encoding.
"""

import math
import struct

from link.mavlink.dialect import Message, mavlink

NAME_LENGTH_MAX = 16
_BY_NAME = -1  # param_index of a PARAM_REQUEST_READ that goes by name

_BYTEWISE_FORMATS = {
    mavlink.MAV_PARAM_TYPE_UINT8: "<Bxxx",
    mavlink.MAV_PARAM_TYPE_INT8: "<bxxx",
    mavlink.MAV_PARAM_TYPE_UINT16: "<Hxx",
    mavlink.MAV_PARAM_TYPE_INT16: "<hxx",
    mavlink.MAV_PARAM_TYPE_UINT32: "<I",
    mavlink.MAV_PARAM_TYPE_INT32: "<i",
}


def parameter_value(message: Message, autopilot: int) -> int | float | None:
    """Reads the value out of a PARAM_VALUE.

    Args:
        message: as received, since the bytes of an integer need not survive as a float.
        autopilot: MAV_AUTOPILOT of its sender.

    Returns:
        The value, an int for the integer types; None when what came is not a number.
    """
    form = _BYTEWISE_FORMATS.get(message.param_type)
    if form is not None and autopilot == mavlink.MAV_AUTOPILOT_PX4:
        return int(struct.unpack(form, _value_bytes(message))[0])
    value = float(message.param_value)
    if not math.isfinite(value):
        return None
    return value if form is None else round(value)


def parameter_on_wire(value: float, parameter_type: int, autopilot: int) -> float:
    """Gives the float that carries a value in PARAM_VALUE and PARAM_SET.

    Args:
        value: of the parameter.
        parameter_type: MAV_PARAM_TYPE.
        autopilot: MAV_AUTOPILOT of the side that owns the parameter.

    Returns:
        The field `param_value`.

    Raises:
        ValueError: The value does not fit the type.
    """
    form = _BYTEWISE_FORMATS.get(parameter_type)
    if form is None or autopilot != mavlink.MAV_AUTOPILOT_PX4:
        return float(value)
    try:
        return float(struct.unpack("<f", struct.pack(form, int(value)))[0])
    except struct.error as error:
        raise ValueError(f"{value} does not fit parameter type {parameter_type}: {error}") from error


def parameter_question(target_system: int, name: str) -> Message:
    """Returns the PARAM_REQUEST_READ to an autopilot."""
    return mavlink.MAVLink_param_request_read_message(
        target_system, mavlink.MAV_COMP_ID_AUTOPILOT1, name.encode("ascii"), _BY_NAME
    )


def parameter_set_message(name: str, value: float, parameter_type: int, autopilot: int, target_system: int) -> Message:
    """Gives the PARAM_SET that writes a parameter.

    Args:
        name: of the parameter.
        value: for it.
        parameter_type: MAV_PARAM_TYPE that the autopilot gave it.
        autopilot: MAV_AUTOPILOT of the autopilot.
        target_system: its system id.

    Returns:
        The message.

    Raises:
        ValueError: The value does not fit the type.
    """
    wire = parameter_on_wire(value, parameter_type, autopilot)
    return mavlink.MAVLink_param_set_message(
        target_system, mavlink.MAV_COMP_ID_AUTOPILOT1, name.encode("ascii"), wire, parameter_type
    )


def _value_bytes(message: Message) -> bytes:
    """The four bytes of `param_value`, the payload's first field."""
    frame = bytes(message.get_msgbuf())
    header = mavlink.HEADER_LEN_V1 if frame[0] == mavlink.PROTOCOL_MARKER_V1 else mavlink.HEADER_LEN_V2
    return frame[header : header + 4]
