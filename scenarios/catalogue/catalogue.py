"""The scenarios by name: TOML files in `scenarios/catalogue`, one per track, and presets of what goes with it.

A name is a track and its speed rounded down (`straight_5`), perhaps with presets (`straight_5+sensors=nominal`).
A file of one's own has the same keys, perhaps with presets behind its name as well (`own.toml+firmware=px4`); `base`
names a scenario to start from. A section is a preset's name, or a table of values, in which `preset` names what the
values change. A world of `scenarios.worlds` has a name too (`world:urban@123`).
"""

import difflib
import math
import os
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any, get_args

from companion.config.integrity import ReceiverFrames
from link.errors import UserError
from link.program.settings import SCENARIO, check_prefixes, settings_of_environment, settings_of_options
from link.program.toml_config import merge, read_toml, validate
from scenarios.catalogue.completion import look_out_for_silent_vehicle, place_drone
from scenarios.catalogue.world_names import names_worlds, parse_world_name
from scenarios.catalogue.worlds import named_world
from scenarios.config import RunConfig, Scenario
from scenarios.worlds.odd import slices


def tell_of_one_frame(scenario: Scenario) -> Scenario:
    """Return `scenario` with a companion that knows of receivers with one source of corrections, if they have one.

    What the file says of `receiver_frames` stays.
    """
    system = scenario.system
    integrity = system.companion.integrity
    if scenario.sensors.frame_offset_m > 0.0 or "receiver_frames" in integrity.model_fields_set:
        return scenario
    integrity = integrity.model_copy(update={"receiver_frames": ReceiverFrames.ONE})
    companion = system.companion.model_copy(update={"integrity": integrity})
    return scenario.model_copy(update={"system": system.model_copy(update={"companion": companion})})


Table = dict[str, Any]
_DEFAULT_PRESETS = {
    "sensors": "rtk",
    "wind": "calm",
    "link": "ideal",
    "vehicle": "car",
    "system": "default",
    "camera": "none",
}
_PLAIN_OPTIONS = ("firmware", "detector", "telemetry")
_RUN_OPTIONS = ("start", "place")
_SUFFIX = ".toml"
_LIKENESS = 0.6  # of a word that was meant; beside a section that there is not, a preset must be the very one


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A scenario of the catalogue in one line."""

    name: str
    description: str


def list_scenarios() -> list[Entry]:
    """Return the catalogue's scenarios in the order of their names."""
    return [Entry(name=name, description=table["description"]) for name, table in sorted(_scenarios().items())]


def list_presets() -> dict[str, tuple[str, ...]]:
    """Return what may be written behind a name, presets and plain options, by section; the default one first."""
    named = {section: (_presets(section), default) for section, default in _DEFAULT_PRESETS.items()}
    fields = {option: Scenario.model_fields[option] for option in _PLAIN_OPTIONS}
    fields |= {option: RunConfig.model_fields[option] for option in _RUN_OPTIONS}
    plain = {option: (get_args(field.annotation), field.default) for option, field in fields.items()}
    return {
        section: tuple(sorted(names, key=lambda name, first=default: (name != first, name)))
        for section, (names, default) in (named | plain).items()
    }


def load_scenario(name_or_path: str) -> Scenario:
    """Return the scenario called `name_or_path`, or the one in that TOML file.

    Raises:
        UserError: no such scenario, preset or file, a file that does not fit, a drone inside the vehicle, or a world
            that is held back.
    """
    if names_worlds(name_or_path):
        return named_world(parse_world_name(name_or_path)).scenario
    # A folder may have a "+" in its name.
    path, suffix, presets = name_or_path.rpartition(_SUFFIX)
    name, *options = presets.split("+")
    if suffix:
        table = {"name": Path(path).name} | _file_table(Path(path + suffix + name))
        table["name"] = "+".join((table["name"], *options))
    else:
        table = _find_table(name) | {"name": name_or_path}
    for option in options:
        table = _with_option(table, option, options, name_or_path)
    return complete(validate(Scenario, _resolve(table, name_or_path), source=name_or_path))


def complete(scenario: Scenario) -> Scenario:
    """Return a scenario whose companion knows what its owner would tell it of the receivers and of a silent vehicle.

    Raises:
        UserError: the drone waits inside the vehicle.
    """
    return place_drone(look_out_for_silent_vehicle(tell_of_one_frame(scenario)))


def _with_option(table: Table, option: str, options: Sequence[str], whole: str) -> Table:
    section, equals, preset = option.partition("=")
    sections = (*_DEFAULT_PRESETS, *_PLAIN_OPTIONS, *_RUN_OPTIONS)
    if not equals or section not in sections:
        meant = _meant(section, preset)
        near = f"did you mean +{meant}?" if meant else f"there are {', '.join(sections)}, each with =PRESET"
        raise UserError(f"{whole}: no preset is called '{option}'; {near} (`scenarios list` shows them)")
    if sum(one.startswith(f"{section}=") for one in options) > 1:
        raise UserError(f"{whole} names its {section} twice: leave one out")
    return merge(table, {"run": {section: preset}}) if section in _RUN_OPTIONS else table | {section: preset}


