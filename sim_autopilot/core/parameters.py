"""The autopilot's parameters: a fixed list with ranges, values that can be set, and their way over MAVLink."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass

from link.mavlink.dialect import Message, mavlink
from link.mavlink.parameters import NAME_LENGTH_MAX, parameter_on_wire, parameter_value

Values = Mapping[str, float]

_NO_INDEX = 65535
INTEGER_MAX = {
    mavlink.MAV_PARAM_TYPE_INT8: 2**7 - 1,
    mavlink.MAV_PARAM_TYPE_INT16: 2**15 - 1,
    mavlink.MAV_PARAM_TYPE_INT32: 2**31 - 1,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A parameter of the firmware, in the firmware's own unit; an `int` default makes it an integer.

    `integer_type` is its MAV_PARAM_TYPE then.
    """

    name: str
    default: float | int
    lowest: float
    highest: float
    integer_type: int = mavlink.MAV_PARAM_TYPE_INT32

    @property
    def is_integer(self) -> bool:
        """Whether it is a whole number."""
        return isinstance(self.default, int)

    @property
    def mavlink_type(self) -> int:
        """Its MAV_PARAM_TYPE."""
        return int(self.integer_type if self.is_integer else mavlink.MAV_PARAM_TYPE_REAL32)


def make_parameter(name: str, default: float, lowest: float, highest: float) -> Parameter:
    """Return one by the columns of a reference; whole where `default` is."""
    return Parameter(name=name, default=default, lowest=lowest, highest=highest)


def default_values(parameters: tuple[Parameter, ...], overrides: Values) -> Values:
    """Return every parameter's value: its default, or what `overrides` says.

    Raises:
        ValueError: an override names no parameter or is out of its range.
    """
    values = {p.name: float(p.default) for p in parameters}
    by_name = {p.name: p for p in parameters}
    for name, value in overrides.items():
        if name not in by_name:
            near = difflib.get_close_matches(name, values, 5) or ["no name like it"]
            raise ValueError(f"no parameter {name}; there is {', '.join(near)}")
        parameter = by_name[name]
        if not is_allowed(parameter, value):
            raise ValueError(f"{name} = {value} is not between {parameter.lowest} and {parameter.highest}")
        values[name] = float(value)
    return values


def within_ranges(parameters: tuple[Parameter, ...], values: Values) -> Values:
    """Return `values`, those of `parameters` brought into their ranges; a choice that there is not is the default."""
    out = (p for p in parameters if not p.lowest <= values[p.name] <= p.highest)
    kept = {p.name: float(p.default) if p.is_integer else min(max(values[p.name], p.lowest), p.highest) for p in out}
    return {**values, **kept} if kept else values


def parameter_message(
    parameters: tuple[Parameter, ...], index: int, values: Values, autopilot_id: int, *, tells_index: bool = True
) -> Message:
    """Return the PARAM_VALUE of the parameter at `index`, encoded as the MAV_AUTOPILOT `autopilot_id` does it.

    Without `tells_index` it stands alone, outside of any list.
    """
    parameter = parameters[index]
    kind = parameter.mavlink_type
    wire = parameter_on_wire(values[parameter.name], kind, autopilot_id)
    told = index if tells_index else _NO_INDEX
    return mavlink.MAVLink_param_value_message(parameter.name.encode(), wire, kind, len(parameters), told)


def find_index(parameters: tuple[Parameter, ...], name: str, index: int = -1) -> int | None:
    """Return where a parameter is, by `index` or, where that is -1, by `name`; None for one that does not exist."""
    if index >= 0:
        return index if index < len(parameters) else None
    wanted = name[:NAME_LENGTH_MAX]
    return next((i for i, parameter in enumerate(parameters) if parameter.name == wanted), None)


def values_after_set(
    parameters: tuple[Parameter, ...],
    index: int,
    values: Values,
    message: Message,
    autopilot_id: int,
    *,
    lenient: bool = False,
) -> Values:
    """Return the values after a PARAM_SET; one that is not finite changes nothing, and ranges are not enforced.

    A `lenient` autopilot takes any finite number, whatever type was named, rounds it for an integer, and knows no
    ranges but the integer's own, to which it clips.
    """
    parameter = parameters[index]
    if lenient:
        return _values_after_lenient_set(parameter, values, float(message.param_value))
    value = parameter_value(message, autopilot_id)
    if value is None or not math.isfinite(value) or (parameter.is_integer and not float(value).is_integer()):
        return values
    return {**values, parameter.name: float(value)}


def is_type_right(parameter: Parameter, message: Message) -> bool:
    """Return whether a PARAM_SET names the parameter's own type."""
    return bool(message.param_type == parameter.mavlink_type)


def _values_after_lenient_set(parameter: Parameter, values: Values, value: float) -> Values:
    if not math.isfinite(value):
        return values
    if parameter.is_integer:
        most = INTEGER_MAX[parameter.mavlink_type]
        value = float(max(-most - 1, min(most, round(value))))
    return {**values, parameter.name: value}


def is_allowed(parameter: Parameter, value: float) -> bool:
    """Return whether a value is of the parameter's kind and within its range."""
    fits = not parameter.is_integer or float(value).is_integer()
    return math.isfinite(value) and fits and parameter.lowest <= value <= parameter.highest
