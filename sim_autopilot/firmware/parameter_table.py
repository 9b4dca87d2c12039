"""A firmware's whole parameter list: what the flight obeys, among all the rest that is kept and answered only.

Each firmware's folder has a table `parameters.csv` with name, MAV_PARAM_TYPE and default in the firmware's
own order, read from its simulation.
"""

from importlib.resources import files

from link.mavlink.dialect import mavlink
from sim_autopilot.core.parameters import INTEGER_MAX, Parameter

_REAL_MAX = 3.4e38


def whole_list(folder: str, obeyed: tuple[Parameter, ...]) -> tuple[Parameter, ...]:
    """Return every parameter of the firmware, in its order.

    Args:
        folder: of the firmware, beside this file.
        obeyed: the parameters that act, which take the place of their lines.

    Raises:
        ValueError: its table lacks one of these.
    """
    acting = {parameter.name: parameter for parameter in obeyed}
    lines = files(__package__).joinpath(folder, "parameters.csv").read_text(encoding="ascii").splitlines()
    stored = tuple(map(_parse_line, lines))
    lacking = acting.keys() - {parameter.name for parameter in stored}
    if lacking:
        raise ValueError(f"the table of {folder} lacks {', '.join(sorted(lacking))}")
    return tuple(acting.get(parameter.name, parameter) for parameter in stored)


def _parse_line(line: str) -> Parameter:
    name, kind, default = line.split(",")
    if int(kind) == mavlink.MAV_PARAM_TYPE_REAL32:
        return Parameter(name=name, default=float(default), lowest=-_REAL_MAX, highest=_REAL_MAX)
    most = INTEGER_MAX[int(kind)]
    return Parameter(name=name, default=int(default), lowest=-most - 1, highest=most, integer_type=int(kind))
