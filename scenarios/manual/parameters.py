"""The page of an autopilot's advised parameters, from the rules by which `companion check` judges them."""

from collections.abc import Iterator, Sequence

from companion.check.firmwares import FIRMWARES
from companion.check.rules import ParameterRule
from companion.config.companion import CompanionConfig
from scenarios.manual.markdown import code, page, table

SPEEDS_M_S = (5.0, 8.0, 10.0)
TEXT = """`companion check --mavlink DEVICE --speed-max M_S` reads these parameters, says which must change, and with
`--write` writes what it advises. The columns are for a vehicle at 5, 8 and 10 m/s. A second name of a parameter is
that of an older release, which counts in the unit in brackets. [PX4](../px4.md) and [ArduCopter](../ardupilot.md) say
how to wire them and what they do."""
_HEAD = ("parameter", *(f"{speed_m_s:g} m/s" for speed_m_s in SPEEDS_M_S), "unit", "why")


def parameters_page() -> str:
    """Return the page, a section a firmware."""
    sink_m_s = CompanionConfig().descent.sink.rate_max_m_s
    parts = [TEXT]
    for firmware in FIRMWARES.values():
        parts += [f"## {firmware.name}", table(_HEAD, _rows(firmware.rules_for(sink_m_s)))]
        parts += [
            "To launch from a vehicle that drives (`companion check --launch`):",
            table(_HEAD, _rows(firmware.launch)),
        ]
    return page("Advised parameters", *parts)


def _rows(rules: Sequence[ParameterRule]) -> Iterator[tuple[str, ...]]:
    for rule in rules:
        names = (
            code(one.name) + ("" if one.per_unit == 1.0 else f" ({rule.unit} / {one.per_unit:g})")
            for one in rule.spellings
        )
        advised = (f"{rule.advised(0.0, speed_m_s):g}" for speed_m_s in SPEEDS_M_S)
        yield ", ".join(names), *advised, rule.unit, rule.reason
