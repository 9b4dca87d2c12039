"""Hints to the name that was probably meant, for keys of a configuration."""

import difflib
from collections.abc import Iterator, Sequence
from typing import Any, get_args

from pydantic import BaseModel

_ELSEWHERE = 0.8  # likeness from which a key of another table is worth a hint
_NAMED_MAX = 3  # of the tables that have such a key


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the tables that an annotation allows."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from models_in(argument)


def key_hint(path: str, beside: Sequence[str], model: type[BaseModel]) -> str:
    """Return what is said of an unknown key: the table that has it, the key that is like it, or all that are valid.

    Args:
        path: of the unknown key, dotted.
        beside: the keys of its table.
        model: of the whole file.
    """
    name = path.rsplit(".", 1)[-1]
    others = {other: key for other, key in _keys_below(model) if other != path}
    meant = [other for other, key in others.items() if key == name]
    if not meant:
        meant = [f"'{near}'" for near in difflib.get_close_matches(name, beside, n=1)]
    if not meant:
        near = difflib.get_close_matches(name, others.values(), n=1, cutoff=_ELSEWHERE)
        meant = [other for other, key in others.items() if key in near]
    if meant:
        nearest = sorted(meant, key=lambda other: other.count("."))[:_NAMED_MAX]
        return f", did you mean {' or '.join(nearest)}?"
    return f"; valid are {', '.join(beside)}" if beside else ""


def _keys_below(model: type[BaseModel], table: str = "") -> Iterator[tuple[str, str]]:
    """Yield the path of every key, and the key."""
    for name, field in model.model_fields.items():
        path = f"{table}.{name}".removeprefix(".")
        yield path, name
        for below in models_in(field.annotation):
            yield from _keys_below(below, path)
