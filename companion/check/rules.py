"""Rules about an autopilot's parameters as data, and the one function that applies them; pure.

A rule compares a parameter, in SI units or degrees, with what a landing at a speed needs.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from companion.check.findings import Finding, Level, pass_line
from companion.core.data import GRAVITY_M_S2

SPEED_SHARE_ADVISED = 1.2
"""Of the vehicle's speed: the drone has to catch up and to correct. More than what a landing is refused for, so that a
vehicle a little faster than it was said to be does not stop one."""

SORTIE_SPEED_SHARE = 2.0
"""Of the vehicle's speed, for a drone that is left behind: it closes in as fast as the vehicle drives."""

GRADE_MAX = 0.05
"""Of a road; on it the deck itself climbs or sinks."""

DRAG_1_M = 0.0544
"""Deceleration by drag over speed squared: ArduCopter's simulated quad came to 10.2 m/s at a tilt of 30 degrees."""

MANOEUVRE_M_S2 = 1.9
"""Kept at full speed for correction: with it the rule gives the 45 degrees that were flown at 12 m/s."""


_CLIMB_M_S = 2.0
_ROUNDING = 1e-6  # of the 32-bit floats that parameters are


@dataclass(frozen=True, slots=True)
class Spelling:
    """A parameter's name in some releases, and how many of its units make one of the rule's."""

    name: str
    per_unit: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRule:
    """What one parameter must be.

    Attributes:
        spellings: its names, the newest release's first; the first that the autopilot knows counts.
        unit: of the rule.
        level: when the test fails.
        test: of the value for a vehicle's speed in m/s.
        advised: the value to set in place of another for that speed; it passes the test.
        reason: why it matters.
        is_fatal: values that fail whatever the level, None when there are none.
    """

    spellings: tuple[Spelling, ...]
    unit: str
    level: Level
    test: Callable[[float, float], bool]
    advised: Callable[[float, float], float]
    reason: str
    is_fatal: Callable[[float], bool] | None = None


def tilt_needed_deg(speed_m_s: float) -> float:
    """Return the tilt that holds `speed_m_s` against drag with some acceleration left."""
    return math.degrees(math.atan((DRAG_1_M * speed_m_s**2 + MANOEUVRE_M_S2) / GRAVITY_M_S2))


def at_least(
    needed: Callable[[float], float],
    *,
    step: float,
    spellings: tuple[Spelling, ...],
    unit: str,
    level: Level,
    reason: str,
) -> ParameterRule:
    """Return the rule of a parameter that has to be `needed` at a speed; advised is the next whole `step`."""
    return ParameterRule(
        spellings=spellings,
        unit=unit,
        level=level,
        test=lambda value, speed_m_s: value >= needed(speed_m_s) - _ROUNDING,
        advised=lambda _, speed_m_s: step * math.ceil((needed(speed_m_s) - _ROUNDING) / step),
        reason=reason,
    )


def equals(
    wanted: float,
    *,
    spellings: tuple[Spelling, ...],
    level: Level,
    reason: str,
    is_fatal: Callable[[float], bool] | None = None,
) -> ParameterRule:
    """Return the rule of a choice, a parameter without unit, that has to be `wanted`."""
    return ParameterRule(
        spellings=spellings,
        unit="",
        level=level,
        test=lambda value, _: value == wanted,
        advised=lambda *_: wanted,
        reason=reason,
        is_fatal=is_fatal,
    )


def setpoint_loss_rule(
    spellings: tuple[Spelling, ...], range_s: tuple[float, float], advised_s: float, level: Level, reason: str
) -> ParameterRule:
    """Return the rule of the parameter that says how long setpoints may stay away."""
    return ParameterRule(
        spellings=spellings,
        unit="s",
        level=level,
        test=lambda value, _: range_s[0] <= value <= range_s[1],
        advised=lambda *_: advised_s,
        reason=reason,
    )