def _meant(section: str, preset: str) -> str:
    """Return the option that was probably meant, of any section; empty if none is near."""
    near = difflib.get_close_matches(section, _DEFAULT_PRESETS, n=1)
    if preset and near:
        return f"{near[0]}={preset}"
    named = {name: f"{one}={name}" for one in _DEFAULT_PRESETS for name in _presets(one)}
    near = difflib.get_close_matches(preset or section, named, n=1, cutoff=1.0 if preset else _LIKENESS)
    return named[near[0]] if near else ""


def _find_table(name: str, place: str = "") -> Table:
    """Return the catalogue's table called `name`; `place` is where the name stands, for the message."""
    try:
        return _scenarios()[name]
    except KeyError:
        raise _unknown("scenario", name, [*_scenarios(), *slices()], "; `scenarios list` shows all", place) from None


def _unknown(what: str, name: str, known: list[str], hint: str = "", place: str = "") -> UserError:
    """Return the error that names the nearest, or what there is where none is near."""
    near = difflib.get_close_matches(name, known, n=1)
    meant = f", the nearest is '{near[0]}'{hint}" if near else hint or f"; there are {', '.join(known)}"
    return UserError(f"{place}no {what} is called '{name}'{meant}")


@cache
def _scenarios() -> dict[str, Table]:
    """Return every scenario of the catalogue as its unresolved table, by name."""
    tables = {
        file.name.removesuffix(".toml"): _read(file) for file in _folder().iterdir() if file.name.endswith(".toml")
    }
    found: dict[str, Table] = {}
    for track, table in tables.items():
        whole = merge(tables[table["base"]], table) if "base" in table else table
        found |= _at_speeds(track, {key: value for key, value in whole.items() if key != "base"})
    return found


def _at_speeds(track: str, table: Table) -> dict[str, Table]:
    """Return the scenarios of one track, one for each of its speeds."""
    speeds_m_s = table.pop("speeds_m_s", None)
    if speeds_m_s is None:
        return {track: table}
    return {
        f"{track}_{math.floor(speed_m_s)}": merge(
            table,
            {"description": f"{table['description']}, {speed_m_s:g} m/s", "track": {"speed_m_s": speed_m_s}},
        )
        for speed_m_s in speeds_m_s
    }


def _file_table(path: Path) -> Table:
    """Return the table of a user's file, laid over its base."""
    table = read_toml(path)
    if (base := table.pop("base", None)) is None:
        return table
    below, track = _find_table(str(base), f"{path}: base: "), table.get("track")
    is_other = isinstance(track, dict) and track.get("kind") not in {None, below["track"]["kind"]}
    return merge(below | {"track": {}} if is_other else below, table)  # another kind has other keys


def _resolve(table: Table, source: str) -> Table:
    """Return `table` with the presets' values in place of their names."""
    return table | {section: _section(section, table.get(section), source) for section in _DEFAULT_PRESETS}


def _section(section: str, value: object, source: str) -> Table:
    if value is None:
        value = _DEFAULT_PRESETS[section]
    values = dict(value) if isinstance(value, dict) else {"preset": value}
    preset = values.pop("preset", None)
    if preset is None:
        return values
    presets = _presets(section)
    if preset not in presets:
        others = [one for one in _DEFAULT_PRESETS if preset in _presets(one)]
        elsewhere = f", or is it +{others[0]}={preset}?" if others else ""
        raise _unknown(f"preset of {section} ({source})", str(preset), list(presets), elsewhere)
    return merge(presets[preset], values)


@cache
def _presets(section: str) -> dict[str, Table]:
    tables = _read(_folder() / "presets" / f"{section}.toml")
    return {name: _on_base(table, tables) for name, table in tables.items()}


def _on_base(table: Table, tables: Table) -> Table:
    """Return `table` laid over the one that its `base` names."""
    if "base" not in table:
        return table
    own = {key: value for key, value in table.items() if key != "base"}
    return merge(_on_base(tables[table["base"]], tables), own)


def _folder() -> Traversable:
    return resources.files("scenarios") / "catalogue"


def _read(file: Traversable) -> Table:
    return tomllib.loads(file.read_text(encoding="utf-8"))


def load_changed_scenario(name_or_path: str, given: Sequence[str] | None) -> Scenario:
    """Return a scenario as `load_scenario` does, with what the environment and `--set` say laid over it.

    Args:
        name_or_path: of the scenario, a world's too.
        given: by `--set`; keys of the scenario, such as `system.companion.descent.cone.slope=0.3`.

    Raises:
        UserError: no such scenario, or a setting that does not fit.
    """
    scenario = load_scenario(name_or_path)
    check_prefixes(os.environ)
    environment, overrides = settings_of_environment(SCENARIO, Scenario), settings_of_options(given)
    if not environment and not overrides:
        return scenario
    table = scenario.model_dump(mode="json", exclude_none=True)
    changed = validate(Scenario, table, source=name_or_path, overrides=overrides, environment=environment)
    return complete(changed)
