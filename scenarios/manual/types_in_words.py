"""Types as a reader of the manual understands them."""

from enum import Enum
from types import NoneType
from typing import Any, Literal, get_args, get_origin

_WORDS: dict[object, str] = {
    bool: "true or false",
    int: "whole number",
    float: "number",
    str: "text",
    NoneType: "none",
}


def type_in_words(annotation: Any) -> str:
    """Return what may be written for a value of a type."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if hasattr(annotation, "__metadata__"):
        return type_in_words(arguments[0])
    if annotation in _WORDS:
        return _WORDS[annotation]
    if origin is Literal or (isinstance(annotation, type) and issubclass(annotation, Enum)):
        return _one_of(arguments or tuple(one.value for one in annotation))
    return _in_parts(annotation, origin, arguments)


def _in_parts(annotation: Any, origin: object, arguments: tuple[Any, ...]) -> str:
    if origin is tuple:
        count = "any number" if Ellipsis in arguments else f"{len(arguments)}"
        return f"array of {count} × {type_in_words(arguments[0])}"
    if origin is dict:
        return f"table of {type_in_words(arguments[1])}"
    return " or ".join(type_in_words(one) for one in arguments) or f"{annotation.__name__}"


def _one_of(values: tuple[object, ...]) -> str:
    return ("one of " if len(values) > 1 else "") + ", ".join(f"`{one}`" for one in values)