def speed_rule(spellings: tuple[Spelling, ...], level: Level, reason: str) -> ParameterRule:
    """Return the rule of a parameter that is a horizontal speed which the vehicle's must be less than."""
    return _share_rule(SPEED_SHARE_ADVISED, spellings, level, reason)


def sortie_speed_rule(spellings: tuple[Spelling, ...]) -> ParameterRule:
    """Return the rule of the drone's speed for a sortie, from which it comes home to a vehicle that has driven on."""
    reason = "on the way home it is what this leaves beside the vehicle's speed that the drone closes in by"
    return _share_rule(SORTIE_SPEED_SHARE, spellings, Level.WARN, reason)


def _share_rule(share: float, spellings: tuple[Spelling, ...], level: Level, reason: str) -> ParameterRule:
    return at_least(
        lambda speed_m_s: share * speed_m_s, step=1.0, spellings=spellings, unit="m/s", level=level, reason=reason
    )


def tilt_rule(spellings: tuple[Spelling, ...], reason: str) -> ParameterRule:
    """Return the rule of the parameter that limits the tilt."""
    return at_least(
        tilt_needed_deg,
        step=5.0,
        spellings=spellings,
        unit="deg",
        level=Level.FAIL,
        reason=f"the tilt that holds the speed against drag{reason}",
    )


def climb_rule(spellings: tuple[Spelling, ...]) -> ParameterRule:
    """Return the rule of the parameter that limits the climb."""
    return _vertical_rule(spellings, _CLIMB_M_S, "the climb of an abort, away from a deck that drives uphill")


def sink_rule(spellings: tuple[Spelling, ...], sink_m_s: float) -> ParameterRule:
    """Return the rule of the parameter that limits the descent, for a companion that sinks by `sink_m_s` at most."""
    reason = "the descent onto a deck that drives downhill, and the correction of its height"
    return _vertical_rule(spellings, sink_m_s, reason)


def _vertical_rule(spellings: tuple[Spelling, ...], own_m_s: float, reason: str) -> ParameterRule:
    """Return the rule of a vertical speed: the drone's own, and that of a deck on a steep road."""
    return at_least(
        lambda speed_m_s: own_m_s + GRADE_MAX * speed_m_s,
        step=0.5,
        spellings=spellings,
        unit="m/s",
        level=Level.WARN,
        reason=reason,
    )


def names_of(rules: Sequence[ParameterRule]) -> tuple[str, ...]:
    """Return every name that the rules look for."""
    return tuple(spelling.name for rule in rules for spelling in rule.spellings)


def judge(rules: Sequence[ParameterRule], parameters: Mapping[str, float], speed_m_s: float) -> list[Finding]:
    """Return a finding for each rule.

    Args:
        rules: of the autopilot's firmware.
        parameters: those that it answered, by name, in its own units.
        speed_m_s: of the vehicle.
    """
    return [_judge(rule, parameters, speed_m_s) for rule in rules]


def _judge(rule: ParameterRule, parameters: Mapping[str, float], speed_m_s: float) -> Finding:
    known = next((spelling for spelling in rule.spellings if spelling.name in parameters), None)
    if known is None:
        return Finding(
            name=" or ".join(spelling.name for spelling in rule.spellings),
            level=Level.WARN,
            found="not answered",
            advice="look for its name in this release, or check the link",
            reason=rule.reason,
        )
    value = parameters[known.name] / known.per_unit
    found = _shown(parameters[known.name], value, rule.unit, known)
    if rule.test(value, speed_m_s):
        return pass_line(known.name, found)
    advised = rule.advised(value, speed_m_s)
    return Finding(
        name=known.name,
        level=Level.FAIL if rule.is_fatal is not None and rule.is_fatal(value) else rule.level,
        found=found,
        advice=f"set it to {advised * known.per_unit:g}",
        reason=rule.reason,
        set_to=advised * known.per_unit,
    )


def _shown(raw: float, value: float, unit: str, spelling: Spelling) -> str:
    own = f"{raw:g}" if spelling.per_unit != 1.0 else ""
    return " ".join(part for part in (own and f"{own},", f"{value:g}", unit) if part)
