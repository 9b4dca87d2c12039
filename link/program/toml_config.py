"""Configuration in TOML: read once, checked against a model, printed back; mistakes name the file and the key."""

import json
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from link.errors import UserError
from link.program.near_names import key_hint, models_in
from link.program.text import read_text

Location = tuple[int | str, ...]
Fields = Mapping[str, FieldInfo]

Positive = Annotated[float, Field(gt=0.0, le=1e4)]
NotNegative = Annotated[float, Field(ge=0.0, le=1e4)]
"""A length, time or speed beyond this was meant in another unit."""

_LINE_MAX = 200  # characters of what is said about one mistake
_MISTAKES_MAX = 3  # told of one file, the others are counted
_SOURCE_MAX, _VALUE_MAX = 100, 40  # of them, for the file's name and for a value
_CUT = "..."
_BOUNDS = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}


class StrictModel(BaseModel):
    """A table of a configuration: no unknown keys, no infinite numbers, never changed after it was read.

    Nothing is converted: neither a text nor true is a number. A whole number is a number.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, validate_default=True)


Model = TypeVar("Model", bound=StrictModel)


def load_config(
    path: Path | None,
    model: type[Model],
    overrides: Mapping[str, Any] | None = None,
    environment: Mapping[str, Any] | None = None,
) -> Model:
    """Return the configuration in a file.

    Args:
        path: of the TOML file; None is an empty one.
        model: what it must fit.
        overrides: laid over all else, table by table; from the command line.
        environment: laid over the file's values; from variables.

    Raises:
        UserError: the file cannot be read, is no TOML, or a key or value does not fit.
    """
    table = {} if path is None else read_toml(path)
    source = "the defaults" if path is None else str(path)
    return validate(model, table, source=source, overrides=overrides, environment=environment)


def validate(
    model: type[Model],
    table: Mapping[str, Any],
    *,
    source: str,
    overrides: Mapping[str, Any] | None = None,
    environment: Mapping[str, Any] | None = None,
) -> Model:
    """Return `table` as a `model`, with what is laid over it as `load_config` says.

    Raises:
        UserError: with `source`, the first key that does not fit, its value and what would.
    """
    above, between = overrides or {}, environment or {}

    def source_of(location: Location) -> str:
        if not location and _has_value(above):
            return f"{source} with the command line"
        if _is_in(location, above):
            return "command line"
        return "environment" if _is_in(location, between) else source

    return _check(model, merge(merge(table, between), above) if between or above else table, source_of)


def _has_value(table: Mapping[str, Any]) -> bool:
    """Return whether anything is laid over by a table: None leaves what is below."""
    return any(_has_value(one) if isinstance(one, Mapping) else one is not None for one in table.values())


def merge(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return `below` with the values of `above` laid over it, table by table; None leaves what is below."""
    both = dict(below)
    for key, value in above.items():
        if value is None:
            continue
        under = both.get(key)
        is_table = isinstance(value, Mapping)
        both[key] = merge(under if isinstance(under, Mapping) else {}, value) if is_table else value
    return both


def dump_toml(model: StrictModel) -> str:
    """Return the configuration as TOML that `load_config` reads back to the same; None values are left out."""
    import tomli_w  # noqa: PLC0415 (only where a configuration is printed)

    return tomli_w.dumps(model.model_dump(mode="json", exclude_none=True))


def read_toml(path: Path) -> dict[str, Any]:
    """Return the tables of a file.

    Raises:
        UserError: it cannot be read, or is no TOML.
    """
    return parse_toml(read_text(path), str(path))


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Return the tables of a text, which `source` names.

    Raises:
        UserError: it is no TOML.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{source}: not valid TOML ({error})") from None
    except ValueError as error:  # an integer of thousands of digits
        raise UserError(f"{source}: not valid TOML ({str(error).partition(';')[0]})") from None
    except RecursionError:
        raise UserError(f"{source}: not valid TOML (nested too deep)") from None


def _check(model: type[Model], table: Mapping[str, Any], source_of: Callable[[Location], str]) -> Model:
    try:
        # as JSON, whose arrays and texts a strict model takes for tuples and enumerations
        return model.model_validate_json(json.dumps(table, default=str))
    except RecursionError:
        raise UserError(f"{source_of(())}: nested too deep") from None
    except ValidationError as error:
        # an unknown key goes first: misspelt, it is why another one is missing
        details = sorted(error.errors(include_url=False), key=lambda one: one["type"] != "extra_forbidden")
        raise UserError(_report(details, model, source_of)) from None


