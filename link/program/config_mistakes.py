"""What is wrong in a configuration, in one line: the key as it stands in the file, its value, and what would fit."""

import json
from collections.abc import Callable, Mapping, Sequence
from typing import get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from link.errors import own_words
from link.program.near_names import key_hint, models_in

Location = tuple[int | str, ...]
Fields = Mapping[str, FieldInfo]

_LINE_MAX = 200  # characters of what is said about one mistake
_MISTAKES_MAX = 3  # told of one file, the others are counted
_SOURCE_MAX, _VALUE_MAX = 100, 40  # of them, for the file's name and for a value
_CUT = "..."
_QUOTE = "'"
_TABLES = frozenset({"model_type", "dict_type"})  # of what pydantic says where a table is to be
_BOUNDS = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}


def report(details: Sequence[ErrorDetails], model: type[BaseModel], source_of: Callable[[Location], str]) -> str:
    """Return the first mistakes in one line; a source is named where it is another one than before.

    Args:
        details: of pydantic.
        model: that was to fit.
        source_of: what is to be named as the source of a value.
    """
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


def _sentence(details: ErrorDetails, location: Location, fields: Fields, model: type[BaseModel]) -> str:
    """Return what names the key, the value and what would fit."""
    key = _key(location)
    if details["type"] == "extra_forbidden":
        return f"unknown key '{key}'{key_hint(key, list(fields), model)}"
    shape = _wrong_shape(details, location)
    return shape or f"{_describe_value(key, details['input'])} does not fit: {_expected(details, location, fields)}"


def _wrong_shape(details: ErrorDetails, location: Location) -> str:
    """Return what a table or a list lacks or has too much of, empty for a value that does not fit."""
    key, limits, told = _key(location), details.get("ctx", {}), ""
    match details["type"]:
        case "missing" if isinstance(location[-1], int):
            told = f"{_key(location[:-1])} is too short: it must have {location[-1] + 1} values or more"
        case "missing":
            told = f"key '{key}' is missing"
        case "too_short":
            told = f"{key} is too short: it must have {limits['min_length']} values or more"
        case "too_long":
            told = f"{key} is too long: it must have {limits['max_length']} values or fewer"
        case "union_tag_not_found":
            told = f"key '{_kind_key(key, limits)}' is missing"
        case "union_tag_invalid":
            value = _describe_value(_kind_key(key, limits), limits["tag"])
            told = f"{value} does not fit: it must be one of {limits['expected_tags']}"
        case _:
            pass
    return told


def _kind_key(key: str, limits: Mapping[str, str]) -> str:
    """Return the key of a table that says of which kind it is, whose name pydantic tells in quotes."""
    return f"{key}.{limits['discriminator'].strip(_QUOTE)}"


def _expected(details: ErrorDetails, location: Location, fields: Fields) -> str:
    """Return what would fit in place of a value."""
    if details["type"] in _TABLES and location:
        return "it is a table, whose keys are set one by one"
    field = fields.get(str(location[-1])) if location else None
    is_ours = details["type"] == "value_error"  # a check of the model's own, beyond the range of one number
    return ("" if is_ours or field is None else _range_of(field)) or _lower_first(details["msg"])


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
    plain = own_words(message).replace("Input should", "it must", 1)
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
