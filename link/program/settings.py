"""Single settings beside a file: `--set KEY=VALUE` and environment variables, over what the file says.

A key is dotted, as in `descent.cone.slope`; a value is written as in TOML, a word may go without quotes. The variable
of that key is `DECKLANDER_COMPANION__DESCENT__CONE__SLOPE`: the prefix names what is configured. The environment stands
above a file, the command line above both. What the environment says is told at each start: nobody sees it otherwise.
"""

import difflib
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from link.errors import UserError
from link.program.near_names import models_in
from link.program.toml_config import DEPTH_MAX, Model, load_config, merge, tables_of

COMPANION, SIM_AUTOPILOT, SCENARIO = "DECKLANDER_COMPANION", "DECKLANDER_SIM_AUTOPILOT", "DECKLANDER_SCENARIO"
"""What the variables of each configuration begin with."""

PREFIXES = (COMPANION, SIM_AUTOPILOT, SCENARIO)
_OURS = "DECKLANDER_"
_BELOW = "__"
_TOLD = 60  # characters of what is far too long


def load_settings(
    path: Path | None,
    model: type[Model],
    prefix: str,
    given: Sequence[str] | None,
    above: Mapping[str, Any] | None = None,
) -> Model:
    """Return the configuration in a file, with the environment over it, and the command line over both.

    Which variables there are is written to standard error.

    Args:
        path: of the file, None for none.
        model: what it must fit.
        prefix: of the environment's variables, one of `PREFIXES`.
        given: by `--set`.
        above: from options of their own.

    Raises:
        UserError: something cannot be read, or does not fit.
    """
    check_prefixes(os.environ)
    settings = load_config(path, model, settings_of_options(given, above), settings_of_environment(prefix, model))
    names = variables_of(prefix, os.environ)
    if names:
        sys.stderr.write(f"configuration: set by the environment: {', '.join(names)}\n")
    return settings


def check_prefixes(environment: Mapping[str, str]) -> None:
    """Refuse variables that look like ours and would set nothing.

    Raises:
        UserError: there is one; with the beginnings that there are.
    """
    known = tuple(prefix + _BELOW for prefix in PREFIXES)
    for name in sorted(environment):
        if name.startswith(_OURS) and not name.startswith(known):
            meant = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
            raise UserError(
                f"environment: {name} sets nothing: it must begin with {meant[0]}, and have {_BELOW} for a dot"
            )


def refuse_variables(*, apart_from: str | None = None) -> None:
    """Refuse variables of ours that would change nothing of what is about to be flown.

    Args:
        apart_from: the prefix of those that do change it, None where none do.

    Raises:
        UserError: there is one.
    """
    check_prefixes(os.environ)
    names = [name for prefix in PREFIXES if prefix != apart_from for name in variables_of(prefix, os.environ)]
    if names:
        raise UserError(
            f"environment: {', '.join(names)} would change nothing here: unset it, and write what is to change into a "
            "scenario's file"
        )


def variables_of(prefix: str, environment: Mapping[str, str]) -> list[str]:
    """Return the names of the variables that set something of what `prefix` names, sorted."""
    return sorted(name for name in environment if name.startswith(prefix + _BELOW))


def settings_of_options(given: Sequence[str] | None, above: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return what `--set` says as tables.

    Args:
        given: as it was written, each `KEY=VALUE`.
        above: laid over it: settings that have an option of their own.

    Raises:
        UserError: one is no `KEY=VALUE`, or no key or value of a configuration.
    """
    tables: dict[str, Any] = {}
    for one in given or ():
        key, equals, value = one.partition("=")
        parts = key.strip().split(".")
        if not equals or not all(parts):
            raise UserError(f"--set {one}: is no KEY=VALUE; write it as section.key=value")
        _check_text(f"--set {key}", parts, value)
        tables = merge(tables, _nested(parts, _value(value)))
    return merge(tables, above or {})


def settings_of_environment(
    prefix: str, model: type[BaseModel], environment: Mapping[str, str] = os.environ
) -> dict[str, Any]:
    """Return what the variables that begin with `prefix` say, as tables.

    Args:
        prefix: one of `PREFIXES`.
        model: of the configuration: its keys are lower case, and what it leaves open keeps the case it has.
        environment: the variables.

    Raises:
        UserError: one is no key or value of a configuration.
    """
    tables: dict[str, Any] = {}
    for name in variables_of(prefix, environment):
        parts = name.removeprefix(prefix + _BELOW).split(_BELOW)
        _check_text(f"environment: {name}", parts, environment[name])
        tables = merge(tables, _nested(_keys(parts, model), _value(environment[name])))
    return tables


def without_settings(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a child process that is told all its settings otherwise."""
    return {name: value for name, value in environment.items() if not name.startswith(PREFIXES)}


def _keys(parts: Sequence[str], model: type[BaseModel]) -> list[str]:
    """Return the keys that parts of a variable's name stand for."""
    keys: list[str] = []
    models: Sequence[type[BaseModel]] = [model]
    for part in parts:
        keys.append(part.lower() if models else part)
        fields = [one.model_fields[keys[-1]] for one in models if keys[-1] in one.model_fields]
        models = [below for field in fields for below in models_in(field.annotation)] if fields else models
    return keys


def _check_text(told: str, parts: Sequence[str], value: str) -> None:
    if len(parts) > DEPTH_MAX:
        raise UserError(f"{told[:_TOLD]}...: has {len(parts)} parts, and no setting has more than {DEPTH_MAX}")
    try:
        "".join((*parts, value)).encode()
    except UnicodeEncodeError:  # bytes that are none stand in it as surrogates
        raise UserError(f"{told}: is not UTF-8; write it in UTF-8") from None


def _nested(parts: Sequence[str], value: Any) -> dict[str, Any]:
    first, *others = parts
    return {first: _nested(others, value) if others else value}


def _value(text: str) -> Any:
    """Return a value as TOML reads it; what is none, such as a bare word, is a text."""
    try:
        table = tables_of(f"value = {text}")
    except (ValueError, RecursionError):  # no TOML, or none of a configuration
        return text
    return table["value"] if table.keys() == {"value"} else text
