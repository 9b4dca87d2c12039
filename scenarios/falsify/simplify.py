"""What of a scenario can be made ideal: calm air, links that deliver at once, exact sensors, a smooth and level road.

A detail is a place in the scenario's table: a key whose value differs from its ideal, or an element of one of the lists
of a drive (a shift, a grade, a hump, a wave, a leg). A scenario without some of its details is the same with these made
ideal or left out. Which of them a failure needs is for `scenarios.falsify.minimal` to find.
"""

from collections.abc import Collection, Iterator
from typing import Any

from link.errors import UserError
from link.program.toml_config import validate
from scenarios.config import ChannelConfig, ClockConfig, OwnStateConfig, RangeConfig, Scenario, WindConfig
from sim_autopilot.runtime.config import DroneConfig

Table = dict[str, Any]
Detail = tuple[str | int, ...]

_IDEAL_SECTIONS: dict[tuple[str, ...], Table] = {
    ("wind",): WindConfig().model_dump(mode="json"),
    ("link", "mavlink"): ChannelConfig().model_dump(mode="json"),
    ("link", "zenoh"): ChannelConfig().model_dump(mode="json"),
    ("link", "detector"): ChannelConfig().model_dump(mode="json"),
    ("sensors", "clock"): ClockConfig().model_dump(mode="json"),
    ("sensors", "own_state"): OwnStateConfig().model_dump(mode="json"),
    ("sensors", "range_finder"): RangeConfig().model_dump(mode="json"),
    ("system", "drone"): DroneConfig().model_dump(mode="json"),
}
_IDEAL_SENSOR = {
    "delay_s": 0.0,
    "jitter_s": 0.0,
    "loss": 0.0,
    "bias_m": 0.0,
    "heading_bias_rad": 0.0,
    "dropout_share_range": [0.0, 0.0],
}
"""Of what a sensor does to its samples; how noisy it says that it is stays, for nothing measures without any noise."""
_LISTS = ("shifts", "grades", "humps", "waves", "legs")


def details(scenario: Scenario) -> list[Detail]:
    """Return the details of `scenario`: of the road first, then of the air, the links, the sensors and the drone."""
    return list(_details(scenario.model_dump(mode="json")))


def without(scenario: Scenario, left_out: Collection[Detail]) -> Scenario | None:
    """Return `scenario` without some of its details, None where nothing valid remains."""
    table = scenario.model_dump(mode="json")
    for detail in left_out:
        if detail[0] != "track":
            _section(table, detail[:-1])[str(detail[-1])] = _ideal(detail)
    for name in _LISTS:
        if any(detail[:2] == ("track", name) for detail in left_out):
            elements = enumerate(table["track"][name])
            table["track"][name] = [one for place, one in elements if ("track", name, place) not in left_out]
    try:
        return validate(Scenario, table, source=scenario.name)
    except UserError:
        return None


def _details(table: Table) -> Iterator[Detail]:
    if table["track"]["kind"] == "drive":
        for name in _LISTS:
            yield from (("track", name, place) for place in range(len(table["track"][name])))
    for path, ideal in _IDEAL_SECTIONS.items():
        section = _section(table, path)
        yield from ((*path, key) for key, value in ideal.items() if section[key] != value)
    for sensor in ("fix", "velocity", "imu", "pattern"):
        section = table["sensors"][sensor] or {}
        yield from (
            ("sensors", sensor, key) for key, value in _IDEAL_SENSOR.items() if section.get(key, value) != value
        )
    if table["sensors"]["frame_offset_m"] != 0.0:
        yield ("sensors", "frame_offset_m")


def _ideal(detail: Detail) -> Any:
    *path, key = (str(part) for part in detail)
    if detail == ("sensors", "frame_offset_m"):
        return 0.0
    section = _IDEAL_SECTIONS.get(tuple(path))
    return _IDEAL_SENSOR[key] if section is None else section[key]


def _section(table: Table, path: Collection[str | int]) -> Table:
    for part in path:
        table = table[str(part)]
    return table
