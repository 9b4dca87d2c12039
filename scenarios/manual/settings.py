"""The reference of a configuration: every key with its type, range, unit, default and meaning, from the models."""

import inspect
import json
import tomllib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from importlib.resources import files
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from link.program.toml_config import StrictModel
from scenarios.manual.field_comments import comments_of
from scenarios.manual.markdown import code, page, table
from scenarios.manual.types_in_words import type_in_words, unit_of

_FILE = "meanings.toml"


def meaning_of(owner: type, key: str) -> str:
    """Return what a key of a table means, empty if nobody says so.

    Args:
        owner: the model of the table.
        key: in it.
    """
    comment = comments_of(owner).get(key, "")
    if comment:
        return comment
    told = _meanings()
    classes = [told[one.__name__] for one in owner.__mro__ if one.__name__ in told]
    return next((table[key] for table in (*classes, told["any"]) if key in table), "")


@cache
def _meanings() -> Mapping[str, Mapping[str, str]]:
    return tomllib.loads(files(__package__).joinpath(_FILE).read_text(encoding="utf-8"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """One table of a file.

    Attributes:
        path: where it stands, dotted; `[]` at its end says that there may be many.
        model: what checks it.
        values: its defaults as a whole, where what it stands in has some.
    """

    path: str
    model: type[StrictModel]
    values: StrictModel | None


HEAD = ("key", "type", "unit", "default", "meaning")
_SIGNS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤", "min_length": "length ≥"}


def settings_page(title: str, text: str, model: type[StrictModel], elsewhere: Mapping[type, str]) -> str:
    """Return the page of the configuration that `model` checks.

    Args:
        title: of the page.
        text: below it.
        model: of the whole file.
        elsewhere: what is said of a table in place of its keys.
    """
    sections: list[str] = []
    for one in tables_of(model, elsewhere=elsewhere):
        section = _section(one, elsewhere.get(one.model))
        if section not in sections:  # several kinds of one table may share what is below it
            sections.append(section)
    return page(title, text, *sections)


def tables_of(
    model: type[StrictModel],
    path: str = "",
    values: StrictModel | None = None,
    elsewhere: Collection[type] = (),
) -> Iterator[Table]:
    """Yield a configuration's tables, the outer ones first; nothing from below those that are told of `elsewhere`."""
    yield Table(path=path, model=model, values=values)
    if model in elsewhere:
        return
    for name, field in model.model_fields.items():
        many = "[]" if get_origin(field.annotation) is tuple else ""
        value = getattr(values, name) if values is not None else _value(field)
        for below in _models_in(field.annotation):
            inner = value if isinstance(value, below) else None
            yield from tables_of(below, f"{path}.{name}{many}".removeprefix("."), inner, elsewhere)


def keys_of(model: type[StrictModel]) -> list[str]:
    """Return the keys of one table that are values, not tables."""
    return [name for name, field in model.model_fields.items() if not _models_in(field.annotation)]


def _section(one: Table, instead: str | None) -> str:
    parts = [_heading(one), inspect.getdoc(one.model) or ""]
    keys = keys_of(one.model)
    if instead is not None:
        return "\n\n".join([*parts, instead])
    return "\n\n".join([*parts, table(HEAD, [_row(one, name) for name in keys])] if keys else parts)


def _heading(one: Table) -> str:
    if not one.path:
        return "## The file itself"
    kind = one.model.model_fields.get("kind")
    choice = f', kind = "{get_args(kind.annotation)[0]}"' if kind and get_origin(kind.annotation) is Literal else ""
    return f"## [[{one.path[:-2]}]]" if one.path.endswith("[]") else f"## [{one.path}]{choice}"


def _row(one: Table, name: str) -> tuple[str, ...]:
    field = one.model.model_fields[name]
    meaning = "; ".join(part for part in (meaning_of(one.model, name), _choices(field.annotation)) if part)
    value = getattr(one.values, name) if one.values is not None else _value(field)
    default = "must be given" if one.values is None and field.is_required() else _write(value)
    return code(name), _type(field), unit_of(name), default, meaning


def _type(field: FieldInfo) -> str:
    bounds = dict.fromkeys(
        f"{sign} {getattr(limit, name):g}"
        for limit in _limits(field)
        for name, sign in _SIGNS.items()
        if getattr(limit, name, None) is not None
    )
    return " ".join(part for part in (type_in_words(field.annotation), ", ".join(bounds)) if part)


def _limits(field: FieldInfo) -> Iterator[Any]:
    """Yield what a number is limited by, whether None is allowed as well or not."""
    yield from field.metadata
    for argument in get_args(field.annotation):
        for one in getattr(argument, "__metadata__", ()):
            yield from getattr(one, "metadata", ())


def _choices(annotation: Any) -> str:
    """Return what the values of an enumeration mean, where that is said beside them."""
    if not (isinstance(annotation, type) and issubclass(annotation, Enum)):
        return ""
    comments: Mapping[str, str] = comments_of(annotation)
    return "; ".join(f"`{one.value}`: {comments[one.name]}" for one in annotation if comments.get(one.name))


def _value(field: FieldInfo) -> Any:
    """Return a field's default, None where it has none."""
    return None if field.is_required() else field.get_default(call_default_factory=True, validated_data={})


def _write(value: Any) -> str:
    """Return a value as it is written in TOML, which writes most things as JSON does."""
    if value is None:
        return "none"
    return code(json.dumps(value.value if isinstance(value, Enum) else value))


def _models_in(annotation: Any) -> list[type[StrictModel]]:
    """Return the models of tables that an annotation allows."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation] if issubclass(annotation, StrictModel) else []
    return [model for argument in get_args(annotation) for model in _models_in(argument)]
