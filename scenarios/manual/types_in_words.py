"""Types and units as a reader of the manual understands them."""

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


UNITS = {
    "_m2_s5": "m²/s⁵",
    "_m2_s4": "m²/s⁴",
    "_m2_s3": "m²/s³",
    "_rad2_s": "rad²/s",
    "_m_s3": "m/s³",
    "_m_s2": "m/s²",
    "_rad_s": "rad/s",
    "_rad_m": "rad/m",
    "_1_s2": "1/s²",
    "_1_s": "1/s",
    "_m2_s": "m²/s",
    "_m_s": "m/s",
    "_m2": "m²",
    "_rad": "rad",
    "_deg": "degrees",
    "_hz": "Hz",
    "_mb": "MB",
    "_ns": "ns",
    "_m": "m",
    "_s": "s",
}
"""The longer ones first: the first that fits is right; what a name ends with, and how people write it."""


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


def unit_of(name: str) -> str:
    """Return the unit of the value called `name`; empty where it has none."""
    return next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")
