"""Flight limits from an autopilot's parameters, and which of these still have to be asked for; without I/O.

A limit that was never told counts as the firmware's default, so what is known by none of its names is asked for again,
for as long as that takes. Some firmware has no parameter of one name or another: then the question costs little.
A parameter may have been changed while nobody was heard, so that all are asked for again after a restart or a silence.
What has just changed and changes again is asked for later: with each gain the plan's matrices are made anew, and on a
small computer that takes longer than a step.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

from companion.autopilots.driver import Driver
from companion.autopilots.response import RATE_LAG_S
from companion.core.data import GRAVITY_M_S2
from link.mavlink.dialect import Message
from link.mavlink.parameters import parameter_value

_STATED_MIN = 0.1  # m/s, m/s^2, m/s^3 or degrees; a limit below this cannot be flown with
GAIN_FACTOR_MAX = 4.0  # about a default; the ranges that the firmwares state are narrower
INTEGRAL_FACTOR_MAX = 40.0  # PX4 states 150 times its default as the end of the range
TILT_LEAST_DEG = 10.0  # both firmwares' ranges begin here or above; less holds against no wind
_TILT_SHARE = 0.85  # of the largest tilt's thrust; the rest is for gusts and for the autopilot's own corrections


@dataclass(frozen=True, slots=True)
class Named:
    """One name of a parameter that limits the flight.

    Attributes:
        name: in some releases.
        unit: what one of its units is in m/s, m/s^2, m/s^3 or degrees.
        least: in these, what a smaller value counts as.
    """

    name: str
    unit: float = 1.0
    least: float = 0.0


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit of the autopilot's flight, in m/s, m/s^2, m/s^3 or degrees.

    Attributes:
        default: the firmware's. It counts while the autopilot has told the parameter by none of its names, as when a
            new release calls it otherwise: planned without, the drone would be led where it does not follow.
        names: of the parameter in the releases that are known.
    """

    default: float
    names: tuple[Named, ...]

    def find(self, parameters: Mapping[str, float]) -> float:
        """Return the limit that `parameters` tell, the default where they tell none or one that cannot be meant."""
        for named in self.names:
            value = parameters.get(named.name, math.nan) * named.unit
            if value >= _STATED_MIN:
                return max(value, named.least)
        return self.default


def names_of(limits: Sequence[Limit]) -> tuple[tuple[str, ...], ...]:
    """Return the parameters of `limits`, each by all of its names."""
    return tuple(tuple(named.name for named in limit.names) for limit in limits)


def find_gain(
    parameters: Mapping[str, float], names: Sequence[str], default: float, factor_max: float = GAIN_FACTOR_MAX
) -> float:
    """Return a gain by whichever of its names is known, the firmware's default where none is or it is not positive.

    A drone does not fly with gains far from the default; such a value is cut to where the cascade's model is stable.
    """
    for name in names:
        value = parameters.get(name, math.nan)
        if value > 0.0 and math.isfinite(value):
            return min(max(value, default / factor_max), default * factor_max)
    return default


def attitude_lag_s(shaped_s: float, position_per_s: float) -> float:
    """Return the lag from a wanted acceleration to the drone's.

    Args:
        shaped_s: time constant with which the attitude goes to what is asked of it; its turn rates lag besides.
        position_per_s: with a longer lag than half of its inverse no drone flies steadily.
    """
    return min(shaped_s + RATE_LAG_S, 0.5 / position_per_s)


def acceleration_of_tilt_m_s2(tilt_deg: float) -> float:
    """Return the horizontal thrust by mass that may be planned with under a tilt limit."""
    return _TILT_SHARE * GRAVITY_M_S2 * math.tan(math.radians(tilt_deg))


_ASK_AGAIN_NS = 5_000_000_000  # after six questions without an answer, as over a link that was silent


def parameter_names(driver: Driver) -> tuple[tuple[str, ...], ...]:
    """Return the parameters that the flight depends on, each by all of its names."""
    return (*driver.limit_names, *driver.gain_names, (driver.timeout_parameter,))


class LimitQuestions:
    """The parameters that are to be asked for: all of them at first."""

    def __init__(self) -> None:
        self._due_ns: dict[str, int] = {}
        self._told: set[str] = set()
        self._held_until_ns: dict[str, int] = {}
        self._asks_all = True

    def ask_all(self) -> None:
        """Ask for every parameter once more."""
        self._told.clear()
        self._held_until_ns.clear()
        self._asks_all = True

    def hear(self, message: Message, driver: Driver, known: Mapping[str, float], local_ns: int) -> Mapping[str, float]:
        """Return what is known after a PARAM_VALUE; the same object where that changes nothing.

        Somebody else may have asked for it, or changed it: autopilots tell everybody.
        """
        name, value = message.param_id, parameter_value(message, driver.autopilot_id)
        if value is None or not any(name in names for names in parameter_names(driver)):
            return known
        held_until_ns = self._held_until_ns.get(name, local_ns)
        if known.get(name) != value and local_ns < held_until_ns:
            self._told.discard(name)
            self._due_ns[name] = held_until_ns
            return known
        self._told.add(name)
        if known.get(name) == value:
            return known
        if name in known:
            self._held_until_ns[name] = local_ns + _ASK_AGAIN_NS
        return {**known, name: float(value)}

    def unanswered(self, name: str, local_ns: int) -> None:
        """Take note that the autopilot has not answered for `name`."""
        self._due_ns[name] = local_ns + _ASK_AGAIN_NS

    def due(self, driver: Driver, local_ns: int) -> list[str]:
        """Return the names to be asked for now, each once."""
        if self._asks_all:
            self._due_ns = dict.fromkeys(chain(*parameter_names(driver)), local_ns)
            self._asks_all = False
        due = [name for name, due_ns in self._due_ns.items() if local_ns >= due_ns]
        for name in due:
            del self._due_ns[name]
        open_names = [names for names in parameter_names(driver) if self._told.isdisjoint(names)]
        return [name for name in due if any(name in names for names in open_names)]
