"""@PARAM/param.pck: ArduPilot's whole parameter list as one packed file.

A head (magic, number here, number in all), then of each parameter its type and flags, how much of its name it shares
with the one before, the rest of the name, the value and, where asked for and other than it, the default.

Source: ArduPilot's MAVLink FTP documentation of the parameter file.
"""

import struct
from collections.abc import Sequence

from link.mavlink.dialect import mavlink
from sim_autopilot.core.parameters import Parameter, Values

PATH = "@PARAM/param.pck"
_HEAD = struct.Struct("<HHH")
_MAGIC, _MAGIC_WITH_DEFAULTS = 0x671B, 0x671C
_FORMATS = {
    int(mavlink.MAV_PARAM_TYPE_INT8): (1, struct.Struct("<b")),
    int(mavlink.MAV_PARAM_TYPE_INT16): (2, struct.Struct("<h")),
    int(mavlink.MAV_PARAM_TYPE_INT32): (3, struct.Struct("<i")),
    int(mavlink.MAV_PARAM_TYPE_REAL32): (4, struct.Struct("<f")),
}
_SHARED_MAX = 15


def pack_parameters(parameters: Sequence[Parameter], values: Values, *, with_defaults: bool = False) -> bytes:
    """Return the parameter file.

    Args:
        parameters: in the order in which they are listed.
        values: of them, by name.
        with_defaults: whether each value that is not its default is followed by that.
    """
    magic = _MAGIC_WITH_DEFAULTS if with_defaults else _MAGIC
    data, before = bytearray(_HEAD.pack(magic, len(parameters), len(parameters))), ""
    for parameter in parameters:
        data += _entry(parameter, values[parameter.name], before, with_defaults=with_defaults)
        before = parameter.name
    return bytes(data)


def _entry(parameter: Parameter, value: float, before: str, *, with_defaults: bool) -> bytes:
    kind, form = _FORMATS[parameter.mavlink_type]
    name = parameter.name
    shared = next(
        (i for i, (a, b) in enumerate(zip(name, before, strict=False)) if a != b), min(len(name), len(before))
    )
    shared = min(shared, len(name) - 1, _SHARED_MAX)
    rest = name[shared:].encode()
    differs = with_defaults and value != parameter.default
    numbers = (value, float(parameter.default)) if differs else (value,)
    packed_numbers = b"".join(form.pack(round(one) if parameter.is_integer else one) for one in numbers)
    return bytes([kind | differs << 4, shared | (len(rest) - 1) << 4]) + rest + packed_numbers