def _report(details: Sequence[ErrorDetails], model: type[BaseModel], source_of: Callable[[Location], str]) -> str:
    """Return the first mistakes in one line; a source is named where it is another one than before."""
    told: dict[str, None] = {}
    before = ""
    for one in details[:_MISTAKES_MAX]:
        location, fields = _place(one["loc"], model)
        source = source_of(location)
        source = source if len(source) <= _SOURCE_MAX else _CUT + source[-_SOURCE_MAX:]
        text = _cut(" ".join(_sentence(one, location, fields, model).split()), _LINE_MAX - len(source) - 2)
        told[text if source == before else f"{source}: {text}"] = None
        before = source
    further = len(details) - _MISTAKES_MAX
    return "; ".join((*told, *([f"and {further} more"] if further > 0 else [])))


def _is_in(location: Location, table: Mapping[str, Any]) -> bool:
    """Return whether the value at `location` comes from `table`."""
    node: Any = table
    for part in location:
        if not isinstance(node, Mapping):
            return True  # within a value that was given whole, such as a list
        if node.get(str(part)) is None:
            return False
        node = node[str(part)]
    return bool(location)  # what does not fit as a whole is the file's


def _sentence(details: ErrorDetails, location: Location, fields: Fields, model: type[BaseModel]) -> str:
    """Return what names the key, the value and what would fit."""
    key = _key(location)
    if details["type"] == "extra_forbidden":
        return f"unknown key '{key}'{key_hint(key, list(fields), model)}"
    if details["type"] == "missing" and isinstance(location[-1], int):
        return f"{_key(location[:-1])} is too short: it must have more than {location[-1]} values"
    if details["type"] == "missing":
        return f"key '{key}' is missing"
    if details["type"] == "model_type" and location:
        return f"{_describe_value(key, details['input'])} does not fit: it is a table, whose keys are set one by one"
    field = fields.get(str(location[-1])) if location else None
    is_ours = details["type"] == "value_error"  # a check of the model's own, beyond the range of one number
    expected = ("" if is_ours or field is None else _range_of(field)) or _lower_first(details["msg"])
    return f"{_describe_value(key, details['input'])} does not fit: {expected}"


def _key(location: Location) -> str:
    """Return a place in a file as people write it: `track.waypoints_m[3][0]`."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).removeprefix(".")


def _describe_value(key: str, value: object) -> str:
    """Return a key with its value; a table or a list, which may be long, is named only."""
    if not key or isinstance(value, Mapping | list | tuple):
        return key or "it"
    return f"{key} = {_cut(json.dumps(value, default=str), _VALUE_MAX)}"


def _cut(text: str, length: int) -> str:
    return text if len(text) <= length else text[: length - len(_CUT)] + _CUT


def _lower_first(message: str) -> str:
    plain = message.removeprefix("Value error, ")
    return plain[:1].lower() + plain[1:]


def _range_of(field: FieldInfo) -> str:
    """Return the range of a number in words, empty if it has none."""
    bounds = [
        f"{word} {getattr(limit, name)}"
        for name, word in _BOUNDS.items()
        for limit in field.metadata
        if getattr(limit, name, None) is not None
    ]
    kind = "a whole number" if field.annotation is int else "a number"
    return f"it must be {kind} {' and '.join(bounds)}" if bounds and field.annotation in {int, float} else ""


def _place(location: Location, model: type[BaseModel]) -> tuple[Location, Fields]:
    """Return where in the file a mistake is, and the fields of the table that its last part is in.

    Where a table's kind decides which model it must fit, the kind stands in pydantic's location, but not in the file.
    """
    kept: list[int | str] = []
    beside: Fields = model.model_fields
    below: Fields = beside
    by_kind: Mapping[int | str, type[BaseModel]] = {}
    for part in location:
        if part in by_kind:
            below, by_kind = by_kind[part].model_fields, {}
            continue
        kept.append(part)
        beside = below
        field = beside.get(part) if isinstance(part, str) else None
        if field is not None:
            models = list(models_in(field.annotation))
            below, by_kind = (models[0].model_fields if models else {}), _by_kind(models, field.discriminator)
    return tuple(kept), beside


def _by_kind(models: Sequence[type[BaseModel]], discriminator: object) -> Mapping[int | str, type[BaseModel]]:
    """Return which model each value of the `discriminator`, a key of all of them, stands for."""
    if not isinstance(discriminator, str):
        return {}
    return {kind: model for model in models for kind in get_args(model.model_fields[discriminator].annotation)}
